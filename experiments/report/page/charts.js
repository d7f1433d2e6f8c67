// Error against cost on log axes, one chart per kind of cost, one line per cell with the band of its interval.

const kCosts = [
    ["seconds", "seconds"],
    ["rays", "rays"],
    ["mutations", "mutations"],
];
const liveCharts = [];

function translucent(hex, alpha) {
    return `rgba(${hexToRgb(hex).join(",")},${alpha})`;
}

function costDatasets(group, cost) {
    const sets = [];
    for (const cell of group.cells) {
        const points = (cell.convergence ?? []).filter((p) => p[cost] > 0 && p.error > 0);
        if (!points.length) continue;
        const colour = samplerColour(cell.order);
        const bound = (side) =>
            points.map((p) => ({ x: p[cost], y: isInterval(p.ci95) && p.ci95[side] > 0 ? p.ci95[side] : p.error }));
        const band = {
            pointRadius: 0,
            pointHitRadius: 0,
            borderWidth: 0,
            backgroundColor: translucent(colour, isDark() ? 0.22 : 0.15),
            isBand: true,
        };
        sets.push(
            { ...band, data: bound(0), fill: false },
            { ...band, data: bound(1), fill: "-1" },
            {
                label: cell.label,
                data: points.map((p) => ({ x: p[cost], y: p.error, ci95: p.ci95 })),
                borderColor: colour,
                backgroundColor: colour,
                borderWidth: 1.8,
                pointRadius: 3.5,
                pointStyle: kPointStyles[cell.order % kPointStyles.length],
                fill: false,
            },
        );
    }
    return sets;
}

/// A dashed line of slope −1 from the upper left, to compare by eye.
function guide(sets) {
    const points = sets.filter((s) => !s.isBand).flatMap((s) => s.data);
    const [x0, x1] = [Math.min(...points.map((p) => p.x)), Math.max(...points.map((p) => p.x))];
    const y0 = Math.max(...points.map((p) => p.y));
    return {
        data: [
            { x: x0, y: y0 },
            { x: x1, y: (y0 * x0) / x1 },
        ],
        isBand: true,
        borderColor: css("--muted"),
        borderDash: [4, 4],
        borderWidth: 1,
        pointRadius: 0,
        pointHitRadius: 0,
        fill: false,
    };
}

function logAxis(title, format, most) {
    return {
        type: "logarithmic",
        title: { display: true, text: title, color: css("--muted"), padding: 2 },
        grid: { color: css("--rule"), borderColor: css("--muted"), tickLength: 4, lineWidth: 0.7 },
        afterBuildTicks: (axis) => {
            axis.ticks = logTicks(axis.min, axis.max, most).map((value) => ({ value }));
        },
        ticks: { color: css("--ink"), callback: format, maxRotation: 0, autoSkip: false },
    };
}

function costChart(group, cost, title) {
    const sets = costDatasets(group, cost);
    if (!sets.length) return null;
    const canvas = el("canvas", {
        role: "img",
        "aria-label": `${metricName(primaryMetric)} against ${title}, ${group.title}; the table of cells has the figures`,
    });
    const points = sets.filter((s) => !s.isBand).flatMap((s) => s.data);
    const bounds = sets.flatMap((s) => s.data.map((p) => p.y));
    requestAnimationFrame(() => {
        liveCharts.push(
            new Chart(canvas, {
                type: "line",
                data: { datasets: [guide(sets), ...sets] },
                options: {
                    animation: false,
                    responsive: true,
                    maintainAspectRatio: false,
                    parsing: false,
                    normalized: false,
                    interaction: { mode: "nearest", intersect: false },
                    font: { family: css("--sans") },
                    scales: {
                        x: {
                            ...logAxis(title, (v) => count(v, plain), 6),
                            min: Math.min(...points.map((p) => p.x)) / 1.15,
                            max: Math.max(...points.map((p) => p.x)) * 1.15,
                        },
                        y: {
                            ...logAxis(metricName(primaryMetric), plain, 9),
                            min: Math.min(...bounds) / 1.15,
                            max: Math.max(...bounds) * 1.15,
                        },
                    },
                    plugins: {
                        legend: { display: false },
                        tooltip: {
                            filter: (item) => !item.dataset.isBand,
                            displayColors: false,
                            callbacks: {
                                title: () => "",
                                label: ({ dataset, raw }) => [
                                    dataset.label,
                                    `${number(raw.y)}${isInterval(raw.ci95) ? `  (${interval(raw.ci95)})` : ""}`,
                                    `at ${count(raw.x)} ${title}`,
                                ],
                            },
                        },
                    },
                },
            }),
        );
    });
    return el("figure", { class: "chart" }, el("div", {}, canvas));
}

function pointMark(cell) {
    const shapes = {
        circle: () => svg("circle", { cx: 14, cy: 6, r: 4 }),
        rect: () => svg("rect", { x: 10.5, y: 2.5, width: 7, height: 7 }),
        rectRot: () => svg("path", { d: "M14 1l5 5-5 5-5-5z" }),
        triangle: () => svg("path", { d: "M14 1.5l5 8.5h-10z" }),
    };
    const colour = samplerColour(cell.order);
    const shape =
        shapes[kPointStyles[cell.order % kPointStyles.length]] ??
        (() => svg("path", { d: "M10 2l8 8m0-8l-8 8", stroke: colour }));
    return svg(
        "svg",
        { class: "point-mark", viewBox: "0 0 28 12", width: 28, height: 12, fill: colour, "aria-hidden": true },
        svg("line", { x1: 0, x2: 28, y1: 6, y2: 6, stroke: colour, "stroke-width": 1.8 }),
        shape(),
    );
}

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
                    pointMark(cell),
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
    liveCharts.splice(0).forEach((chart) => chart.destroy());
    const drawn = groups.filter((group) => group.cells.some((cell) => cell.convergence?.length));
    if (!drawn.length) return null;
    return section(
        "convergence",
        "Error against cost",
        "Snapshots inside each run, mean over runs, band: 95 % interval. The slope is fitted to log error against log cost.",
        drawn.map((group) =>
            el(
                "div",
                { class: "group" },
                el("h3", {}, group.title),
                slopeLegend(group),
                el(
                    "div",
                    { class: "charts" },
                    kCosts.map(([cost, title]) => costChart(group, cost, title)),
                ),
            ),
        ),
    );
}
