// The table of cells: every figure with its interval.

/// Mean and interval on a log scale shared by the column.
function whiskers(metric, all) {
    const values = all.flatMap((m) => [m.mean, ...(isInterval(m.ci95) ? m.ci95 : [])]).filter((v) => v > 0);
    if (!values.length || !(metric.mean > 0)) return null;
    const lo = Math.min(...values),
        hi = Math.max(...values);
    const x = (v) => 4 + (hi > lo ? Math.log(Math.max(v, lo) / lo) / Math.log(hi / lo) : 0.5) * 72;
    return svg(
        "svg",
        { class: "whiskers", viewBox: "0 0 80 8", width: 80, height: 8, "aria-hidden": true },
        svg("line", { class: "base", x1: 4, x2: 76, y1: 4, y2: 4 }),
        isInterval(metric.ci95) &&
            svg("rect", { x: x(metric.ci95[0]), width: x(metric.ci95[1]) - x(metric.ci95[0]), y: 1.5, height: 5 }),
        svg("line", { class: "mean", x1: x(metric.mean), x2: x(metric.mean), y1: 0, y2: 8 }),
    );
}

const metricCell = (cell, metric, bare) => {
    const m = cell.metrics?.[metric];
    if (!m) return [kDash];
    const all = cells.map((c) => c.metrics?.[metric]).filter(Boolean);
    return [number(m.mean), !bare && el("span", { class: "ci" }, interval(m.ci95)), !bare && whiskers(m, all)];
};

function cellColumns() {
    const metrics = [...new Set(cells.flatMap((cell) => Object.keys(cell.metrics ?? {})))];
    const primary = (cell) => cell.metrics?.[primaryMetric];
    const comparison = (cell) => comparisonsOf(cell)[0];
    const columns = [
        { title: "scene", value: (c) => c.group.title },
        { title: "sampler", value: (c) => c.label, show: (c) => [samplerMark(c), c.label] },
        {
            title: "runs",
            meaning: "replicates: complete runs with seeds of their own",
            value: (c) => c.replicates,
            show: (c) => c.replicates ?? kDash,
        },
        {
            title: metricName(primaryMetric),
            meaning: `primary metric: mean over runs, ${kIntervalName}`,
            kind: "wide",
            value: (c) => primary(c)?.mean,
            show: (c) => metricCell(c, primaryMetric, false),
        },
        {
            title: "worst run",
            meaning: `${metricName(primaryMetric)} of the worst run`,
            value: (c) => primary(c)?.worst_replicate,
        },
        {
            title: "trimmed",
            meaning: `${metricName(primaryMetric)} without the worst 0.1 % of the pixels`,
            value: (c) => primary(c)?.trimmed_mean,
        },
        {
            title: "ratio",
            meaning: `to the baseline’s error, ${kIntervalName}`,
            value: (c) => comparison(c)?.ratio,
            show: (c) => [number(comparison(c)?.ratio), el("span", { class: "ci" }, interval(comparison(c)?.ci95))],
        },
        {
            title: "p",
            meaning: `${kTestName}, after ${kCorrectionName}`,
            value: (c) => comparison(c)?.p_adjusted ?? comparison(c)?.p,
            show: (c) => pValue(comparison(c)?.p_adjusted ?? comparison(c)?.p),
        },
        {
            title: "speed-up",
            meaning: "time of the baseline to this error, over this sampler’s time",
            value: (c) => comparison(c)?.speedup,
        },
        ...metrics
            .filter((metric) => metric !== primaryMetric)
            .map((metric) => ({
                title: metricName(metric),
                meaning: "mean over runs; describes, carries no verdict",
                value: (c) => c.metrics?.[metric]?.mean,
                hover: (c) => `${kConfidence} ${interval(c.metrics?.[metric]?.ci95)}`,
            })),
        { title: "variance", value: (c) => c.variance },
        {
            title: "bias²",
            meaning: "squared distance of the mean image, less what noise explains",
            value: (c) => c.bias_squared,
        },
        {
            title: "hole error",
            meaning: "relative error of a hole’s brightness in one run, RMS over holes and runs",
            value: (c) => c.holeError,
            show: (c) => percent(c.holeError),
        },
        {
            title: "holes wrong",
            meaning: "holes whose share differs from the truth (t test over runs, Holm, p ≤ 0.05)",
            value: (c) => c.wrongHoles,
            show: (c) => (isNumber(c.wrongHoles) ? `${c.wrongHoles} / ${c.judgedHoles}` : kDash),
            alarm: (c) => c.wrongHoles > 0,
        },
        {
            title: "CV b",
            meaning: "coefficient of variation of the normalisation over runs: the global scale error",
            value: (c) => c.normalization_cv,
            show: (c) => percent(c.normalization_cv),
        },
        {
            title: "slope",
            meaning: "of log error against log time; −1 is what independent samples reach",
            value: (c) => c.slope?.value,
            show: (c) => slopeText(c.slope?.value),
            alarm: (c) => c.slope?.flatter_than_minus_one,
        },
        { title: "seconds", value: (c) => c.seconds },
        { title: "rays", value: (c) => c.rays, show: (c) => count(c.rays) },
        { title: "mutations", value: (c) => c.mutations, show: (c) => (c.mutations ? count(c.mutations) : kDash) },
    ];
    const present = (column) =>
        cells.some((cell) => {
            const value = column.value(cell);
            return (
                value !== null && value !== undefined && value !== "" && !(column.title === "mutations" && value === 0)
            );
        });
    return columns.filter(present);
}

/// As the sampler's points in plots.
const samplerMark = (cell) =>
    svg(
        "svg",
        { class: "mark", viewBox: "0 0 12 12", width: 12, height: 12, "aria-hidden": true },
        pointMark(cell.order, 6, 6, samplerColour(cell.order), 4),
    );

function cellsSection() {
    return section(
        "cells",
        "Cells",
        `One row per scene and sampler. Errors and ratios have a ${kIntervalName}, from complete runs. A heading sorts; hover explains it.`,
        sortableTable("cells", cellColumns(), cells, { id: "cell-table" }),
    );
}
