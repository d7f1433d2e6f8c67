// What the viewer can show of a picture, what the colours of it mean, and where its crops begin.

const errorScale = (title) => ({
    map: magma,
    labels: [0.01, 0.1, 1, 10].map(percent).map((text) => text.replace(".0", "")),
    title,
});

/// Of how many pixels, n × n, one of the page's pictures is the mean.
const kShrink = data.shrink ?? 1;
const squares = (n) => `${n} × ${n} pixels`;

/// By key; `map` is what stands for the picture of a cell, `scale` and `meaning` explain it. Of what shows noise, `block` is
/// the edge of the squares of pixels whose means it shows.
const kShows = [
    { id: "tones", name: "picture" },
    {
        id: "error",
        key: "e",
        name: "relative error",
        scale: errorScale(kShrink > 1 ? "relative error" : "relative error of a pixel"),
        meaning: "√ of the mean over channels of (x − r)² ∕ (r² + 0.01): what relMSE averages, before the square.",
        block: () => kShrink,
    },
    {
        id: "deviation",
        key: "d",
        name: "spread over runs",
        map: (ids) => blockMap(ids.deviation, deviationColour),
        scale: errorScale("relative standard deviation"),
        meaning:
            "Of luminance over runs, relative to √(mean² + 0.01): the error of one run that is noise. What is brighter in the map of errors is bias, or luck.",
        block: (cell) => blockMap(pictureIds(cell).deviation, deviationColour)?.block ?? 1,
    },
    {
        id: "tests",
        key: "p",
        name: "p-values",
        map: (ids) => blockMap(ids.tests, testColour),
        scale: {
            map: (t) => diverging(2 * t - 1),
            labels: ["p ≤ 10⁻⁴", "1", "p ≤ 10⁻⁴"],
            title: "too dark · too bright",
        },
        meaning:
            "Is the mean over runs the reference? Welch’s test corrected for skewness, at a false discovery rate of 5 %. Grey: not judged, the runs scatter too much or not at all.",
        note: testsNote,
    },
    {
        id: "rhat",
        key: "m",
        name: "R̂",
        map: (ids) => blockMap(ids.rhat, rhatColour),
        scale: { map: magma, labels: ["1", "2", "≥ 4"], title: "R̂ of the pixels of a block" },
        meaning:
            "Do runs of chains differ more than the two halves of one run do? Near 1 they mix; where each run stays with what it found first, R̂ is large. Grey: nothing varies.",
        note: rhatNote,
    },
    {
        id: "acceptance",
        key: "a",
        name: "acceptance",
        map: (ids) => blockMap(ids.acceptance, acceptanceColour),
        scale: { map: magma, labels: ["0 %", "50 %", "100 %"], title: "proposals accepted" },
        meaning:
            "Share of the proposals that chains in a pixel accepted, over all runs and mutations. Dark: chains stay there. Grey: no chain was there.",
    },
];
const showOf = (id) => kShows.find((show) => show.id === id);

/// The scale of what is shown of a group, and whether means make its noise smaller than that of pixels.
function scaleOf({ scale, block }, group) {
    const n = block ? Math.max(...group.cells.map(block)) : 1;
    return n > 1 ? { ...scale, title: `${scale.title}, of means over ${squares(n)}`, ofMeans: true } : scale;
}

function showLegend(show, group) {
    const scale = scaleOf(show, group);
    if (!scale) return [];
    const smaller = scale.ofMeans ? " Of means over several pixels: noise reads smaller than that of a pixel." : "";
    return [colourBar(scale.map, scale.labels, scale.title), el("p", {}, show.meaning, smaller)];
}

/// What the tests over a cell's map found, in words.
function testsNote(cell) {
    const map = showOf("tests").map(pictureIds(cell));
    if (!map) return "";
    const tests = [...map.bytes].map(testOf).filter(Boolean),
        wrong = tests.filter(({ p }) => p <= 0.05).length;
    const size = map.block > 1 ? `blocks of ${map.block} × ${map.block}` : "pixels";
    return tests.length ? `${wrong} of ${tests.length} ${size} differ` : "nothing can be judged";
}

const kMixedRhat = 1.2; // what the noise of eight runs leaves behind it only rarely

/// In how much of a cell's picture runs have not mixed, in words.
function rhatNote(cell) {
    const map = showOf("rhat").map(pictureIds(cell));
    if (!map) return "";
    const judged = [...map.bytes].map(rhatOf).filter((rhat) => rhat !== null),
        apart = judged.filter((rhat) => rhat > kMixedRhat).length;
    return judged.length ? `R̂ above ${kMixedRhat} in ${percent(apart / judged.length)} of it` : "nothing varies";
}

/// What the runs of a cell say of a place of its picture, in words.
function placeNote(cell, u, v) {
    const ids = pictureIds(cell),
        deviation = showOf("deviation").map(ids)?.at(u, v),
        test = testOf(showOf("tests").map(ids)?.at(u, v) ?? 0),
        rhat = rhatOf(showOf("rhat").map(ids)?.at(u, v) ?? 0),
        acceptance = acceptanceOf(showOf("acceptance").map(ids)?.at(u, v) ?? 0);
    return [
        isNumber(deviation) && ` · spread over runs ${percent(deviationOf(deviation))}`,
        test && ` · p = ${pValue(test.p)}${test.p <= 0.05 ? `, too ${test.bright ? "bright" : "dark"}` : ""}`,
        rhat !== null && ` · R̂ ${number(rhat)}`,
        acceptance !== null && ` · acceptance ${percent(acceptance)}`,
    ]
        .filter(Boolean)
        .join("");
}

/// Two crops, in parts of the image: where `judged` is most too bright and most too dark, over an 8×8 division of it.
function defaultCrops(judged, reference) {
    const size = 1 / 6,
        at = (u, v) => ({ u: clamp(u, size / 2, 1 - size / 2), v: clamp(v, size / 2, 1 - size / 2), size });
    if (!judged || !reference) return [at(0.3, 0.3), at(0.7, 0.7)];
    const { width, height } = reference,
        blocks = Array.from({ length: 64 }, (_, i) => ({ i, excess: 0 }));
    for (let y = 0; y < height; ++y)
        for (let x = 0; x < width; ++x) {
            const block = blocks[Math.floor((8 * y) / height) * 8 + Math.floor((8 * x) / width)];
            const p = 3 * (y * width + x) + 1;
            block.excess += clamp(judged.rgb[p], 0, 10 * reference.rgb[p]) - reference.rgb[p];
        }
    blocks.sort((a, b) => a.excess - b.excess);
    return [blocks.at(-1), blocks[0]].map(({ i }) => at(((i % 8) + 0.5) / 8, (Math.floor(i / 8) + 0.5) / 8));
}
