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

/// Buttons that save what `draw(true)` makes.
function saveButtons(name, draw) {
    const button = (kind, save) =>
        el("button", { type: "button", class: "save", "aria-label": `${name}: save as ${kind}`, onclick: save }, kind);
    const svgText = () =>
        `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(paperFigure(draw).root)}\n`;
    return el(
        "div",
        { class: "saves" },
        button("SVG", () => saveFile(`${fileName(name)}.svg`, "image/svg+xml", svgText())),
        button("PDF", () => printAlone(paperFigure(draw))),
    );
}

/// A figure that is drawn the same on the screen and on paper.
const figure = (name, draw) => el("figure", { class: "chart" }, draw(false), saveButtons(name, draw));

/// Pictures side by side for paper, each { label, canvas } or { label, svg }, and below each its `crops`, canvases too.
function pictureStrip(name, parts, { width = 2 * kPlotWidth, scale } = {}) {
    const gap = 8,
        each = (width - gap * (parts.length - 1)) / parts.length;
    const embedded = (canvas, box) => svg("image", { ...box, href: canvas.toDataURL(), preserveAspectRatio: "none" });
    const root = svg("g", {});
    let bottom = 0;
    parts.forEach(({ label, canvas, svg: drawing, aspect, crops = [] }, i) => {
        const x = i * (each + gap),
            height = each / aspect;
        root.append(textAt(x + each / 2, 11, label, { "text-anchor": "middle" }));
        const box = { x, y: 18, width: each, height };
        root.append(canvas ? embedded(canvas, box) : setAttributes(drawing, box));
        const cropWidth = (each - 4 * (crops.length - 1)) / crops.length;
        crops.forEach((crop, k) => {
            const at = { x: x + k * (cropWidth + 4), y: 22 + height, width: cropWidth, height: cropWidth / aspect };
            root.append(
                embedded(crop.canvas, at),
                svg("rect", { ...at, fill: "none", stroke: crop.colour, "stroke-width": 1.5 }),
            );
        });
        bottom = Math.max(bottom, 18 + height + (crops.length ? 4 + cropWidth / aspect : 0));
    });
    if (scale) root.append(colourScale(scale, scale.title, width / 2 - kPlotWidth / 2, bottom + 8, kPlotWidth));
    return plotRoot(width, bottom + (scale ? 34 : 2), name, root);
}
