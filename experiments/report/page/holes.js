// Hole occupancy as a picture: measured share over true share, its spread over runs, and jumps between holes.

const kRatioLimits = [1.1, 1.25, 1.5, 2, 3, 4, 8];

/// The smallest round factor that holds nearly all ratios, so that maps beside each other share one scale.
function ratioLimit(ratios) {
    const sizes = ratios
        .filter((r) => r > 0)
        .map((r) => Math.max(r, 1 / r))
        .sort((a, b) => a - b);
    const most = sizes[Math.floor(0.98 * (sizes.length - 1))] ?? 2;
    return kRatioLimits.find((limit) => limit >= most) ?? kRatioLimits.at(-1);
}

/// Null, which shows as hatching, for a hole that got nothing.
const ratioColour = (limit) => (ratio) =>
    ratio > 0 ? diverging(clamp(Math.log(ratio) / Math.log(limit), -1, 1)) : null;

let hatches = 0; // patterns need names of their own in the page

/// An n×n map: one square per hole, told by hover or by the arrow keys; `colour` and `describe` take a hole.
function holeMap(grid, { name, colour, describe, mark }) {
    const root = svg("svg", {
        class: "hole-map",
        viewBox: `0 0 ${grid.columns} ${grid.rows}`,
        role: "img",
        "shape-rendering": "crispEdges",
        "aria-label": `${name}, ${grid.rows} × ${grid.columns} holes; arrow keys read them`,
    });
    const hatch = `hatch-${++hatches}`;
    root.append(
        svg(
            "defs",
            {},
            svg(
                "pattern",
                { id: hatch, width: 0.2, height: 0.2, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
                svg("rect", { width: 0.07, height: 0.2, fill: css("--muted") }),
            ),
        ),
    );
    const squares = new Map();
    for (const hole of grid.holes) {
        const rgb = colour(hole);
        const square = svg("rect", {
            "data-hole": `${hole.row},${hole.column}`,
            x: hole.column,
            y: hole.row,
            width: 1,
            height: 1,
            fill: rgb ? rgbToCss(rgb) : `url(#${hatch})`,
            stroke: css("--paper"),
            "stroke-width": 0.035,
        });
        withTooltip(square, () => describe(hole));
        squares.set(`${hole.row},${hole.column}`, { hole, square });
        root.append(square);
        if (mark?.(hole))
            root.append(
                svg("circle", {
                    class: "significant",
                    cx: hole.column + 0.5,
                    cy: hole.row + 0.5,
                    r: 0.13,
                    fill: rgb ? contrastInk(rgb) : css("--ink"),
                    "shape-rendering": "auto",
                }),
            );
    }
    const cursor = svg("rect", { class: "cursor", width: 1, height: 1, visibility: "hidden" });
    root.append(cursor);
    readByKeys(root, {
        first: [0, 0],
        step: ([row, column], dx, dy) => [clamp(row + dy, 0, grid.rows - 1), clamp(column + dx, 0, grid.columns - 1)],
        show: ([row, column]) => {
            setAttributes(cursor, { x: column, y: row, visibility: "visible" });
            const hole = squares.get(`${row},${column}`)?.hole;
            return [hole ? describe(hole) : "no hole", cursor];
        },
        hide: () => cursor.setAttribute("visibility", "hidden"),
    });
    return root;
}

const holeTitle = (hole) => el("b", {}, `row ${hole.row + 1}, column ${hole.column + 1}`);

function describeHole(hole) {
    return [
        holeTitle(hole),
        line(`${number(hole.ratio)} × its true share`),
        line(
            `share ${percent(hole.share)}${isInterval(hole.share_ci95) ? ` (${interval(hole.share_ci95, percent)})` : ""}, truth ${percent(hole.truth)}`,
        ),
        isNumber(hole.p_adjusted) && line(`p = ${pValue(hole.p_adjusted)}${hole.wrong ? ", significantly wrong" : ""}`),
        isNumber(hole.relative_sd) && line(`relative standard deviation over runs ${percent(hole.relative_sd)}`),
        isNumber(hole.jumps_per_million) && line(`${number(hole.jumps_per_million)} jumps to it per million mutations`),
    ].filter(Boolean);
}

/// The maps of a cell for paper, with their scale.
function occupancyFigure(cell, scales, paperName) {
    const map = (name, colour, mark) => ({
        label: name,
        svg: holeMap(cell.grid, { name, colour, describe: describeHole, mark }),
        aspect: cell.grid.columns / cell.grid.rows,
    });
    return pictureStrip(
        paperName,
        [
            map(
                cell.label,
                (hole) => scales.ratio(hole.ratio),
                (hole) => hole.wrong,
            ),
        ],
        {
            width: kPlotWidth,
            scale: {
                map: (t) => diverging(2 * t - 1),
                labels: ratioLabels(scales.limit),
                title: "share over true share",
            },
        },
    );
}

function occupancyCard(cell, scales) {
    const { grid } = cell;
    const small = (field, limit, name, show) => {
        if (!limit || !grid.holes.some((hole) => isNumber(hole[field]))) return null;
        const colour = (hole) => (isNumber(hole[field]) ? viridis(Math.sqrt(clamp(hole[field] / limit, 0, 1))) : null);
        const values = grid.holes.map((hole) => hole[field]).filter(isNumber);
        return el(
            "figure",
            {},
            holeMap(grid, { name: `${cell.label}: ${name}`, colour, describe: describeHole }),
            el("figcaption", {}, `${name} `, el("b", {}, show(mean(values)))),
        );
    };
    const paperName = `occupancy, ${cell.group.title}, ${cell.label}`;
    const facts = [
        isNumber(cell.wrongHoles) &&
            `${cell.wrongHoles} of ${cell.judgedHoles}${cell.unjudgedHoles ? " tested" : ""} significantly wrong`,
        cell.unjudgedHoles > 0 && `${cell.unjudgedHoles} scatter too much to be tested`,
        isNumber(cell.holeError) && `${percent(cell.holeError)} RMS in one run`,
    ].filter(Boolean);
    return el(
        "div",
        { class: "hole-card" },
        el("h4", {}, samplerMark(cell), cell.label),
        el("p", { class: cell.wrongHoles ? "alarming" : null }, facts.join(" · ")),
        el(
            "div",
            { class: "hole-maps" },
            el(
                "figure",
                {},
                holeMap(grid, {
                    name: `${cell.label}: share over true share`,
                    colour: (hole) => scales.ratio(hole.ratio),
                    describe: describeHole,
                    mark: (hole) => hole.wrong,
                }),
                saveButtons(paperName, () => occupancyFigure(cell, scales, paperName)),
            ),
            el(
                "div",
                { class: "small-maps" },
                small("relative_sd", scales.sd, "spread over runs", percent),
                small("jumps_per_million", scales.jumps, "jumps to it ∕ 10⁶ mut.", number),
            ),
        ),
    );
}

const ratioLabels = (limit) => [`1∕${plain(limit)}`, "1", plain(limit)];
const ratioBar = (limit) => colourBar((t) => diverging(2 * t - 1), ratioLabels(limit), "share over true share");

/// Places that are on no map: those of a door or a mirror, and the only hole of a wall.
function featureTable(group) {
    const rows = group.cells.flatMap((cell) =>
        Object.entries(cell.features ?? {})
            .filter(([name]) => !holeIndex(name) || !cell.grid)
            .map(([name, feature]) => ({ ...feature, name, cell })),
    );
    if (!rows.length) return null;
    const columns = [
        { title: "sampler", value: (f) => f.cell.label, show: (f) => [samplerMark(f.cell), f.cell.label] },
        { title: "feature", value: (f) => f.name },
        {
            title: "share",
            value: (f) => f.share,
            show: (f) => [percent(f.share), el("span", { class: "ci" }, interval(f.share_ci95, percent))],
        },
        { title: "truth", value: (f) => f.truth, show: (f) => percent(f.truth) },
        {
            title: "p",
            value: (f) => f.p_adjusted,
            show: (f) => pValue(f.p_adjusted),
            alarm: (f) => isNumber(f.p_adjusted) && f.p_adjusted <= 0.05,
        },
        { title: "spread over runs", value: (f) => f.relative_sd, show: (f) => percent(f.relative_sd) },
        { title: "jumps to it ∕ 10⁶ mutations", value: (f) => f.jumps_per_million },
    ];
    return sortableTable(`features of ${group.title}`, columns, rows);
}

function occupancySection() {
    const drawn = groups.filter((group) => group.cells.some((cell) => Object.keys(cell.features ?? {}).length));
    if (!drawn.length) return null;
    const mapped = cells.some((cell) => cell.grid);
    return section(
        "holes",
        "Occupancy",
        `A path belongs to the last ${mapped ? "hole" : "place"} it crossed before the camera. ` +
            (mapped ? "Blue: the hole got too little light, orange: too much, hatched: nothing; a dot" : "Red") +
            ": significantly wrong (t test over runs, Holm, p ≤ 0.05). This shows trapping, which a noise-free image hides.",
        drawn.map((group) => {
            const withGrid = group.cells.filter((cell) => cell.grid),
                holes = withGrid.flatMap((cell) => cell.grid.holes);
            const largest = (field) => Math.max(0, ...holes.map((hole) => hole[field]).filter(isNumber));
            const limit = ratioLimit(holes.map((hole) => hole.ratio));
            const scales = {
                limit,
                ratio: ratioColour(limit),
                sd: largest("relative_sd"),
                jumps: largest("jumps_per_million"),
            };
            const rootScale = (top, show) => ["0", show(top / 4), show(top)];
            return el(
                "div",
                { class: "group" },
                el("h3", {}, group.title),
                withGrid.length > 0 &&
                    el(
                        "div",
                        { class: "colour-bars" },
                        ratioBar(limit),
                        scales.sd > 0 &&
                            colourBar(
                                (t) => viridis(t),
                                rootScale(scales.sd, percent),
                                "relative standard deviation over runs",
                            ),
                        scales.jumps > 0 &&
                            colourBar(
                                (t) => viridis(t),
                                rootScale(scales.jumps, number),
                                "jumps to a hole per million mutations",
                            ),
                    ),
                el(
                    "div",
                    { class: "hole-cards" },
                    withGrid.map((cell) => later(() => occupancyCard(cell, scales))),
                ),
                featureTable(group),
            );
        }),
    );
}
