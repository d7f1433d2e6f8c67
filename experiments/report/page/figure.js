// Figures for papers: each is drawn again, in light colours and with its legend, and saved as SVG or printed alone on a
// page of its own size, which every browser can save as PDF.

const kPaperUnit = 90 / kPlotWidth; // millimetres; a plot is as wide as a column of text

/// What `draw(true)` returns under the light colours, whatever the page has.
function onPaper(draw) {
    const root = document.documentElement;
    root.classList.add("paper");
    try {
        return draw(true);
    } finally {
        root.classList.remove("paper");
    }
}

function paperFigure(draw) {
    const root = onPaper(draw);
    const [width, height] = root
        .getAttribute("viewBox")
        .split(" ")
        .slice(2)
        .map((units) => (units * kPaperUnit).toFixed(2));
    setAttributes(root, { width: `${width}mm`, height: `${height}mm` });
    return { root, width, height };
}

function saveFile(name, type, text) {
    const url = URL.createObjectURL(new Blob([text], { type }));
    el("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

function printAlone({ root, width, height }) {
    const page = el("div", { id: "paper" }, root),
        size = el("style", {}, `@page { size: ${width}mm ${height}mm; margin: 0 }`);
    document.body.append(page, size);
    document.documentElement.classList.add("printing");
    addEventListener(
        "afterprint",
        () => {
            document.documentElement.classList.remove("printing");
            page.remove();
            size.remove();
        },
        { once: true },
    );
    print();
}

const fileName = (name) =>
    `${summary.name ?? "run"} ${name}`
        .toLowerCase()
        .replace(/[^\p{L}\p{N}.=-]+/gu, "-")
        .replace(/^-|-$/g, "");

/// A figure as `draw(paper)` makes it, with buttons that save it.
function figure(name, draw, attributes = { class: "chart" }) {
    const svgText = () => `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(paperFigure(draw).root)}\n`;
    const button = (kind, save) =>
        el("button", { type: "button", class: "save", "aria-label": `${name}: save as ${kind}`, onclick: save }, kind);
    return el(
        "figure",
        attributes,
        draw(false),
        el(
            "div",
            { class: "saves" },
            button("SVG", () => saveFile(`${fileName(name)}.svg`, "image/svg+xml", svgText())),
            button("PDF", () => printAlone(paperFigure(draw))),
        ),
    );
}
