// Sweeps: error against a swept value, one line per sampler, and maps over two swept values.

const sameValue = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/// What the experiment says of a swept path: a list, or an object with "log" or "linear".
const sweepSpecification = (path) => data.experiment?.sweep?.[path] ?? data.experiment?.sweep?.zip?.[path];

/// Is an axis logarithmic? As the experiment spaced the values, else where they are spread more evenly.
function isSpacedByRatio(path, values) {
    const specification = sweepSpecification(path) ?? {};
    if (!(values[0] > 0) || values.length < 2 || specification.linear) return false;
    if (specification.log) return true;
    const [lo, hi] = [values[0], values.at(-1)];
    if (values.length === 2) return hi / lo >= 8;
    const unevenness = (place) => Math.abs(mean(values.map(place)) - 0.5);
    return unevenness((v) => Math.log(v / lo) / Math.log(hi / lo)) < unevenness((v) => (v - lo) / (hi - lo));
}

/// A swept path as an axis: its values in order, and where each stands.
function sweptPath(path, judged) {
    const values = [];
    for (const cell of judged)
        if (path in cell.sweep && !values.some((v) => sameValue(v, cell.sweep[path]))) values.push(cell.sweep[path]);
    const numeric = values.every(isNumber);
    if (numeric) values.sort((a, b) => a - b);
    const index = (value) => values.findIndex((v) => sameValue(v, value));
    return {
        path,
        name: pathName(path),
        values,
        index,
        at: numeric ? (value) => value : index,
        log: numeric && isSpacedByRatio(path, values),
        names: numeric ? null : values.map(valueText),
    };
}

/// A logarithmic scale has no place for other errors.
const hasPlace = (cell) => cell.metrics[primaryMetric].mean > 0;
const kNoPlace = "error ≤ 0: reference too poor";
const noPlaceText = (cell) => (isNumber(cell.metrics[primaryMetric].mean) ? kNoPlace : "error not known");

/// The swept values of a scene: paths with at least two, the cells that are judged, and which paths vary together.
function sweepOf(scene) {
    const judged = cells.filter(
        (cell) => cell.scene === scene && cell.sweep && cell.metrics?.[primaryMetric],
    );
    const names = [...new Set(judged.flatMap((cell) => Object.keys(cell.sweep)))];
    const paths = names.map((path) => sweptPath(path, judged)).filter((path) => path.values.length > 1);
    const both = (p, q) => judged.filter((cell) => p.path in cell.sweep && q.path in cell.sweep);
    /// A zip gives each value of p one of q.
    const determines = (p, q) =>
        p.values.every((value) => {
            const found = both(p, q).filter((cell) => sameValue(cell.sweep[p.path], value));
            return found.every((cell) => sameValue(cell.sweep[q.path], found[0].sweep[q.path]));
        });
    const crosses = (p, q) => p !== q && both(p, q).length > 0 && !determines(p, q) && !determines(q, p);
    return { scene, judged, paths, crosses };
}

/// Every combination of values of some paths that occurs, as [[path, value], …] with the cells that agree with it. A cell
/// that a path leaves as it is agrees with each of its values.
function facets(judged, paths) {
    const found = new Map();
    for (const cell of judged) {
        const settings = paths.map(({ path }) => [path, cell.sweep[path]]);
        if (settings.every(([, value]) => value !== undefined)) found.set(JSON.stringify(settings), settings);
    }
    const order = (settings) => paths.map((p, i) => p.index(settings[i][1]));
    const sorted = [...found.values()].sort((a, b) => {
        const [x, y] = [order(a), order(b)];
        const first = x.findIndex((v, i) => v !== y[i]);
        return first < 0 ? 0 : x[first] - y[first];
    });
    const agrees = (cell, settings) =>
        settings.every(([path, value]) => !(path in cell.sweep) || sameValue(cell.sweep[path], value));
    return sorted.map((settings) => ({
        title: settingsText(settings),
        cells: judged.filter((cell) => agrees(cell, settings)),
    }));
}

const samplerLook = (sampler) => {
    const order = samplerNames.indexOf(sampler);
    return { label: sampler, order, colour: samplerColour(order) };
};

/// The samplers' lines over one path, through the cells that have a place. A sampler that the path leaves as it is is the same everywhere: a dashed line.
function difficultySeries(facet, axis) {
    const range = [axis.values[0], axis.values.at(-1)].map(axis.at);
    return samplerNames.flatMap((sampler) => {
        const own = facet.cells.filter((cell) => cell.sampler === sampler && hasPlace(cell));
        const swept = own.filter((cell) => axis.path in cell.sweep);
        const point = (cell, x) => {
            const { mean: y, ci95 } = cell.metrics[primaryMetric];
            return { x, y, ci95, cell };
        };
        if (swept.length) {
            const points = swept.map((cell) => point(cell, axis.at(cell.sweep[axis.path])));
            return [{ ...samplerLook(sampler), points: points.sort((a, b) => a.x - b.x) }];
        }
        if (own.length !== 1) return [];
        return [{ ...samplerLook(sampler), dashed: true, points: range.map((x) => point(own[0], x)) }];
    });
}

function difficultyPlots(sweep, axis) {
    const others = sweep.paths.filter((path) => sweep.crosses(path, axis));
    const drawn = facets(sweep.judged, others)
        .map((facet) => ({ ...facet, series: () => difficultySeries(facet, axis) }))
        .filter((facet) => facet.series().length);
    const points = drawn.flatMap((facet) => facet.series().flatMap((s) => s.points));
    return el(
        "div",
        { class: drawn.length > 1 ? "charts" : "charts single" },
        drawn.map((facet) => {
            const name = `${metricName(primaryMetric)} against ${axis.name}, ${[sweep.scene, facet.title].filter(Boolean).join(", ")}`;
            return figure(name, (paper) =>
                linePlot({
                    name,
                    paper,
                    title: facet.title,
                    series: facet.series(),
                    x: { ...axis, label: axis.name, values: axis.values.map(axis.at), ticksAtValues: true },
                    y: errorAxis(points),
                    describe: (s, p) =>
                        pointText(s, p, settingsText(Object.entries(p.cell.sweep)) || "the same for all values"),
                }),
            );
        }),
    );
}

/// A sampler's cells over two paths, for one combination of the others.
function mapFacets(sweep, x, y) {
    const others = sweep.paths.filter((path) => sweep.crosses(path, x) && sweep.crosses(path, y));
    return samplerNames.flatMap((sampler) => {
        const own = sweep.judged.filter(
            (cell) => cell.sampler === sampler && x.path in cell.sweep && y.path in cell.sweep,
        );
        return facets(own, others).map((facet) => ({
            ...facet,
            sampler,
            title: [sampler, facet.title].filter(Boolean).join(", "),
        }));
    });
}

/// The figures of one scene for a chosen pair of paths: errors on one scale, and ratios to the baseline on another.
function sweepMaps(sweep, [x, y]) {
    const drawn = mapFacets(sweep, x, y);
    const errors = drawn.flatMap((facet) => facet.cells.filter(hasPlace).map((cell) => cell.metrics[primaryMetric].mean));
    const [lo, hi] = [Math.min(...errors), Math.max(...errors)];
    const ratioOf = (cell) => comparisonsOf(cell)[0]?.ratio;
    const limit = ratioLimit(drawn.flatMap((facet) => facet.cells.map(ratioOf)));
    const kinds = [
        {
            title: metricName(primaryMetric),
            value: (cell) => cell.metrics[primaryMetric].mean,
            shows: () => true,
            colour: (error) => magma(hi > lo ? 0.12 + (0.83 * Math.log(error / lo)) / Math.log(hi / lo) : 0.5),
            bar: { map: (t) => magma(0.12 + 0.83 * t), labels: [lo, Math.sqrt(lo * hi), hi].map((v) => number(v, 2)) },
        },
        {
            title: `ratio to ${drawn.flatMap((facet) => facet.cells.map((cell) => comparisonsOf(cell)[0]?.baseline)).find(Boolean)}`,
            value: ratioOf,
            shows: (cell) => comparisonsOf(cell).length > 0,
            colour: (ratio) => ratioColour(limit)(ratio),
            bar: { map: (t) => diverging(2 * t - 1), labels: ratioLabels(limit) },
            mark: (cell) => comparisonsOf(cell)[0]?.verdict === "undecided",
        },
    ];
    const row = (kind) =>
        drawn
            .filter((facet) => facet.cells.some(kind.shows))
            .map((facet) => {
                const name = `${kind.title} over ${x.name} and ${y.name}, ${sweep.scene}, ${facet.title}`;
                return figure(name, (paper) =>
                    heatMap({ name, paper, title: facet.title, x, y, cells: facet.cells, kind }),
                );
            });
    const rows = kinds.map(row).filter((figures) => figures.length);
    const together = drawn.length === 1 ? [rows.flat()] : rows;
    return together.map((figures) => el("div", { class: "charts" }, figures));
}

function describeSweepCell(cell) {
    const { mean: error, ci95 } = cell.metrics[primaryMetric],
        comparison = comparisonsOf(cell)[0];
    return [
        el("b", {}, `${cell.sampler}, ${settingsText(Object.entries(cell.sweep))}`),
        line(`${metricName(primaryMetric)} ${number(error)}${isInterval(ci95) ? ` (${interval(ci95)})` : ""}`),
        !hasPlace(cell) && line(noPlaceText(cell)),
        comparison &&
            line(
                `${number(comparison.ratio)} × ${comparison.baseline}’s${isInterval(comparison.ci95) ? ` (${interval(comparison.ci95)})` : ""}, p = ${pValue(comparison.p_adjusted ?? comparison.p)}: ${comparison.verdict}`,
            ),
    ].filter(Boolean);
}

/// A square per cell, its value in it; grey with a stroke where a value has no place on the scale; a ring marks what is
/// undecided. Hover and the arrow keys read it.
function heatMap({ name, title, x, y, cells: shown, kind, paper }) {
    const frame = plotFrame(
        { label: "", names: y.values.map(valueText), values: [] },
        { title, height: kPlotHeight - 8 },
    );
    const xScale = makeScale({ label: x.name, names: x.values.map(valueText), values: [] }, frame.left, frame.right),
        yScale = makeScale({ label: y.name, names: y.values.map(valueText), values: [] }, frame.bottom, frame.top);
    const width = (frame.right - frame.left) / x.values.length,
        height = (frame.bottom - frame.top) / y.values.length;
    const root = plotRoot(kPlotWidth, frame.height + 34, name, axes(xScale, yScale, frame));
    if (title)
        root.append(
            textAt((frame.left + frame.right) / 2, frame.top - 7, title, {
                "text-anchor": "middle",
                "font-weight": 600,
            }),
        );
    const squares = new Map();
    for (const cell of shown) {
        const [column, row] = [x.index(cell.sweep[x.path]), y.index(cell.sweep[y.path])],
            value = kind.value(cell);
        if (!kind.shows(cell)) continue;
        const rgb = value > 0 ? kind.colour(value) : kNotJudged,
            [cx, cy] = [xScale.at(column), yScale.at(row)],
            text = value > 0 ? number(value, 2) : "";
        const square = svg(
            "g",
            { "data-cell": cell.cell },
            svg("rect", {
                x: cx - width / 2,
                y: cy - height / 2,
                width,
                height,
                fill: rgbToCss(rgb),
                stroke: css("--paper"),
            }),
            !(value > 0) &&
                svg("path", {
                    class: "no-place",
                    d: `M${cx - width / 2} ${cy + height / 2}l${width} ${-height}`,
                    stroke: css("--paper"),
                }),
            textWidth(text) < width - 6 &&
                height > 14 &&
                textAt(cx, cy + 4, text, { "text-anchor": "middle", fill: contrastInk(rgb) }),
            kind.mark?.(cell) &&
                svg("circle", {
                    class: "undecided",
                    cx: cx + width / 2 - 8,
                    cy: cy - height / 2 + 8,
                    r: 3.5,
                    fill: "none",
                    stroke: contrastInk(rgb),
                    "stroke-width": 1.5,
                }),
        );
        squares.set(`${column},${row}`, { square, cell });
        if (!paper) withTooltip(square, () => describeSweepCell(cell));
        root.append(square);
    }
    const cursor = svg("rect", {
        width,
        height,
        fill: "none",
        stroke: css("--link"),
        "stroke-width": 2.5,
        visibility: "hidden",
        "pointer-events": "none",
    });
    root.append(
        cursor,
        colourScale(kind.bar, kind.title, frame.left, frame.height + 2, frame.right - frame.left, Boolean(kind.mark)),
    );
    if (!paper)
        readByKeys(root, {
            first: [0, y.values.length - 1],
            step: ([column, row], dx, dy) => [
                clamp(column + dx, 0, x.values.length - 1),
                clamp(row - dy, 0, y.values.length - 1),
            ],
            show: ([column, row]) => {
                setAttributes(cursor, {
                    x: xScale.at(column) - width / 2,
                    y: yScale.at(row) - height / 2,
                    visibility: "visible",
                });
                const found = squares.get(`${column},${row}`);
                return [found ? describeSweepCell(found.cell) : "not run", cursor];
            },
            hide: () => cursor.setAttribute("visibility", "hidden"),
        });
    return root;
}

function sweepFigures(sweep) {
    const plots = el("div", { class: "difficulty" }),
        maps = el("div", { class: "maps" });
    const pairs = sweep.paths.flatMap((y, i) =>
        sweep.paths
            .slice(i + 1)
            .filter((x) => sweep.crosses(x, y))
            .map((x) => [x, y]),
    );
    const choose = (label, options, names, show) => {
        if (options.length) show(options[0]);
        if (options.length < 2) return null;
        const choice = el(
            "select",
            { "aria-label": `${label} for ${sweep.scene}`, onchange: () => show(options[choice.selectedIndex]) },
            names.map((name) => el("option", {}, name)),
        );
        return el("label", { class: "choice" }, `${label} `, choice);
    };
    const byPath = choose(
        "swept value",
        sweep.paths,
        sweep.paths.map((path) => path.name),
        (path) => plots.replaceChildren(difficultyPlots(sweep, path)),
    );
    const byPair = choose(
        "maps over",
        pairs,
        pairs.map(([x, y]) => `${x.name} and ${y.name}`),
        (pair) => maps.replaceChildren(...sweepMaps(sweep, pair)),
    );
    const legend = samplerNames
        .map((sampler) => sweep.judged.find((cell) => cell.sampler === sampler))
        .filter(Boolean)
        .map((cell) => el("li", {}, lineMark(samplerLook(cell.sampler)), el("b", {}, cell.sampler)));
    const without = sweep.judged.filter((cell) => !hasPlace(cell));
    for (const text of new Set(without.map(noPlaceText))) {
        const names = without.filter((cell) => noPlaceText(cell) === text).map((cell) => cell.cell);
        legend.push(el("li", { class: "ci" }, `not drawn, ${text}: ${names.join("; ")}`));
    }
    return el(
        "div",
        { class: "group" },
        el("h3", {}, sweep.scene),
        byPath,
        el("ul", { class: "legend" }, legend),
        plots,
        pairs.length > 0 && byPair,
        maps,
    );
}

function sweepSection() {
    const sweeps = [...new Set(cells.map((cell) => cell.scene))].map(sweepOf).filter((sweep) => sweep.paths.length);
    if (!sweeps.length) return null;
    return section(
        "sweep",
        "Error against difficulty",
        `Mean over runs, band: ${kIntervalName}; dashed: a sampler that the swept value leaves as it is. In maps of ratios blue is better than the baseline, orange worse, and a ring marks an undecided verdict. Grey with a stroke: ${kNoPlace}.`,
        sweeps.map(sweepFigures),
    );
}
