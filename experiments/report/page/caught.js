// A chain caught in one hole: the worst run's picture beside the reference, and the hole map of that very run.

/// The map of one run as a tiny canvas, a pixel per hole.
function miniMap(grid, index, colour) {
    const canvas = el("canvas", { width: grid.columns, height: grid.rows, "aria-hidden": true });
    const context = canvas.getContext("2d");
    for (const hole of grid.holes) {
        const rgb = colour(hole.ratios[index]);
        if (!rgb) continue;
        context.fillStyle = rgbToCss(rgb);
        context.fillRect(hole.column, hole.row, 1, 1);
    }
    return canvas;
}

const largestHoleError = (cell) => Math.max(...cell.holeErrors.filter(isNumber));

function caughtSentence(cell, index) {
    const holes = cell.grid.holes.filter((hole) => isNumber(hole.ratios[index]));
    const brightest = holes.reduce((a, b) => (b.ratios[index] > a.ratios[index] ? b : a));
    const starved = holes.filter((hole) => hole.ratios[index] < 0.5).length,
        empty = holes.filter((hole) => hole.ratios[index] === 0).length;
    return [
        `In run ${replicateNumber(cell, index)} of ${cell.label}, the hole in row ${brightest.row + 1}, column ${brightest.column + 1} got `,
        el("b", {}, `${number(brightest.ratios[index])} ×`),
        " its true share; ",
        el("b", {}, `${starved || "none"} of ${holes.length}`),
        ` holes got less than half of theirs${empty ? `, ${empty} nothing at all` : ""}. `,
        `A hole’s brightness is off by ${percent(cell.holeErrors[index])} (RMS).`,
    ];
}

function caughtFigure(title, content, id) {
    return el("figure", { id }, content, el("figcaption", {}, title));
}

function still(id, exposure, label) {
    const image = picture(id);
    if (!image) return el("p", { class: "note" }, "no image");
    const canvas = el("canvas", { width: image.width, height: image.height, role: "img", "aria-label": label });
    canvas.getContext("2d").drawImage(image.shown(exposure), 0, 0);
    return canvas;
}

function caughtPanel(cell) {
    const { grid } = cell,
        ids = pictureIds(cell);
    const worst =
        [ids.worst_replicate, cell.worst_replicate]
            .map((number) => replicateIndex(cell, number))
            .find((index) => isNumber(cell.holeErrors[index])) ?? cell.holeErrors.indexOf(largestHoleError(cell));
    const run = replicateNumber(cell, worst),
        image = run === ids.worst_replicate ? ids.worst : null;
    const limit = ratioLimit(grid.holes.flatMap((hole) => hole.ratios)),
        colour = ratioColour(limit);
    const describe = (hole) => [
        holeTitle(hole),
        line(`${number(hole.ratios[worst])} × its true share in run ${run}`),
        line(`mean over runs ${number(hole.ratio)} ×`),
    ];
    const reference = picture(ids.reference),
        exposure = reference ? fittingExposure(reference) : 0;
    const name = `run ${run} of ${cell.label}, ${cell.group.title}`;
    const holes = () =>
        holeMap(grid, {
            name: `run ${run} of ${cell.label}`,
            colour: (hole) => colour(hole.ratios[worst]),
            describe,
        });
    const strip = () => {
        const pictures = [
            ["reference", picture(ids.reference)],
            [`${cell.label}, run ${run}`, picture(image)],
        ].filter(([, image]) => image);
        const parts = pictures.map(([label, image]) => ({
            label,
            canvas: image.shown(exposure),
            aspect: image.width / image.height,
        }));
        parts.push({ label: "its holes: share over true share", svg: holes(), aspect: grid.columns / grid.rows });
        return pictureStrip(name, parts, {
            scale: { map: (t) => diverging(2 * t - 1), labels: ratioLabels(limit), title: "share over true share" },
        });
    };
    return el(
        "div",
        { class: "caught" },
        el("p", { class: "sentence" }, caughtSentence(cell, worst)),
        el(
            "div",
            { class: "caught-figures" },
            caughtFigure("reference", still(ids.reference, exposure, "reference")),
            caughtFigure(
                `${cell.label}, run ${run} (the worst)`,
                still(image, exposure, `${cell.label}, run ${run}`),
            ),
            caughtFigure("its holes: share over true share", holes()),
            el(
                "div",
                { class: "all-runs" },
                ratioBar(limit),
                el("p", { class: "note" }, "All runs: where the light gathers changes from seed to seed."),
                el(
                    "div",
                    { class: "mini-maps" },
                    cell.holeErrors.map((error, r) =>
                        el(
                            "figure",
                            { class: r === worst ? "worst" : null },
                            miniMap(grid, r, colour),
                            el("figcaption", {}, `${replicateNumber(cell, r)}: ${percent(error)}`),
                        ),
                    ),
                ),
            ),
        ),
        saveButtons(name, strip),
    );
}

/// Per scene the sampler whose runs are furthest from the truth is shown first; the others by a choice.
function caughtSection() {
    const drawn = groups
        .map((group) => ({
            group,
            judged: group.cells
                .filter((cell) => isNumber(cell.holeError))
                .sort((a, b) => largestHoleError(b) - largestHoleError(a)),
        }))
        .filter(({ judged }) => judged.length);
    if (!drawn.length) return null;
    return section(
        "caught",
        "A chain caught in one hole",
        "One run of one sampler, the worst of its replicates by the primary metric: the picture may look free of noise while the brightness of its holes is wrong.",
        drawn.map(({ group, judged }) => {
            const panel = el(
                "div",
                {},
                later(() => caughtPanel(judged[0])),
            );
            const choice = el(
                "select",
                {
                    "aria-label": `sampler shown for ${group.title}`,
                    onchange: () => panel.replaceChildren(caughtPanel(judged[choice.selectedIndex])),
                },
                judged.map((cell) => el("option", {}, cell.label)),
            );
            return el("div", { class: "group" }, el("h3", {}, group.title, " ", choice), panel);
        }),
    );
}
