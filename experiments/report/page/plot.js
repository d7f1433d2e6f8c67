// Plots in SVG: scales, axes, lines with bands. Every look is an attribute, so that a plot is the same outside the page.

const kPlotWidth = 400; // units; on paper the width of a column
const kPlotHeight = 280;
const kFontSize = 11;
const kFont = "Helvetica, Arial, 'Liberation Sans', sans-serif";

const measuring = document.createElement("canvas").getContext("2d");
function textWidth(text, size = kFontSize) {
    measuring.font = `${size}px ${kFont}`;
    return measuring.measureText(text).width;
}

/// At most `most` round values in equal steps within [lo, hi].
function linearTicks(lo, hi, most) {
    const rough = (hi - lo) / Math.max(1, most - 1),
        power = 10 ** Math.floor(Math.log10(rough));
    for (const step of [1, 2, 5, 10, 20, 50].map((m) => m * power)) {
        const first = Math.ceil(lo / step - 1e-9),
            last = Math.floor(hi / step + 1e-9);
        if (last - first + 1 <= most)
            return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
    }
    return [];
}

/// At most `most` values within [lo, hi] for a log axis: 1, 2 and 5 times powers of ten, else powers of ten, else every
/// second and so on; where the range is too short for two of them, equal steps.
function logTicks(lo, hi, most = 7) {
    const powers = (every, multiples) => {
        const ticks = [];
        for (let e = Math.floor(Math.log10(lo)); e <= Math.log10(hi); ++e)
            if (e % every === 0) ticks.push(...multiples.map((m) => m * 10 ** e));
        return ticks.filter((t) => t >= lo && t <= hi);
    };
    const candidates = [powers(1, [1, 2, 5]), ...[1, 2, 3, 4, 6, 12].map((every) => powers(every, [1]))];
    const ticks = candidates.find((c) => c.length <= most) ?? [];
    return ticks.length >= 2 ? ticks : linearTicks(lo, hi, most);
}

/// Of an axis { label, values, log, whole, names, format, ticksAtValues }: `values` are what it must hold, and where its ticks
/// stand if they are to; `names` stand at 0, 1, 2 … where the values are no numbers. `at` maps to [from, to].
function makeScale(
    { label, values, log = false, whole = false, names = null, format = plain, ticksAtValues = false },
    from,
    to,
) {
    let lo = Math.min(...values),
        hi = Math.max(...values);
    if (names) [lo, hi] = [-0.5, names.length - 0.5];
    else if (log) {
        const room = Math.max(1.1, (hi / lo) ** 0.04);
        [lo, hi] = [lo / room, hi * room];
    } else {
        const room = 0.04 * (hi - lo) || 0.1 * Math.abs(hi) || 1;
        [lo, hi] = [lo - room, hi + room];
    }
    const place = log ? (v) => Math.log(v / lo) / Math.log(hi / lo) : (v) => (v - lo) / (hi - lo);
    const at = (v) => from + (to - from) * place(v);
    const tick = (value) => ({ at: at(value), text: names ? String(names[value]) : format(value) });
    const ticks = (most) =>
        (names ? names.map((_, i) => i) : log ? logTicks(lo, hi, most) : linearTicks(lo, hi, most))
            .filter((v) => !whole || Number.isInteger(v))
            .map(tick);
    /// As many ticks as fit side by side.
    const spacedTicks = () => {
        const fits = (found) =>
            found.every(
                (t, i) =>
                    i === 0 || t.at - found[i - 1].at > (textWidth(t.text) + textWidth(found[i - 1].text)) / 2 + 8,
            );
        const candidates = [9, 8, 7, 6, 5, 4, 3, 2].map((most) => () => ticks(most));
        if (ticksAtValues && !names) candidates.unshift(() => [...new Set(values)].map(tick));
        return candidates.map((make) => make()).find(fits) ?? [];
    };
    return { label, lo, hi, at, ticks, spacedTicks };
}

const kMarks = [
    (x, y, r) => svg("circle", { cx: x, cy: y, r }),
    (x, y, r) =>
        svg("path", {
            d: `M${x} ${y - 1.3 * r}l${1.3 * r} ${1.3 * r}l${-1.3 * r} ${1.3 * r}l${-1.3 * r} ${-1.3 * r}z`,
        }),
    (x, y, r) => svg("path", { d: `M${x} ${y - 1.2 * r}l${1.2 * r} ${2.1 * r}h${-2.4 * r}z` }),
    (x, y, r) => svg("rect", { x: x - 0.9 * r, y: y - 0.9 * r, width: 1.8 * r, height: 1.8 * r }),
    (x, y, r) => svg("path", { d: `M${x} ${y + 1.2 * r}l${1.2 * r} ${-2.1 * r}h${-2.4 * r}z` }),
    (x, y, r, colour) =>
        svg("path", {
            d: `M${x - r} ${y - r}l${2 * r} ${2 * r}m0 ${-2 * r}l${-2 * r} ${2 * r}`,
            stroke: colour,
            "stroke-width": 1.8,
        }),
    (x, y, r, colour) =>
        svg("path", { d: `M${x - r} ${y}h${2 * r}m${-r} ${-r}v${2 * r}`, stroke: colour, "stroke-width": 1.8 }),
    (x, y, r, colour) => svg("circle", { cx: x, cy: y, r, stroke: colour, "stroke-width": 1.6, "fill-opacity": 0.01 }),
];
const pointMark = (order, x, y, colour, r = 3.4) =>
    setAttributes(kMarks[order % kMarks.length](x, y, r, colour), { fill: colour });

const textAt = (x, y, text, attributes = {}) => svg("text", { x, y, fill: css("--ink"), ...attributes }, text);

/// The root of a figure of its own, `width` units wide.
const plotRoot = (width, height, name, ...children) =>
    svg(
        "svg",
        {
            viewBox: `0 0 ${width} ${height}`,
            role: "img",
            "aria-label": name,
            "font-family": kFont,
            "font-size": kFontSize,
        },
        ...children,
    );

/// A title over several lines' marks and names, as wide as a plot: what is a list in HTML on the screen.
function paperLegend(series, width) {
    const group = svg("g", {});
    let x = 4,
        y = 8;
    for (const { label, colour, order, dashed, markless } of series) {
        const needed = 26 + textWidth(label) + 14;
        if (x + needed > width && x > 4) [x, y] = [4, y + 15];
        group.append(
            svg("line", {
                x1: x,
                x2: x + 20,
                y1: y,
                y2: y,
                stroke: colour,
                "stroke-width": 1.8,
                "stroke-dasharray": dashed ? "5 3" : null,
            }),
            markless ? "" : pointMark(order, x + 10, y, colour),
            textAt(x + 25, y + 4, label),
        );
        x += needed;
    }
    return { group, height: y + 10 };
}

/// Frame, grid, ticks and titles of a plot between its scales.
function axes(x, y, frame) {
    const { left, right, top, bottom } = frame,
        ink = css("--ink"),
        rule = css("--rule"),
        muted = css("--muted");
    const group = svg("g", {});
    for (const tick of x.spacedTicks())
        group.append(
            svg("line", { x1: tick.at, x2: tick.at, y1: top, y2: bottom + 4, stroke: rule, "stroke-width": 0.7 }),
            textAt(tick.at, bottom + 15, tick.text, { "text-anchor": "middle", class: "x-tick" }),
        );
    for (const tick of y.ticks(9))
        group.append(
            svg("line", { x1: left - 4, x2: right, y1: tick.at, y2: tick.at, stroke: rule, "stroke-width": 0.7 }),
            textAt(left - 6, tick.at + 4, tick.text, { "text-anchor": "end", class: "y-tick" }),
        );
    const middle = (top + bottom) / 2;
    group.append(
        svg("path", { d: `M${left} ${top}V${bottom}H${right}`, fill: "none", stroke: muted, "stroke-width": 1 }),
        textAt((left + right) / 2, bottom + 31, x.label, { "text-anchor": "middle", fill: muted }),
        textAt(11, middle, y.label, {
            "text-anchor": "middle",
            fill: muted,
            transform: `rotate(-90 11 ${middle})`,
        }),
    );
    return group;
}

/// The place left for data: room for the longest label of the vertical axis, and for a title.
function plotFrame(y, { title, above = 0, height = kPlotHeight }) {
    const labels = makeScale(y, 1, 0)
        .ticks(9)
        .map((tick) => textWidth(tick.text));
    const top = above + (title ? 22 : 8);
    return {
        left: 26 + Math.max(8, ...labels),
        right: kPlotWidth - 10,
        top,
        bottom: above + height - 38,
        height: above + height,
    };
}

function seriesShapes({ points, colour, order, dashed, plainLine, markless }, x, y) {
    const place = (p, value = p.y) => `${x.at(p.x).toFixed(1)} ${y.at(value).toFixed(1)}`;
    const bound = (p, side) => (isInterval(p.ci95) && (p.ci95[side] > 0 || !y.log) ? p.ci95[side] : p.y);
    const banded = points.some((p) => isInterval(p.ci95));
    const alone = points.length === 1;
    return [
        banded &&
            alone &&
            svg("line", {
                x1: x.at(points[0].x),
                x2: x.at(points[0].x),
                y1: y.at(bound(points[0], 0)),
                y2: y.at(bound(points[0], 1)),
                stroke: colour,
                "stroke-width": 1.2,
            }),
        banded &&
            !alone &&
            svg("path", {
                class: "band",
                d: `M${[...points.map((p) => place(p, bound(p, 1))), ...points.toReversed().map((p) => place(p, bound(p, 0)))].join("L")}Z`,
                fill: colour,
                "fill-opacity": isDark() ? 0.22 : 0.15,
            }),
        svg("path", {
            d: `M${points.map((p) => place(p)).join("L")}`,
            fill: "none",
            stroke: colour,
            "stroke-width": plainLine || markless ? 1 : 1.8,
            "stroke-linejoin": "round",
            "stroke-dasharray": dashed ? "5 3" : null,
        }),
        !plainLine && !markless && points.map((p) => pointMark(order, x.at(p.x), y.at(p.y), colour)),
    ];
}

/// Lines with bands. x, y: axes as of makeScale; series: { label, colour, order, points: [{ x, y, ci95 }], dashed, markless };
/// guides: the same, without marks and not read; `describe(series, point)` fills the tooltip, by pointer or arrow keys.
function linePlot({ name, title, x: xAxis, y: yAxis, series, guides = [], describe, paper, height }) {
    const legend = paper && series.length > 1 ? paperLegend(series, kPlotWidth) : null;
    const frame = plotFrame(yAxis, { title, above: legend?.height ?? 0, height });
    const x = makeScale(xAxis, frame.left, frame.right),
        y = { ...makeScale(yAxis, frame.bottom, frame.top), log: yAxis.log };
    const inside = { x: frame.left, y: frame.top, width: frame.right - frame.left, height: frame.bottom - frame.top };
    const ring = svg("circle", { r: 6, fill: "none", stroke: css("--ink"), "stroke-width": 1.5, visibility: "hidden" });
    const root = plotRoot(
        kPlotWidth,
        frame.height,
        name,
        legend?.group,
        title &&
            textAt((frame.left + frame.right) / 2, frame.top - 7, title, {
                "text-anchor": "middle",
                "font-weight": 600,
            }),
        axes(x, y, frame),
        svg(
            "svg",
            { ...inside, viewBox: `${inside.x} ${inside.y} ${inside.width} ${inside.height}` },
            guides.map((g) => seriesShapes({ ...g, plainLine: true }, x, y)),
        ),
        series.map((s) => svg("g", { class: "series" }, seriesShapes(s, x, y))),
        ring,
    );
    if (!paper) readPoints(root, series, (p) => [x.at(p.x), y.at(p.y)], ring, describe);
    return root;
}

/// The point nearest the pointer, or the one the arrow keys lead to: along a line, or to the next line.
function readPoints(root, series, place, ring, describe) {
    const lines = series.filter((s) => s.points.length);
    if (!lines.length) return;
    const show = ([line, index]) => {
        const point = lines[line].points[index],
            [cx, cy] = place(point);
        setAttributes(ring, { cx, cy, visibility: "visible" });
        return [describe(lines[line], point), ring];
    };
    const hide = () => ring.setAttribute("visibility", "hidden");
    root.addEventListener("pointermove", (e) => {
        const box = root.getBoundingClientRect(),
            unit = kPlotWidth / box.width;
        const distance = (p) =>
            Math.hypot(...place(p).map((v, i) => v - unit * (i ? e.clientY - box.top : e.clientX - box.left)));
        let best = [Infinity];
        lines.forEach((s, line) =>
            s.points.forEach((p, i) => (best = distance(p) < best[0] ? [distance(p), line, i] : best)),
        );
        if (best[0] < 30) tooltip.show(show(best.slice(1))[0], e.clientX, e.clientY);
        else (hide(), tooltip.hide());
    });
    root.addEventListener("pointerleave", () => {
        hide();
        tooltip.hide();
    });
    const step = ([line, index], dx, dy) => {
        const next = clamp(line + dy, 0, lines.length - 1);
        return [next, clamp(index + dx, 0, lines[next].points.length - 1)];
    };
    readByKeys(root, { first: [0, 0], step, show, hide });
}

/// A colour map as a strip with labels below, `width` units wide; with `ring`, what a ring in the map means.
function colourScale({ map, labels }, title, x, y, width, ring) {
    const steps = 64,
        group = svg("g", {});
    const half = width / 2;
    for (let i = 0; i < steps; ++i)
        group.append(
            svg("rect", {
                x: x + half + (half * i) / steps,
                y,
                width: half / steps + 0.4,
                height: 9,
                fill: rgbToCss(map(i / (steps - 1))),
            }),
        );
    const muted = css("--muted");
    labels.forEach((label, i) => {
        const anchor = i === 0 ? "start" : i === labels.length - 1 ? "end" : "middle";
        group.append(textAt(x + half + (half * i) / (labels.length - 1), y + 21, label, { "text-anchor": anchor }));
    });
    group.append(textAt(x + half - 8, y + 9, title, { "text-anchor": "end", fill: muted }));
    if (ring)
        group.append(
            svg("circle", {
                cx: x + half - 8 - textWidth("undecided") - 8,
                cy: y + 20,
                r: 3.5,
                fill: "none",
                stroke: css("--ink"),
                "stroke-width": 1.5,
            }),
            textAt(x + half - 8, y + 24, "undecided", { "text-anchor": "end", fill: muted }),
        );
    return group;
}
