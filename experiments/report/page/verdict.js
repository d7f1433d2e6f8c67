// The answer first: one sentence per comparison, its ratio with interval drawn beside it, and what the holes say.

const kVerdictWords = ["better", "worse", "undecided"];

function sentenceWithMarkedVerdict(comparison) {
    const word = comparison.verdict;
    const at = kVerdictWords.includes(word) ? comparison.sentence.lastIndexOf(word) : -1;
    if (at < 0) return [comparison.sentence];
    return [
        comparison.sentence.slice(0, at),
        el("strong", { class: `verdict ${word}` }, word),
        comparison.sentence.slice(at + word.length),
    ];
}

/// What an image metric hides: whether the brightness of the holes is right.
function holeSentence(cell, baseline) {
    if (!cell?.grid) return null;
    const error =
        isNumber(cell.holeError) &&
        `one run gets a hole’s brightness wrong by ${percent(cell.holeError)} (RMS` +
            `${isNumber(baseline?.holeError) ? `; ${baseline.label} ${percent(baseline.holeError)}` : ""})`;
    const wrong =
        isNumber(cell.wrongHoles) &&
        `over all runs ${cell.wrongHoles} of ${cell.judgedHoles}${cell.unjudgedHoles ? " that can be tested" : ""} are significantly wrong` +
            `${isNumber(baseline?.wrongHoles) ? ` (${baseline.label} ${baseline.wrongHoles})` : ""}`;
    const parts = [error, wrong].filter(Boolean);
    if (!parts.length) return null;
    const verdict = comparisonsOf(cell)[0]?.verdict;
    const hidden = verdict === "better" && baseline?.holeError < cell.holeError;
    return el(
        "p",
        { class: "holes-say" },
        `Holes: ${parts.join("; ")}. `,
        hidden && el("strong", { class: "flag" }, "The pixels are closer, the holes are not."),
    );
}

function speedupSentence(comparison) {
    const { speedup, speedup_ci95: ci95, baseline } = comparison,
        range = interval(ci95);
    if (!isNumber(speedup) && !range) return null;
    const value = isNumber(speedup)
        ? `${number(speedup)} ×${range && ` (${kConfidence} ${range})`}`
        : `${baseline} has no snapshot at this error (${kConfidence} ${range} ×)`;
    return el("p", { class: "speedup" }, `Speed-up at equal error: ${value}.`);
}

function ratioScale() {
    const values = comparisons.flatMap((c) => [c.ratio, ...(isInterval(c.ci95) ? c.ci95 : [])]).filter((v) => v > 0);
    if (!values.length) return null;
    const lo = Math.min(0.5, ...values) / 1.15,
        hi = Math.max(2, ...values) * 1.15;
    return { lo, hi, at: (v) => Math.log(clamp(v, lo, hi) / lo) / Math.log(hi / lo) };
}

const kForest = { width: 300, height: 34, margin: 14 };
const forestX = (scale, value) => kForest.margin + scale.at(value) * (kForest.width - 2 * kForest.margin);

function forestRow(comparison, scale) {
    const x = (v) => forestX(scale, v).toFixed(1),
        y = kForest.height / 2;
    const root = svg("svg", {
        class: `forest ${comparison.verdict ?? ""}`,
        viewBox: `0 0 ${kForest.width} ${kForest.height}`,
        role: "img",
        "aria-label": `ratio ${number(comparison.ratio)}, ${kIntervalName} ${interval(comparison.ci95)}`,
    });
    root.append(svg("line", { class: "one", x1: x(1), x2: x(1), y1: 0, y2: kForest.height }));
    if (isInterval(comparison.ci95) && comparison.ci95[0] > 0)
        root.append(
            svg("line", { class: "whisker", x1: x(comparison.ci95[0]), x2: x(comparison.ci95[1]), y1: y, y2: y }),
        );
    if (comparison.ratio > 0) root.append(svg("circle", { cx: x(comparison.ratio), cy: y, r: 5 }));
    return root;
}

function forestAxis(scale) {
    const root = svg(
        "svg",
        { class: "forest axis", viewBox: `0 0 ${kForest.width} 32`, "aria-hidden": true },
        svg("line", { class: "base", x1: kForest.margin, x2: kForest.width - kForest.margin, y1: 1, y2: 1 }),
    );
    for (const tick of logTicks(scale.lo, scale.hi)) {
        const x = forestX(scale, tick).toFixed(1);
        root.append(svg("line", { class: "base", x1: x, x2: x, y1: 1, y2: 5 }), svg("text", { x, y: 17 }, plain(tick)));
    }
    root.append(
        svg("text", { class: "start", x: kForest.margin, y: 30 }, "← less error"),
        svg("text", { class: "end", x: kForest.width - kForest.margin, y: 30 }, "more error →"),
    );
    return root;
}

/// All comparisons in one plot for paper.
function forestFigure(name) {
    const judged = comparisons.filter((c) => c.ratio > 0),
        labels = judged.map((c) => {
            const cell = cells.find((other) => comparisonsOf(other).includes(c));
            return `${cell?.group.title ?? c.scene}: ${cell?.label ?? c.sampler}`;
        }),
        texts = judged.map(
            (c) => `${number(c.ratio, 2)}${isInterval(c.ci95) ? ` (${interval(c.ci95, (v) => number(v, 2))})` : ""}`,
        );
    const row = 18,
        top = 22,
        left = Math.max(...labels.map((text) => textWidth(text))) + 12,
        right = left + 220,
        bottom = top + row * judged.length;
    const ends = judged.flatMap((c) => [c.ratio, ...(isInterval(c.ci95) ? c.ci95 : [])]).filter((v) => v > 0);
    const x = makeScale({ log: true, values: [0.5, 2, ...ends] }, left, right);
    const muted = css("--muted");
    const colours = { better: css("--better"), worse: css("--worse") };
    const root = plotRoot(right + 12 + Math.max(...texts.map((text) => textWidth(text))), bottom + 34, name);
    root.append(
        svg("line", { x1: x.at(1), x2: x.at(1), y1: top - 6, y2: bottom, stroke: muted, "stroke-dasharray": "3 3" }),
        svg("line", { x1: left, x2: right, y1: bottom, y2: bottom, stroke: muted }),
        textAt(
            (left + right) / 2,
            bottom + 29,
            `${metricName(primaryMetric)} over that of ${[...new Set(judged.map((c) => c.baseline))].join(", ")}`,
            { "text-anchor": "middle", fill: muted },
        ),
        textAt(right + 8, 10, `ratio (${kConfidence})`, { fill: muted }),
        ...x
            .spacedTicks()
            .flatMap((tick) => [
                svg("line", { x1: tick.at, x2: tick.at, y1: bottom, y2: bottom + 4, stroke: muted }),
                textAt(tick.at, bottom + 15, tick.text, { "text-anchor": "middle" }),
            ]),
    );
    judged.forEach((c, i) => {
        const y = top + row * (i + 0.5),
            colour = colours[c.verdict] ?? muted;
        root.append(
            ...[
                textAt(0, y + 4, labels[i]),
                isInterval(c.ci95) &&
                    c.ci95[0] > 0 &&
                    svg("line", {
                        x1: x.at(c.ci95[0]),
                        x2: x.at(c.ci95[1]),
                        y1: y,
                        y2: y,
                        stroke: colour,
                        "stroke-width": 2,
                    }),
                svg("circle", { cx: x.at(c.ratio), cy: y, r: 4, fill: colour }),
                textAt(right + 8, y + 4, texts[i]),
            ].filter(Boolean),
        );
    });
    return root;
}

function verdictSection() {
    if (!comparisons.length)
        return section(
            "verdict",
            "Verdict",
            "No comparison: the experiment names no baseline or has one sampler only.",
        );
    const scale = ratioScale();
    const rows = [];
    for (const scene of new Set(comparisons.map((c) => c.scene))) {
        rows.push(el("h3", {}, scene));
        for (const comparison of comparisons.filter((c) => c.scene === scene)) {
            const cell = cells.find((c) => comparisonsOf(c).includes(comparison));
            rows.push(
                el(
                    "div",
                    { class: "verdict-row" },
                    el(
                        "div",
                        {},
                        el("p", { class: "sentence" }, sentenceWithMarkedVerdict(comparison)),
                        speedupSentence(comparison),
                        cell && holeSentence(cell, baselineOf(cell)),
                    ),
                    scale && forestRow(comparison, scale),
                ),
            );
        }
    }
    const one = scale ? `--one: ${forestX(scale, 1) / kForest.width}` : null;
    return section(
        "verdict",
        "Verdict",
        null,
        el(
            "div",
            { class: "verdicts", style: one },
            rows,
            scale && el("div", { class: "verdict-row" }, el("span"), forestAxis(scale)),
        ),
        scale && saveButtons("ratios of all comparisons", () => forestFigure("ratios of all comparisons")),
        el(
            "p",
            { class: "note" },
            `The ratio is E[${metricName(primaryMetric)}] of the sampler over that of the baseline at equal `,
            `budget, with its ${kIntervalName}; a verdict needs p ≤ 0.05 in a ${kTestName}, after ${kCorrectionName}.`,
        ),
    );
}
