// Bidirectional techniques as a pyramid (Veach 1997, figure 10.3): a row for each path length, s vertices from the light
// growing from left to right, each with its picture, weighted or as the technique alone would make it.

const meanLuminance = (image) => {
    let total = 0;
    for (let i = 0; i < image.rgb.length; i += 3)
        total += 0.212671 * image.rgb[i] + 0.71516 * image.rgb[i + 1] + 0.072169 * image.rgb[i + 2];
    return (3 * total) / image.rgb.length;
};

/// The cell's techniques by path length, shortest first, with the share of the picture's light that each carries.
function pyramidRows(cell) {
    const all = pictureIds(cell).techniques.map((entry) => ({
        ...entry,
        light: meanLuminance(picture(entry.weighted)),
    }));
    const light = sum(all.map((entry) => entry.light));
    for (const entry of all) entry.share = light > 0 ? entry.light / light : NaN;
    const lengths = [...new Set(all.map(({ s, t }) => s + t))].sort((a, b) => a - b);
    return lengths.map((vertices) => ({
        edges: vertices - 1,
        entries: all.filter(({ s, t }) => s + t === vertices).sort((a, b) => a.s - b.s),
    }));
}

class Pyramid {
    constructor(cell) {
        this.cell = cell;
        this.rows = pyramidRows(cell);
        this.state = { kind: "weighted", fit: true, exposure: 0 };
        this.most = Math.max(...this.rows.map((row) => row.entries.length));
        this.element = this.build();
        this.draw();
    }

    /// The row's pictures share an exposure: the one that suits the brightest, or the same in all rows.
    exposureOf(row) {
        const rows = this.state.fit ? [row] : this.rows;
        const fitting = rows.flatMap(({ entries }) =>
            entries.map((entry) => fittingExposure(picture(entry[this.state.kind]))).filter((stops) => stops !== 0),
        );
        return (fitting.length ? Math.min(...fitting) : 0) + this.state.exposure;
    }

    build() {
        const set = (change) => {
            Object.assign(this.state, change);
            this.draw();
        };
        const kinds = ["weighted", "unweighted"].map((kind) =>
            el(
                "label",
                {},
                el("input", {
                    type: "radio",
                    name: `pyramid-${this.cell.cell}`,
                    class: `pyramid-${kind}`,
                    checked: kind === this.state.kind,
                    onchange: () => set({ kind }),
                }),
                ` ${kind}`,
            ),
        );
        const fit = el("input", {
            type: "checkbox",
            class: "pyramid-fit",
            checked: true,
            onchange: () => set({ fit: fit.checked }),
        });
        const exposure = el("input", {
            type: "range",
            min: -6,
            max: 6,
            step: 0.5,
            value: 0,
            "aria-label": "exposure of the techniques in stops",
            oninput: () => set({ exposure: Number(exposure.value) }),
        });
        this.canvases = new Map();
        const name = `techniques, ${this.cell.group.title}, ${this.cell.label}`;
        const figures = (row) =>
            row.entries.map((entry) => {
                const canvas = el("canvas", { role: "img", "aria-label": this.describe(entry) });
                this.canvases.set(entry, canvas);
                return el(
                    "figure",
                    {},
                    canvas,
                    el("figcaption", {}, `${entry.s}, ${entry.t} · `, el("b", {}, percent(entry.share))),
                );
            });
        return el(
            "div",
            { class: "pyramid" },
            el(
                "div",
                { class: "controls" },
                el("div", { class: "shows", role: "radiogroup", "aria-label": "weights" }, kinds),
                el("label", {}, fit, " expose each length for itself"),
                el("label", {}, "exposure ", exposure),
            ),
            this.rows.map((row) =>
                el(
                    "div",
                    { class: "pyramid-row", style: `--columns: ${this.most}` },
                    el("span", { class: "ci" }, `length ${row.edges}`),
                    el("div", {}, figures(row)),
                ),
            ),
            saveButtons(name, () => this.paper(name)),
        );
    }

    describe(entry) {
        return `${entry.s} vertices from the light, ${entry.t} from the camera: ${percent(entry.share)} of the light`;
    }

    /// A picture's canvas is shared and shows one exposure at a time.
    paint(canvas, entry, exposure) {
        const image = picture(entry[this.state.kind]);
        Object.assign(canvas, { width: image.width, height: image.height });
        canvas.getContext("2d").drawImage(image.shown(exposure), 0, 0);
        return canvas;
    }

    draw() {
        for (const row of this.rows) {
            const exposure = this.exposureOf(row);
            for (const entry of row.entries) this.paint(this.canvases.get(entry), entry, exposure);
        }
    }

    paper(name) {
        const width = 2 * kPlotWidth,
            each = (width - 60) / this.most - 6,
            first = picture(this.rows[0].entries[0].weighted),
            height = (each * first.height) / first.width;
        const root = plotRoot(width, this.rows.length * (height + 22), name);
        this.rows.forEach((row, i) => {
            const y = i * (height + 22),
                left = 60 + (width - 60 - row.entries.length * (each + 6)) / 2;
            root.append(textAt(0, y + height / 2, `length ${row.edges}`));
            row.entries.forEach((entry, k) => {
                const x = left + k * (each + 6),
                    canvas = this.paint(document.createElement("canvas"), entry, this.exposureOf(row));
                root.append(
                    svg("image", { x, y, width: each, height, href: canvas.toDataURL(), preserveAspectRatio: "none" }),
                    textAt(x + each / 2, y + height + 13, `${entry.s}, ${entry.t}`, { "text-anchor": "middle" }),
                );
            });
        });
        return root;
    }
}

function techniquesSection() {
    const withTechniques = cells.filter((cell) => pictureIds(cell).techniques?.length);
    if (!withTechniques.length) return null;
    return section(
        "techniques",
        "Techniques",
        "Median run. A path of s vertices from the light and t from the camera (s, t) · share of the picture’s light. Weighted pictures add up to the whole; unweighted, each is what the technique alone would make, noise included.",
        withTechniques.map((cell) =>
            el(
                "div",
                { class: "group" },
                el("h3", {}, `${cell.group.title}: ${cell.label}`),
                later(() => new Pyramid(cell).element),
            ),
        ),
    );
}
