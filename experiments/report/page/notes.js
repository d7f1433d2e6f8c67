// What can make the figures wrong, and where they come from.

/// Every warning of the run as [where, text]; the same text from several cells is said once.
function allWarnings() {
    const found = new Map();
    const add = (text, where) => {
        const said = typeof text === "string" ? text : JSON.stringify(text);
        found.set(said, [...(found.get(said) ?? []), where].filter(Boolean));
    };
    // The run repeats its cells' warnings with their names in front.
    const ofCells = new Set(cells.flatMap((cell) => (cell.warnings ?? []).map((text) => `${cell.cell}: ${text}`)));
    for (const text of summary.warnings ?? []) if (!ofCells.has(text)) add(text, null);
    for (const cell of cells) {
        for (const text of cell.warnings ?? []) add(text, cell.cell);
        if (cell.reference_too_poor)
            add("Reference too poor: its variance exceeds 10 % of the smallest error reported.", cell.cell);
        const nonFinite = cell.result.non_finite;
        const bad = typeof nonFinite === "number" ? nonFinite : sum(Object.values(nonFinite ?? {}).filter(isNumber));
        if (bad > 0) add(`Non-finite values were rejected (run ${resultRun(cell)}: ${count(bad)}).`, cell.cell);
    }
    return [...found];
}

/// The run whose result file the page has: the first finished one.
const resultRun = (cell) => cell.result.replicate ?? 0;

const biasLedgers = () =>
    cells.map((cell) => [cell, cell.result.bias_ledger ?? []]).filter(([, ledger]) => ledger.length);

const warningItem = ([text, where]) =>
    el("li", {}, text, where.length > 0 && el("span", { class: "where" }, ` ${where.join(", ")}`));
const kShownWarnings = 6; // the rest of a long list is folded

function alarmBox() {
    const warnings = allWarnings(),
        biased = biasLedgers();
    if (!warnings.length && !biased.length) return null;
    return el(
        "div",
        { class: "alarm", role: "alert", id: "warnings" },
        el(
            "ul",
            {},
            warnings.slice(0, kShownWarnings).map(warningItem),
            biased.length > 0 &&
                el(
                    "li",
                    {},
                    `${biased.map(([cell]) => cell.cell).join(", ")}: a setting that biases the image is on, see the `,
                    el("a", { href: "#ledger" }, "bias ledger"),
                    ".",
                ),
        ),
        warnings.length > kShownWarnings &&
            el(
                "details",
                {},
                el("summary", {}, `${warnings.length - kShownWarnings} more`),
                el("ul", {}, warnings.slice(kShownWarnings).map(warningItem)),
            ),
    );
}

function ledgerSection() {
    const biased = biasLedgers();
    const text = (entry) =>
        typeof entry === "string"
            ? entry
            : Object.entries(entry)
                  .map(([k, v]) => `${k}: ${typeof v === "object" ? JSON.stringify(v) : v}`)
                  .join(", ");
    const known = cells.some((cell) => Array.isArray(cell.result.bias_ledger));
    const lead = biased.length
        ? null
        : known
          ? "Empty: no clamping, no forced acceptance, no dropped outliers, no restarts in any cell."
          : "Not recorded: no cell left a result file with a ledger.";
    return section(
        "ledger",
        "Bias ledger",
        lead,
        biased.length > 0 &&
            el(
                "div",
                { class: "alarm" },
                el(
                    "ul",
                    {},
                    biased.map(([cell, ledger]) =>
                        el("li", {}, el("b", {}, cell.cell), ": ", ledger.map(text).join("; ")),
                    ),
                ),
            ),
    );
}

/// Nested objects become dotted names.
function flatten(value, prefix = "") {
    if (value === null || typeof value !== "object") return [[prefix, value]];
    const entries = Object.entries(value);
    if (!entries.length) return [];
    if (Array.isArray(value) && value.every((v) => v === null || typeof v !== "object"))
        return [[prefix, value.join(", ")]];
    return entries.flatMap(([k, v]) => flatten(v, prefix ? `${prefix}.${k}` : k));
}

function provenanceSection() {
    const images = cells
        .filter((cell) => cell.result.image_sha256)
        .map((cell) => [`sha256 of ${cell.cell}/r${String(resultRun(cell)).padStart(3, "0")}`, cell.result.image_sha256]);
    const rows = [...flatten(data.provenance ?? {}), ...images];
    const columns = [
        { title: "name", names: true, value: ([name]) => name },
        { title: "value", value: ([, value]) => String(value) },
    ];
    const file = (title, json) =>
        json && el("details", {}, el("summary", {}, title), el("pre", {}, JSON.stringify(json, null, 2)));
    return section(
        "provenance",
        "Provenance",
        null,
        rows.length > 0 && sortableTable("provenance", columns, rows, { id: "provenance-table" }),
        file("experiment.json, as written", data.experiment),
        file("resolved.json: every default, every seed", data.resolved),
    );
}
