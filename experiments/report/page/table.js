// Tables, all of one make: a heading sorts the rows by its column, pressed again the other way round.

const isMissing = (value) => value === null || value === undefined || Number.isNaN(value);

/// Numbers by size, texts as people would; what is missing comes last either way.
function compareValues(a, b, descending) {
    if (isMissing(a) || isMissing(b)) return isMissing(a) - isMissing(b);
    const order = typeof a === "number" ? a - b : String(a).localeCompare(String(b), undefined, { numeric: true });
    return descending ? -order : order;
}

function sortRows(table, index) {
    const header = table.tHead.rows[0].cells[index],
        body = table.tBodies[0],
        descending = header.getAttribute("aria-sort") === "ascending";
    for (const th of table.querySelectorAll("th[aria-sort]")) th.removeAttribute("aria-sort");
    header.setAttribute("aria-sort", descending ? "descending" : "ascending");
    const value = (row) => row.cells[index].sortValue;
    body.append(...[...body.rows].sort((a, b) => compareValues(value(a), value(b), descending)));
}

/// A table whose name no other on the page has. Of a column: { title, meaning: of the heading, in words; value(row): to sort
/// by; show(row): what is displayed where that is not the value; kind: a class, style: of the heading; names: whether its
/// cells name their rows; alarm(row): is it bad?; hover(row) }. A column without values cannot be sorted by.
function sortableTable(name, columns, rows, { id, rowClass = () => null } = {}) {
    const table = el("table", { id, "aria-label": name });
    const isText = (column) => rows.some((row) => typeof column.value?.(row) === "string");
    const classes = (...found) => found.filter(Boolean).join(" ") || null;
    const head = (column, index) =>
        el(
            "th",
            { scope: "col", class: classes(column.kind, isText(column) && "text"), style: column.style, title: column.value ? null : column.meaning },
            column.value
                ? el("button", { type: "button", title: column.meaning, onclick: () => sortRows(table, index) }, column.title)
                : column.title,
        );
    const cell = (column, row) => {
        const value = column.value?.(row),
            shown = column.show ? column.show(row) : typeof value === "string" ? value : number(value);
        const node = el(
            column.names ? "th" : "td",
            {
                scope: column.names && "row",
                class: classes(column.kind, isText(column) && "text", column.alarm?.(row) && "alarming"),
                title: column.hover?.(row),
            },
            shown,
        );
        node.sortValue = value;
        return node;
    };
    table.append(
        el("thead", {}, el("tr", {}, columns.map(head))),
        el("tbody", {}, rows.map((row) => el("tr", { class: rowClass(row) }, columns.map((column) => cell(column, row))))),
    );
    return el("div", { class: "scroll" }, table);
}
