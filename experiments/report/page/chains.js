// Chain panels: traces, ranks, autocorrelation, and where the chains are on the image, draw after draw.

const kTracedChains = 6;
const kMostRankBins = 20;
const kTrail = 6; // draws that stay visible behind a chain

/// Of autocorrelations: those of longer lags are of few pairs.
const mostLag = (chains) => Math.min(40, Math.floor(chains.draws / 3));

function tracePlot(chains, scalar, name, paper) {
    const shown = Math.min(kTracedChains, chains.chains);
    const series = Array.from({ length: shown }, (_, i) => {
        const index = Math.floor((i * chains.chains) / shown),
            points = [...chains.chain(scalar.id, index)].map((y, x) => ({ x, y }));
        return { label: `chain ${index + 1}`, order: i, colour: samplerColour(i), points, markless: true };
    });
    return linePlot({
        name,
        paper,
        title: "traces",
        series,
        x: { label: "draw", values: [0, chains.draws - 1], whole: true },
        y: { label: scalar.name, values: series.flatMap((s) => s.points.map((p) => p.y)) },
        describe: (s, p) => [el("b", {}, s.label), line(`draw ${p.x + 1}: ${number(p.y)}`)],
    });
}

function autocorrelationPlot(chains, scalar, cell, name, paper) {
    const most = mostLag(chains);
    const all = Array.from({ length: chains.chains }, (_, i) => chains.autocorrelation(scalar.id, i, most));
    const points = Array.from({ length: most + 1 }, (_, lag) => {
        const sorted = all.map((rho) => rho[lag]).sort((a, b) => a - b),
            at = (q) => sorted[Math.round(q * (sorted.length - 1))];
        return { x: lag, y: mean(sorted), ci95: [at(0.1), at(0.9)] };
    });
    const common = chains.commonAutocorrelation(scalar.id, most).map((y, x) => ({ x, y }));
    const turns = chains.mutations / (chains.all * chains.draws);
    const look = { colour: samplerColour(cell.order), order: cell.order, markless: true };
    return linePlot({
        name,
        paper,
        title: "autocorrelation",
        series: [
            { ...look, label: "around a chain’s own mean, 10–90 % of chains", points },
            { ...look, label: "around the mean of all chains", points: common, dashed: true },
        ],
        guides: [
            {
                points: [
                    { x: 0, y: 0 },
                    { x: most, y: 0 },
                ],
                colour: css("--muted"),
                dashed: true,
            },
        ],
        x: {
            label: turns >= 1 ? `lag in draws (a draw: about ${count(turns, plain)} mutations)` : "lag in draws",
            values: [0, most],
            whole: true,
        },
        y: { label: "ρ", values: [0, 1, ...common.map((p) => p.y), ...points.flatMap((p) => p.ci95)] },
        describe: (s, p) =>
            [
                el("b", {}, `lag ${p.x}: ρ = ${number(p.y)}`),
                line(s.label),
                p.ci95 && line(`10–90 % of chains ${interval(p.ci95)}`),
            ].filter(Boolean),
    });
}

/// A row per chain, a column per class of ranks: even where chains agree.
function rankPlot(chains, scalar, name, paper) {
    const bins = clamp(Math.floor(chains.draws / 4), 2, kMostRankBins),
        counts = chains.rankCounts(scalar.id, bins),
        expected = chains.draws / bins,
        limit = 4,
        colour = (n) => diverging(n > 0 ? clamp(Math.log(n / expected) / Math.log(limit), -1, 1) : -1);
    const frame = { left: 40, right: kPlotWidth - 16, top: 22, bottom: kPlotHeight - 38 };
    const rowHeight = (frame.bottom - frame.top) / chains.chains,
        columnWidth = (frame.right - frame.left) / bins;
    const root = plotRoot(kPlotWidth, kPlotHeight + 26, name);
    root.append(
        textAt((frame.left + frame.right) / 2, 13, "ranks", { "text-anchor": "middle", "font-weight": 600 }),
        textAt(11, (frame.top + frame.bottom) / 2, "chain", {
            "text-anchor": "middle",
            fill: css("--muted"),
            transform: `rotate(-90 11 ${(frame.top + frame.bottom) / 2})`,
        }),
        textAt(frame.left - 6, frame.top + 9, "1", { "text-anchor": "end" }),
        textAt(frame.left - 6, frame.bottom, chains.chains, { "text-anchor": "end" }),
        textAt((frame.left + frame.right) / 2, frame.bottom + 31, "rank of a draw among the draws of all chains", {
            "text-anchor": "middle",
            fill: css("--muted"),
        }),
        ...[0, 0.5, 1].map((v) =>
            textAt(frame.left + v * (frame.right - frame.left), frame.bottom + 15, `${100 * v} %`, {
                "text-anchor": "middle",
            }),
        ),
    );
    const place = (row, column) => ({
        x: frame.left + column * columnWidth,
        y: frame.top + row * rowHeight,
        width: columnWidth,
        height: rowHeight,
    });
    const describe = (row, column) => [
        el("b", {}, `chain ${row + 1}`),
        line(`${number(counts[row][column])} draws in this class of ranks; ${number(expected)} if chains agree`),
    ];
    counts.forEach((own, row) =>
        own.forEach((n, column) => {
            const square = svg("rect", {
                ...place(row, column),
                fill: rgbToCss(colour(n)),
                "shape-rendering": "crispEdges",
            });
            if (!paper) withTooltip(square, () => describe(row, column));
            root.append(square);
        }),
    );
    const cursor = svg("rect", {
        fill: "none",
        stroke: css("--link"),
        "stroke-width": 2,
        visibility: "hidden",
        "pointer-events": "none",
    });
    root.append(
        cursor,
        colourScale(
            { map: (t) => diverging(2 * t - 1), labels: ratioLabels(limit) },
            "draws over expected",
            frame.left,
            kPlotHeight + 2,
            frame.right - frame.left,
        ),
    );
    if (!paper)
        readByKeys(root, {
            first: [0, 0],
            step: ([row, column], dx, dy) => [clamp(row + dy, 0, chains.chains - 1), clamp(column + dx, 0, bins - 1)],
            show: ([row, column]) => {
                setAttributes(cursor, { ...place(row, column), visibility: "visible" });
                return [describe(row, column), cursor];
            },
            hide: () => cursor.setAttribute("visibility", "hidden"),
        });
    return root;
}

/// Where the chains are, over the run's picture. Never starts by itself; slower where motion is unwanted.
class ChainFilm {
    constructor(cell, chains) {
        Object.assign(this, { cell, chains, draw: 0, timer: null });
        this.image = picture(pictureIds(cell).median);
        this.canvas = el("canvas", {
            class: "chain-film",
            role: "img",
            "aria-label": `places of ${chains.chains} chains of ${cell.label} on the image`,
        });
        this.play = el("button", { type: "button", class: "play", onclick: () => this.toggle() }, "play");
        this.slider = el("input", {
            type: "range",
            class: "draw",
            min: 0,
            max: chains.draws - 1,
            value: 0,
            "aria-label": "draw",
            oninput: () => this.show(Number(this.slider.value)),
        });
        this.output = el("output");
        this.element = el(
            "figure",
            { class: "film" },
            this.canvas,
            el("div", { class: "controls" }, this.play, this.slider, this.output),
        );
        this.show(0);
    }

    toggle() {
        if (this.timer) return this.stop();
        const pause = matchMedia("(prefers-reduced-motion: reduce)").matches ? 700 : 80;
        this.play.textContent = "pause";
        this.timer = setInterval(() => {
            if (!this.element.isConnected || document.hidden) this.stop();
            else this.show((this.draw + 1) % this.chains.draws);
        }, pause);
    }

    stop() {
        clearInterval(this.timer);
        this.timer = null;
        this.play.textContent = "play";
    }

    show(draw) {
        this.draw = draw;
        this.slider.value = draw;
        this.output.textContent = `draw ${draw + 1} of ${this.chains.draws}`;
        const { image, canvas, chains } = this,
            width = 512,
            height = Math.round((512 * image.height) / image.width);
        if (canvas.width !== width) Object.assign(canvas, { width, height });
        const context = canvas.getContext("2d");
        context.globalAlpha = 1;
        context.imageSmoothingEnabled = image.width > width;
        this.exposure ??= fittingExposure(image);
        context.drawImage(image.shown(this.exposure), 0, 0, width, height);
        context.globalAlpha = 0.55;
        context.fillStyle = "#000";
        context.fillRect(0, 0, width, height);
        for (let back = Math.min(kTrail, draw); back >= 0; --back) {
            context.globalAlpha = (1 - back / (kTrail + 1)) ** 2;
            context.fillStyle = back ? "#5cc3ff" : "#ffb454";
            for (let i = 0; i < chains.chains; ++i) {
                const at = i * chains.draws + draw - back,
                    radius = back ? 2 : 4;
                context.beginPath();
                context.arc(chains.values.raster_x[at] * width, chains.values.raster_y[at] * height, radius, 0, 7);
                context.fill();
            }
        }
    }
}

/// R-hat, effective sample sizes and autocorrelation times of the run as result.json has them.
function mixingTable(cell, chains) {
    const rows = Object.entries(chains.mixing ?? {}).filter(([, found]) => found && typeof found === "object");
    if (!rows.length) return null;
    const time = "integrated_autocorrelation_mutations", bound = "integrated_autocorrelation_bound";
    const readableName = (name) => name.replace(/_/g, " ").replace("rhat", "R-hat").replace("ess", "ESS");
    const columns = [...new Set(rows.flatMap(([, found]) => Object.keys(found)))].filter((column) => column !== bound).map((column) => ({
        title: readableName(column),
        value: ([, found]) => found[column],
        ...(column === time && { show: ([, found]) => ({ upper: "≤ ", lower: "≥ " }[found[bound]] ?? "") + number(found[time]) }),
    }));
    return sortableTable(`mixing of ${cell.label} on ${cell.group.title}`, [
        { title: "scalar", names: true, value: ([scalar]) => readableName(scalar) },
        ...columns,
    ], rows);
}

function chainPanel(cell) {
    const chains = new Chains(pictureIds(cell).chains),
        plots = el("div", { class: "charts" });
    const draw = (scalar) => {
        const kinds = [
            ["traces", (name, paper) => tracePlot(chains, scalar, name, paper)],
            ["ranks", (name, paper) => rankPlot(chains, scalar, name, paper)],
            mostLag(chains) > 1 && [
                "autocorrelation",
                (name, paper) => autocorrelationPlot(chains, scalar, cell, name, paper),
            ],
        ].filter(Boolean);
        plots.replaceChildren(
            ...kinds.map(([kind, make]) => {
                const name = `${kind} of ${scalar.name}, ${cell.group.title}, ${cell.label}`;
                return figure(name, (paper) => make(name, paper));
            }),
            ...[mixingTable(cell, chains)].filter(Boolean),
        );
    };
    const { scalars } = chains;
    const choice = el(
        "select",
        {
            "aria-label": `scalar for ${cell.label} on ${cell.group.title}`,
            class: "scalar",
            onchange: () => draw(scalars[choice.selectedIndex]),
        },
        scalars.map(({ name }) => el("option", {}, name)),
    );
    if (scalars.length) draw(scalars[0]);
    return el(
        "div",
        {},
        el(
            "p",
            { class: "note" },
            `Run ${chains.replicate} (median): ${chains.chains} of ${count(chains.all, plain)} chains, ${chains.draws} draws each.`,
        ),
        el(
            "div",
            { class: "chain-panel" },
            new ChainFilm(cell, chains).element,
            el("div", {}, scalars.length > 0 && el("label", { class: "choice" }, "scalar ", choice), plots),
        ),
    );
}

function chainsSection() {
    const drawn = groups
        .map((group) => ({ group, judged: group.cells.filter((cell) => pictureIds(cell).chains?.draws > 1) }))
        .filter(({ judged }) => judged.length);
    if (!drawn.length) return null;
    return section(
        "chains",
        "Chains",
        "Even ranks in every row: the chains agree. Uneven rows, traces that stay apart, and ρ around the mean of all chains (dashed) that stays up while ρ around a chain’s own mean falls: they are caught where they began.",
        drawn.map(({ group, judged }) => {
            const panel = el(
                "div",
                {},
                later(() => chainPanel(judged[0])),
            );
            const choice = el(
                "select",
                {
                    "aria-label": `chains shown for ${group.title}`,
                    onchange: () => panel.replaceChildren(chainPanel(judged[choice.selectedIndex])),
                },
                judged.map((cell) => el("option", {}, cell.label)),
            );
            return el("div", { class: "group" }, el("h3", {}, group.title, " ", choice), panel);
        }),
    );
}
