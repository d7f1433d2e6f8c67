// Error against cost on log axes, one chart per kind of cost, one line per cell with the band of its interval.

const kCosts = [
    ["seconds", "seconds"],
    ["rays", "rays"],
    ["mutations", "mutations"],
];

/// A cell's line in a plot of `points`, in the look that it has in every figure.
const cellSeries = (cell, points) => ({
    label: cell.label,
    colour: samplerColour(cell.order),
    order: cell.order,
    points,
});

/// A dashed line of slope −1 from the upper left, to compare by eye.
function guide(series) {
    const points = series.flatMap((s) => s.points);
    const [x0, x1] = [Math.min(...points.map((p) => p.x)), Math.max(...points.map((p) => p.x))];
    const y0 = Math.max(...points.map((p) => p.y));
    return {
        points: [
            { x: x0, y: y0 },
            { x: x1, y: (y0 * x0) / x1 },
        ],
        colour: css("--muted"),
        dashed: true,
    };
}

const withBounds = (points) => points.flatMap((p) => [p.y, ...(isInterval(p.ci95) ? p.ci95 : [])]).filter((v) => v > 0);
const errorAxis = (points) => ({ label: metricName(primaryMetric), log: true, values: withBounds(points) });
const pointText = (series, point, where) => [
    el("b", {}, series.label),
    line(`${number(point.y)}${isInterval(point.ci95) ? `  (${interval(point.ci95)})` : ""}`),
    line(where),
];

function costChart(group, cost, title) {
    const points = (cell) =>
        (cell.convergence ?? [])
            .filter((p) => p[cost] > 0 && p.error > 0)
            .map((p) => ({ x: p[cost], y: p.error, ci95: p.ci95 }));
    const seen = group.cells.filter((cell) => points(cell).length);
    if (!seen.length) return null;
    const name = `${metricName(primaryMetric)} against ${title}, ${group.title}`;
    return figure(name, (paper) => {
        const series = seen.map((cell) => cellSeries(cell, points(cell))),
            all = series.flatMap((s) => s.points);
        return linePlot({
            name,
            paper,
            series,
            guides: [guide(series)],
            x: { label: title, log: true, values: all.map((p) => p.x), format: (v) => count(v, plain) },
            y: errorAxis(all),
            describe: (s, p) => pointText(s, p, `at ${count(p.x)} ${title}`),
        });
    });
}

const lineMark = (cell) =>
    svg(
        "svg",
        { class: "point-mark", viewBox: "0 0 28 12", width: 28, height: 12, "aria-hidden": true },
        svg("line", { x1: 0, x2: 28, y1: 6, y2: 6, stroke: samplerColour(cell.order), "stroke-width": 1.8 }),
        pointMark(cell.order, 14, 6, samplerColour(cell.order), 4),
    );

function slopeLegend(group) {
    return el(
        "ul",
        { class: "legend" },
        group.cells
            .filter((cell) => cell.convergence?.length)
            .map((cell) => {
                const slope = cell.slope;
                const hidden = cell.convergence.filter((p) => !(p.error > 0)).length;
                return el(
                    "li",
                    {},
                    lineMark(cell),
                    el("b", {}, cell.label),
                    isNumber(slope?.value) && ` slope ${slopeText(slope.value)}`,
                    isInterval(slope?.ci95) && el("span", { class: "ci" }, ` (${interval(slope.ci95, slopeText)})`),
                    slope?.flatter_than_minus_one &&
                        el("strong", { class: "flag" }, "⚑ flatter than −1: trapping or bias"),
                    hidden > 0 && el("span", { class: "ci" }, ` ${hidden} snapshots with error ≤ 0 not drawn`),
                );
            }),
        el(
            "li",
            { class: "ci" },
            svg(
                "svg",
                { class: "point-mark", viewBox: "0 0 28 12", width: 28, height: 12, "aria-hidden": true },
                svg("line", { x1: 0, x2: 28, y1: 6, y2: 6, stroke: css("--muted"), "stroke-dasharray": "4 4" }),
            ),
            "slope −1",
        ),
    );
}

function convergenceSection() {
    const drawn = groups.filter((group) => group.cells.some((cell) => cell.convergence?.length));
    if (!drawn.length) return null;
    return section(
        "convergence",
        "Error against cost",
        `Snapshots inside each run, mean over runs, band: ${kIntervalName}. The slope is fitted to log error against log cost.`,
        drawn.map((group) =>
            el(
                "div",
                { class: "group" },
                el("h3", {}, group.title),
                slopeLegend(group),
                later(() =>
                    el(
                        "div",
                        { class: "charts" },
                        kCosts.map(([cost, title]) => costChart(group, cost, title)),
                    ),
                ),
            ),
        ),
    );
}

/// How much of the mean square error is brightness, which all pixels of a run share.
function brightnessShare({ counts, density, brightness }) {
    const pixels = sum(counts) + 1,
        rest = sum(counts.map((n, i) => n * density[i])) / pixels;
    return brightness / (brightness + rest);
}

function spectrumChart(group, judged) {
    const name = `error spectrum, ${group.title}`;
    return figure(name, (paper) => {
        const series = judged.map((cell) => {
            const { cycles_per_pixel: x, density, low, high } = cell.error_spectrum;
            const points = x.map((frequency, i) => ({ x: frequency, y: density[i], ci95: [low[i], high[i]] }));
            return cellSeries(
                cell,
                points.filter((p) => p.x > 0 && p.y > 0),
            );
        });
        const all = series.flatMap((s) => s.points);
        return linePlot({
            name,
            paper,
            series,
            x: { label: "cycles per pixel", log: true, values: all.map((p) => p.x) },
            y: { label: "density of the error", log: true, values: withBounds(all) },
            describe: (s, p) => [
                el("b", {}, s.label),
                line(`${number(p.y)}  (5–95 % of runs ${interval(p.ci95)})`),
                line(`at ${number(p.x)} cycles per pixel`),
            ],
        });
    });
}

function spectrumSection() {
    const drawn = groups
        .map((group) => ({
            group,
            judged: group.cells.filter((cell) => cell.error_spectrum?.density?.some((d) => d > 0)),
        }))
        .filter(({ judged }) => judged.length);
    if (!drawn.length) return null;
    return section(
        "spectrum",
        "Error spectrum",
        "Power of the error images by frequency, mean over runs, band: 5 to 95 % of the runs. Noise that pixels do not share is flat; what rises to the left is shared by neighbours, like the blobs of caught chains.",
        drawn.map(({ group, judged }) =>
            el(
                "div",
                { class: "group" },
                el("h3", {}, group.title),
                el(
                    "ul",
                    { class: "legend" },
                    judged.map((cell) =>
                        el(
                            "li",
                            {},
                            lineMark(cell),
                            el("b", {}, cell.label),
                            el(
                                "span",
                                { class: "ci" },
                                ` brightness is ${percent(brightnessShare(cell.error_spectrum))} of the mean square`,
                            ),
                        ),
                    ),
                ),
                later(() => el("div", { class: "charts single" }, spectrumChart(group, judged))),
            ),
        ),
    );
}
