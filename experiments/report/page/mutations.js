// Acceptance and reasons of rejection: one bar per mutation, with the figures beside it.

const kByRatio = "by the ratio"; // a finished proposal that lost the Metropolis–Hastings draw
const readable = (name) =>
    name
        .replace(/([a-z])([A-Z])/g, "$1 $2")
        .replace(/_/g, " ")
        .toLowerCase();

/// Shares of the proposals: accepted, every reason, and what is left: lost by the ratio.
function outcomeShares(statistics) {
    const proposed = statistics.proposed || 0;
    if (!proposed) return [];
    const reasons = Object.entries(statistics.rejected ?? {}).map(([reason, n]) => [readable(reason), n / proposed]);
    const accepted = (statistics.accepted ?? 0) / proposed;
    const rest = 1 - accepted - sum(reasons.map(([, share]) => share));
    const shares = [["accepted", accepted], ...reasons];
    if (rest > 1e-9) shares.push([kByRatio, rest]);
    return shares.filter(([, share]) => share > 0);
}

const reasonColours = () =>
    isDark()
        ? ["#56b4e9", "#ff8a3d", "#e08fc0", "#e69f00", "#f0e442", "#9fd4f5", "#c98a6a"]
        : ["#0072b2", "#d55e00", "#cc79a7", "#e69f00", "#c9b800", "#56b4e9", "#8a5a3c"];

function outcomeColour(outcome, reasons) {
    if (outcome === "accepted") return isDark() ? "#2bc59a" : "#009e73";
    if (outcome === kByRatio) return css("--neutral-bar");
    const colours = reasonColours();
    return colours[reasons.indexOf(outcome) % colours.length];
}

function outcomeBar(shares, reasons) {
    const bar = el("div", {
        class: "outcome-bar",
        role: "img",
        "aria-label": shares.map(([name, share]) => `${name} ${percent(share)}`).join(", ") || "no proposals",
    });
    for (const [name, share] of shares)
        bar.append(
            withTooltip(
                el("span", { style: `flex-grow: ${share}; background: ${outcomeColour(name, reasons)}` }),
                () => `${name} ${percent(share)}`,
            ),
        );
    return bar;
}

/// The bars of all mutations for paper, with a legend.
function outcomeFigure(name, rows, outcomes, reasons) {
    const colour = (outcome) => outcomeColour(outcome, reasons),
        labels = rows.map(({ cell, name: mutation }) => `${cell.group.title}, ${cell.label}: ${mutation}`);
    const left = Math.max(...labels.map((text) => textWidth(text))) + 8,
        width = 2 * kPlotWidth,
        bar = width - left,
        root = svg("g", {});
    let x = 0,
        y = 10;
    for (const outcome of outcomes) {
        const needed = 16 + textWidth(outcome) + 14;
        if (x + needed > width) [x, y] = [0, y + 16];
        root.append(
            svg("rect", { x, y: y - 9, width: 10, height: 10, fill: colour(outcome) }),
            textAt(x + 14, y, outcome),
        );
        x += needed;
    }
    rows.forEach(({ shares }, i) => {
        const top = y + 10 + 17 * i;
        root.append(textAt(0, top + 10, labels[i]));
        let at = left;
        for (const [outcome, share] of shares) {
            root.append(svg("rect", { x: at, y: top, width: share * bar, height: 12, fill: colour(outcome) }));
            at += share * bar;
        }
    });
    return plotRoot(width, y + 14 + 17 * rows.length, name, root);
}

function mutationsSection() {
    const judged = cells.filter((cell) => Object.keys(cell.mutation_statistics ?? {}).length);
    if (!judged.length) return null;
    const rows = judged.flatMap((cell) =>
        Object.entries(cell.mutation_statistics).map(([name, statistics]) => {
            const shares = outcomeShares(statistics);
            return { cell, name, statistics, shares, share: Object.fromEntries(shares) };
        }),
    );
    const outcomes = [...new Set(rows.flatMap((row) => row.shares.map(([name]) => name)))];
    const reasons = outcomes.filter((name) => name !== "accepted" && name !== kByRatio);
    const shown = ["accepted", ...reasons, ...(outcomes.includes(kByRatio) ? [kByRatio] : [])];
    const perProposal = ({ statistics }, field) =>
        statistics[field] && statistics.proposed ? statistics[field] / statistics.proposed : null;
    const columns = [
        groups.length > 1 && { title: "scene", value: ({ cell }) => cell.group.title },
        { title: "sampler", value: ({ cell }) => cell.label, show: ({ cell }) => [samplerMark(cell), cell.label] },
        { title: "mutation", value: ({ name }) => name },
        { title: "", kind: "bar", show: ({ shares }) => outcomeBar(shares, reasons) },
        {
            title: "proposed",
            value: ({ statistics }) => statistics.proposed,
            show: ({ statistics }) => count(statistics.proposed),
        },
        ...shown.map((outcome) => ({
            title: outcome,
            kind: "outcome",
            style: `--outcome: ${outcomeColour(outcome, reasons)}`,
            value: ({ share }) => share[outcome],
            show: ({ share }) => percent(share[outcome]),
        })),
        rows.some(({ statistics }) => statistics.zero > 0) && {
            title: "zero",
            meaning: "proposals whose contribution is zero, for whatever reason",
            value: (row) => perProposal(row, "zero"),
            show: (row) => percent(perProposal(row, "zero")),
        },
        {
            title: "µs",
            meaning: "time of one proposal",
            value: (row) => perProposal(row, "seconds"),
            show: (row) => number(1e6 * (perProposal(row, "seconds") ?? NaN)),
        },
        {
            title: "jump²",
            meaning: "expected squared jump on the image, in square pixels",
            value: ({ statistics }) => statistics.esjd_pixels,
        },
    ].filter(Boolean);
    const name = "what became of the proposals";
    return section(
        "mutations",
        "Mutations",
        "What became of the proposals, summed over runs.",
        sortableTable("mutations", columns, rows, { id: "mutation-table" }),
        saveButtons(name, () => outcomeFigure(name, rows, shown, reasons)),
    );
}
