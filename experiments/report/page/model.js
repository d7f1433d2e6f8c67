// What the files of the run say, gathered by scene. Every field is optional; a panel without its data is left out.

const data = JSON.parse(document.getElementById("data").textContent);
const summary = data.summary;
const cells = (summary.cells ?? []).map((cell) => ({ ...cell, result: data.results[cell.cell] ?? {} }));
const comparisons = summary.comparisons ?? [];
const primaryMetric = summary.primary_metric ?? Object.keys(cells[0]?.metrics ?? {})[0];
const kMetricNames = {
    relmse: "relMSE",
    mse: "MSE",
    mae: "MAE",
    mape: "MAPE",
    smape: "SMAPE",
    psnr: "PSNR",
    ssim: "SSIM",
    flip: "FLIP",
};
/// In words: "2 s or 1 M rays".
const budgetText = (budget) =>
    Object.entries(budget ?? {})
        .map(([kind, value]) => `${count(value, plain)} ${kind === "time" ? "s" : kind}`)
        .join(" or ");
const metricName = (metric) => kMetricNames[metric] ?? metric;

// How errors are compared, in words: docs/statistics.md. Several looks share the 5 % between them.
const kLooks = data.resolved?.looks ?? comparisons[0]?.looks ?? 1;
const kPaired = data.resolved?.common_random_numbers ?? comparisons[0]?.paired ?? false;
const kConfidence = kLooks > 1 ? percent(1 - 0.05 / kLooks) : "95 %";
const kIntervalName = `${kConfidence} interval${kLooks > 1 ? ` (95 % over all ${kLooks} looks)` : ""}`;
const kTestName = kPaired ? "sign-flip test of pairs with common random numbers" : "permutation test of complete runs";
const kCorrectionName = `Holm’s correction over all comparisons of the run${kLooks > 1 ? `, times ${kLooks} looks` : ""}`;

/// The numbers of a feature called "hole_ROW_COL".
const holeIndex = (name) => /^hole_(\d+)_(\d+)$/.exec(name)?.slice(1).map(Number);

/// Feature occupancy of a cell as a grid, row 0 at the top of the image, or null.
function holeGrid(cell) {
    const features = Object.entries(cell.features ?? {}).filter(([name]) => holeIndex(name));
    if (features.length < 2) return null;
    const rows = cell.feature_grid?.[0] ?? 1 + Math.max(...features.map(([name]) => holeIndex(name)[0]));
    const columns = cell.feature_grid?.[1] ?? 1 + Math.max(...features.map(([name]) => holeIndex(name)[1]));
    const holes = features.map(([name, feature]) => {
        const [row, column] = holeIndex(name);
        const ratio = feature.truth > 0 ? feature.share / feature.truth : NaN;
        const ratios = (feature.per_replicate ?? []).map((share) =>
            feature.truth > 0 && isNumber(share) ? share / feature.truth : NaN,
        );
        return {
            ...feature,
            row,
            column,
            ratio,
            ratios,
            wrong: isNumber(feature.p_adjusted) && feature.p_adjusted <= 0.05,
        };
    });
    return { rows, columns, holes };
}

/// Arrays over replicates hold the finished ones alone; their numbers are those of the folders.
const replicateNumber = (cell, index) => cell.replicate_numbers?.[index] ?? index;
const replicateIndex = (cell, number) => cell.replicate_numbers?.indexOf(number) ?? number;

/// Relative error of a hole's brightness in one run: root mean square over holes, for each replicate.
function replicateHoleErrors(grid) {
    const replicates = Math.max(0, ...grid.holes.map((hole) => hole.ratios.length));
    return Array.from({ length: replicates }, (_, r) =>
        rootMeanSquare(grid.holes.map((hole) => hole.ratios[r] - 1).filter(isNumber)),
    );
}

for (const cell of cells) {
    cell.grid = holeGrid(cell);
    if (!cell.grid) continue;
    cell.unjudgedHoles = cell.grid.holes.filter((hole) => isNumber(hole.truth) && !isNumber(hole.p_adjusted)).length;
    cell.judgedHoles = cell.grid.holes.filter((hole) => isNumber(hole.p_adjusted)).length;
    cell.wrongHoles = cell.judgedHoles > 0 ? cell.grid.holes.filter((hole) => hole.wrong).length : null;
    cell.holeErrors = replicateHoleErrors(cell.grid);
    const known = cell.holeErrors.filter(isNumber);
    cell.holeError = known.length ? rootMeanSquare(known) : null;
}

const samplerNames = [...new Set(cells.map((cell) => cell.sampler))];

/// Cells that share scene and reference can be compared: a group. A sweep over the scene gives several.
const groups = [];
for (const cell of cells) {
    const key = JSON.stringify([cell.scene, cell.reference_image ?? cell.reference ?? ""]);
    let group = groups.find((g) => g.key === key);
    if (!group) groups.push((group = { key, scene: cell.scene, cells: [] }));
    group.cells.push(cell);
    cell.group = group;
}
/// "holes" of "scenes.hidden.holes", "mlt.chains" of "samplers.mlt.chains".
const pathName = (path) => path.replace(/^(scenes\.[^.]+|samplers)\./, "");
const valueText = (value) =>
    isNumber(value) ? plain(value) : typeof value === "string" ? value : JSON.stringify(value);
const settingsText = (entries) => entries.map(([path, value]) => `${pathName(path)} = ${valueText(value)}`).join(", ");

/// The swept values that all these cells share, and others of their scene do not.
function sharedSettings(cells, others) {
    const same = (all, path, value) =>
        all.every((cell) => JSON.stringify(cell.sweep?.[path]) === JSON.stringify(value));
    return Object.entries(cells[0].sweep ?? {}).filter(
        ([path, value]) => same(cells, path, value) && !same(others, path, value),
    );
}

for (const group of groups) {
    const twins = groups.filter((other) => other.scene === group.scene);
    const shared = sharedSettings(
        group.cells,
        twins.flatMap((other) => other.cells),
    );
    const settings = settingsText(shared) || `${twins.indexOf(group) + 1}`;
    group.title = twins.length === 1 ? group.scene : `${group.scene} (${settings})`;
    group.id = `scene-${groups.indexOf(group)}`;
    for (const cell of group.cells) {
        const own = group.cells.filter((other) => other.sampler === cell.sampler);
        const settings = settingsText(own.length > 1 ? sharedSettings([cell], own) : []).replaceAll(
            `${cell.sampler}.`,
            "",
        );
        cell.label = own.length === 1 ? cell.sampler : settings ? `${cell.sampler} (${settings})` : cell.cell;
        cell.order = own.length === 1 ? samplerNames.indexOf(cell.sampler) : group.cells.indexOf(cell);
    }
}

/// The comparisons that judge a cell (those of a sweep name their cells), and their finished sentences.
comparisons.forEach((comparison, i) => {
    comparison.sentence = summary.verdicts?.[i] ?? verdictSentence(comparison);
});
const comparisonsOf = (cell) =>
    comparisons.filter((c) =>
        c.cell !== undefined ? c.cell === cell.cell : c.scene === cell.scene && c.sampler === cell.sampler,
    );
const baselineOf = (cell) => {
    const comparison = comparisonsOf(cell)[0];
    return cell.group.cells.find((other) =>
        comparison?.baseline_cell ? other.cell === comparison.baseline_cell : other.sampler === comparison?.baseline,
    );
};

function verdictSentence(c) {
    const ratio = isNumber(c.ratio)
        ? `${c.sampler}’s ${metricName(c.metric)} is ${number(c.ratio)} × ${c.baseline}’s (${kConfidence} ${interval(c.ci95)}), p = ${pValue(c.p_adjusted ?? c.p)}`
        : `${c.sampler} against ${c.baseline}`;
    return `${ratio}: ${c.verdict ?? "undecided"}.`;
}

const pictureIds = (cell) => data.pictures[cell.cell] ?? {};
const referenceId = (group) => group.cells.map((cell) => pictureIds(cell).reference).find((id) => id !== undefined);
