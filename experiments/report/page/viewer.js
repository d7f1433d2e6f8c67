// The linked viewer: a stage that flips in place or is split between two pictures, tiles side by side, two movable crops
// under each; one view for all.

class Viewer {
    constructor(group) {
        this.group = group;
        this.state = {
            zoom: 1,
            u: 0.5,
            v: 0.5,
            exposure: 0,
            show: "tones",
            worst: false,
            shown: 0,
            split: null,
            left: 0,
            insets: [],
        };
        this.reference = comparableReference(group);
        this.entries = viewerEntries(group, this.reference);
        chooseReplicates(this.entries, "median");
        const first = this.entries[0].picture;
        this.fitted = this.state.exposure = fittingExposure(this.reference ?? first);
        this.aspect = first.width / first.height;
        const judged = this.entries.filter((entry) => entry.kind === "replicate").at(-1);
        this.state.insets = defaultCrops(judged?.picture, this.reference);
        this.shows = kShows.filter(({ id, map }) =>
            map ? group.cells.some((cell) => map(pictureIds(cell))) : id !== "error" || this.reference,
        );
        this.element = this.build();
        this.resize = new ResizeObserver(() => this.draw());
        this.resize.observe(this.element);
    }

    static has(group) {
        return group.cells.some((cell) => pictureIds(cell).mean !== undefined);
    }

    build() {
        this.controls = new ViewerControls(this);
        this.stage = this.linkedCanvas("stage", (x) => this.entryAt(x));
        this.stage.tabIndex = 0;
        this.stage.setAttribute("role", "img");
        this.stageTitle = el("p", { class: "stage-title", "aria-live": "polite" });
        this.readout = el("p", { class: "readout" }, "\u00a0");
        this.handles = this.state.insets.map((_, i) => this.insetHandle(i));
        this.divider = this.splitDivider();
        this.tiles = this.entries.map((entry, i) => this.tile(entry, i));
        const columns = this.entries.filter((entry) => entry.kind !== "mean").length;
        this.legend = el("div", { class: "tile error-legend" });
        const stripName = `pictures, ${this.group.title}`;
        const first = this.entries.findIndex((entry) => entry.kind === "mean");
        const tiles = [...this.tiles.slice(0, first), this.legend, ...this.tiles.slice(first)];
        return el(
            "div",
            { class: "viewer", id: `viewer-${this.group.id}` },
            el(
                "div",
                { class: "stage-side" },
                this.stageTitle,
                el(
                    "div",
                    { class: "stage-box", style: `aspect-ratio: ${this.aspect}` },
                    this.stage,
                    this.handles,
                    this.divider,
                ),
                this.readout,
                this.controls.element,
                saveButtons(stripName, () => this.strip(stripName)),
            ),
            el(
                "div",
                { class: "tiles", style: `grid-template-columns: repeat(${columns}, minmax(110px, 1fr))` },
                tiles,
            ),
        );
    }

    tile(entry, index) {
        const key = index < 9 ? String(index + 1) : null;
        const label = el(
            "button",
            { type: "button", class: "tile-label", onclick: () => this.set({ shown: index }) },
            key && el("kbd", {}, key),
            " ",
            entry.cell && samplerMark(entry.cell),
            el("b", {}, entry.title),
            el("span", { class: "ci tile-note" }),
        );
        const canvas = this.linkedCanvas("tile-image", () => entry);
        canvas.style.aspectRatio = this.aspect;
        canvas.setAttribute("aria-hidden", "true");
        canvas.addEventListener("click", () => {
            if (!this.dragged) this.set({ shown: index });
        });
        const crops = this.state.insets.map((_, i) =>
            el("canvas", { class: `crop crop-${i}`, style: `aspect-ratio: ${this.aspect}`, "aria-hidden": true }),
        );
        return Object.assign(el("div", { class: "tile" }, label, canvas, el("div", { class: "crops" }, crops)), {
            entry,
            label,
            canvas,
            crops,
        });
    }

    insetHandle(index) {
        const move = (du, dv) => {
            const inset = this.state.insets[index];
            inset.u = clamp(inset.u + du, inset.size / 2, 1 - inset.size / 2);
            inset.v = clamp(inset.v + dv, inset.size / 2, 1 - inset.size / 2);
            this.draw();
        };
        const handle = el("button", {
            type: "button",
            class: `inset-frame inset-${index}`,
            "aria-label": `crop ${index + 1}: move with the arrow keys`,
        });
        withArrows(handle, (dx, dy) => move(dx / 64, dy / 64));
        withDrag(handle, (dx, dy) => {
            const size = this.imageSize(this.stage.clientWidth, this.stage.clientHeight);
            move(dx / size.width, dy / size.height);
        });
        return handle;
    }

    /// Between the picture on the left and the one shown.
    splitDivider() {
        const move = (by) => this.set({ split: this.state.split + by });
        const divider = el("div", {
            class: "split-divider",
            role: "slider",
            tabindex: 0,
            "aria-label": "divider between two pictures",
            "aria-valuemin": 0,
            "aria-valuemax": 100,
        });
        withArrows(divider, (dx) => move(dx / 50));
        withDrag(divider, (dx) => move(dx / this.stage.clientWidth));
        return divider;
    }

    /// What the stage displays `x` pixels from its left edge.
    entryAt(x) {
        const { split, left, shown } = this.state;
        return this.entries[split !== null && x < split * this.stage.clientWidth ? left : shown];
    }

    /// A canvas whose drags and wheel move the common view; `entryAt(x)` is what it displays there.
    linkedCanvas(name, entryAt) {
        const canvas = el("canvas", { class: name });
        canvas.addEventListener("pointerdown", () => (this.dragged = false));
        withDrag(canvas, (dx, dy) => {
            if (dx || dy) this.dragged = true;
            const size = this.imageSize(canvas.clientWidth, canvas.clientHeight);
            this.set({ u: this.state.u - dx / size.width, v: this.state.v - dy / size.height });
        });
        canvas.addEventListener(
            "wheel",
            (e) => {
                if (document.activeElement !== canvas && !e.ctrlKey && !e.metaKey) return;
                e.preventDefault();
                this.zoomBy(Math.exp(-e.deltaY * 0.002), this.toImage(canvas, e));
            },
            { passive: false },
        );
        canvas.addEventListener("pointermove", (e) => this.describePixel(entryAt(e.offsetX), this.toImage(canvas, e)));
        return canvas;
    }

    imageSize(width, height) {
        const scale = this.state.zoom * Math.min(width, height * this.aspect);
        return { width: scale, height: scale / this.aspect };
    }

    toImage(canvas, event) {
        const size = this.imageSize(canvas.clientWidth, canvas.clientHeight);
        return [
            this.state.u + (event.offsetX - canvas.clientWidth / 2) / size.width,
            this.state.v + (event.offsetY - canvas.clientHeight / 2) / size.height,
        ];
    }

    zoomBy(factor, [u, v] = [this.state.u, this.state.v]) {
        const zoom = clamp(this.state.zoom * factor, 1, 64),
            kept = this.state.zoom / zoom;
        this.set({ zoom, u: u + (this.state.u - u) * kept, v: v + (this.state.v - v) * kept });
    }

    reset() {
        this.set({ zoom: 1, u: 0.5, v: 0.5, exposure: this.fitted, show: "tones", split: null });
    }

    set(change) {
        Object.assign(this.state, change);
        const half = 0.5 / this.state.zoom;
        this.state.u = clamp(this.state.u, half, 1 - half);
        this.state.v = clamp(this.state.v, half, 1 - half);
        this.state.exposure = clamp(this.state.exposure, -12, 12);
        if (this.state.split !== null) this.state.split = clamp(this.state.split, 0, 1);
        if ("worst" in change) chooseReplicates(this.entries, change.worst ? "worst" : "median");
        this.draw();
    }

    /// Keys that work anywhere on the page while this scene's viewer is the active one.
    key(e) {
        const { state } = this;
        const pan = kArrows[e.key];
        if (pan && document.activeElement === this.stage)
            this.set({ u: state.u + (pan[0] * 0.1) / state.zoom, v: state.v + (pan[1] * 0.1) / state.zoom });
        else if (/^[1-9]$/.test(e.key) && Number(e.key) <= this.entries.length) this.set({ shown: Number(e.key) - 1 });
        else if (this.shows.some(({ key }) => key === e.key))
            this.toggleShow(this.shows.find(({ key }) => key === e.key).id);
        else if (e.key === "s") this.set({ split: state.split === null ? 0.5 : null });
        else if (e.key === "w") this.set({ worst: !state.worst });
        else if (e.key === "0") this.reset();
        else if (e.key === "+" || e.key === "=") this.zoomBy(1.5);
        else if (e.key === "-") this.zoomBy(1 / 1.5);
        else if (e.key === "[" || e.key === "]") this.set({ exposure: state.exposure + (e.key === "]" ? 0.5 : -0.5) });
        else return false;
        return true;
    }

    toggleShow(id) {
        this.set({ show: this.state.show === id ? "tones" : id });
    }

    describePixel(entry, [u, v]) {
        const image = entry.picture;
        const x = Math.floor(u * image.width),
            y = Math.floor(v * image.height);
        if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
        const i = y * image.width + x,
            rgb = (p) => [0, 1, 2].map((c) => number(p.rgb[3 * i + c])).join(", ");
        const against =
            this.reference && entry.kind !== "reference"
                ? ` · reference ${rgb(this.reference)} · relative error ${percent(image.relativeError(i, this.reference))}`
                : "";
        const overRuns = entry.cell ? placeNote(entry.cell, u, v) : "";
        const place = kShrink > 1 ? `${squares(kShrink)} from ${kShrink * x}, ${kShrink * y}` : `pixel ${x}, ${y}`;
        this.readout.textContent = `${entryCaption(entry)} · ${place}: ${rgb(image)}${against}${overRuns}`;
    }

    /// What stands for an entry now, and how much wider and higher it is than the picture.
    source(entry) {
        const image = entry.picture,
            { show, exposure } = this.state;
        if (entry.kind === "reference") return { canvas: image.shown(exposure) };
        if (show === "error") return { canvas: image.shown(exposure, this.reference) };
        const map = showOf(show).map?.(pictureIds(entry.cell));
        return map ? { canvas: map.shown(), span: map.span, isMap: true } : { canvas: image.shown(exposure) };
    }

    paint(canvas, view, entry) {
        const context = fitCanvas(canvas);
        context.fillStyle = "#000";
        context.fillRect(0, 0, canvas.width, canvas.height);
        this.paintEntry(context, view, entry);
        return context;
    }

    paintEntry(context, view, entry) {
        const { canvas } = context,
            { canvas: image, span = [1, 1], isMap } = this.source(entry);
        const width = view.zoom * Math.min(canvas.width, canvas.height * this.aspect),
            height = width / this.aspect;
        context.imageSmoothingEnabled = !isMap && width < image.width;
        context.imageSmoothingQuality = "high";
        const [x, y] = [canvas.width / 2 - view.u * width, canvas.height / 2 - view.v * height];
        context.save();
        context.beginPath();
        context.rect(x, y, width, height);
        context.clip();
        context.drawImage(image, x, y, width * span[0], height * span[1]);
        context.restore();
    }

    paintStage() {
        const { state, stage } = this;
        const context = this.paint(stage, state, this.entries[state.shown]);
        this.divider.hidden = state.split === null;
        if (state.split === null) return;
        context.save();
        context.beginPath();
        context.rect(0, 0, state.split * stage.width, stage.height);
        context.clip();
        context.fillRect(0, 0, stage.width, stage.height);
        this.paintEntry(context, state, this.entries[state.left]);
        context.restore();
        this.divider.style.left = `${100 * state.split}%`;
        setAttributes(this.divider, { "aria-valuenow": Math.round(100 * state.split) });
    }

    /// The pictures as they are shown now, their crops and the scale of what they show, for paper.
    strip(name) {
        const size = { width: 480, height: Math.round(480 / this.aspect) };
        const painted = (view, entry) => {
            const canvas = Object.assign(document.createElement("canvas"), size);
            this.paintEntry(canvas.getContext("2d"), view, entry);
            return canvas;
        };
        const parts = this.entries
            .filter((entry) => entry.kind !== "mean")
            .map((entry) => ({
                label: entry.title,
                aspect: this.aspect,
                canvas: painted(this.state, entry),
                crops: this.state.insets.map((inset, k) => ({
                    canvas: painted({ zoom: 1 / inset.size, ...inset }, entry),
                    colour: kInsetColours[k],
                })),
            }));
        return pictureStrip(name, parts, { scale: scaleOf(showOf(this.state.show), this.group) });
    }

    draw() {
        const { state } = this;
        this.controls.update(state);
        const explained = showOf(state.show).scale || !this.reference ? showOf(state.show) : showOf("error");
        this.legend.replaceChildren(...showLegend(explained, this.group));
        if (!this.stage.clientWidth) return;
        const shown = this.entries[state.shown];
        this.paintStage();
        const left = state.split === null ? "" : `; left: ${entryCaption(this.entries[state.left])}`;
        const caption = `${entryCaption(shown)}${left}`;
        this.stageTitle.replaceChildren(el("kbd", {}, state.shown + 1), ` ${caption}`);
        this.stage.setAttribute("aria-label", caption);
        this.tiles.forEach((tile, i) => {
            this.paint(tile.canvas, state, tile.entry);
            tile.crops.forEach((crop, k) =>
                this.paint(crop, { zoom: 1 / state.insets[k].size, ...state.insets[k] }, tile.entry),
            );
            const found = tile.entry.kind === "mean" && showOf(state.show).note?.(tile.entry.cell);
            tile.label.querySelector(".tile-note").textContent = found || (tile.entry.note ?? "");
            tile.label.setAttribute("aria-pressed", i === state.shown);
        });
        const size = this.imageSize(this.stage.clientWidth, this.stage.clientHeight);
        this.handles.forEach((handle, k) => {
            const inset = state.insets[k];
            Object.assign(handle.style, {
                width: `${inset.size * size.width}px`,
                height: `${inset.size * size.height}px`,
                left: `${this.stage.clientWidth / 2 + (inset.u - inset.size / 2 - state.u) * size.width}px`,
                top: `${this.stage.clientHeight / 2 + (inset.v - inset.size / 2 - state.v) * size.height}px`,
            });
        });
    }
}

const viewers = [];
const kInsetColours = ["#ff9d2e", "#5cc3ff"];

/// The viewer that has the focus takes the keys, or else the one nearest the middle of the window.
function activeViewer() {
    const focused = viewers.find((viewer) => viewer.element.contains(document.activeElement));
    if (focused) return focused;
    const distance = (viewer) => {
        const box = viewer.element.getBoundingClientRect();
        return Math.abs((box.top + box.bottom) / 2 - innerHeight / 2);
    };
    return [...viewers].sort((a, b) => distance(a) - distance(b))[0];
}

document.addEventListener("keydown", (e) => {
    const typing =
        /^(TEXTAREA|SELECT)$/.test(e.target.tagName) || (e.target.tagName === "INPUT" && e.target.type === "text");
    if (typing || e.ctrlKey || e.metaKey || e.altKey) return;
    if (activeViewer()?.key(e)) e.preventDefault();
});

function imagesSection() {
    viewers.splice(0).forEach((viewer) => viewer.resize.disconnect());
    const shown = groups.filter((group) => Viewer.has(group));
    if (!shown.length) return null;
    const make = (group) => {
        const viewer = new Viewer(group);
        viewers.push(viewer);
        return viewer.element;
    };
    return section(
        "images",
        "Images",
        "Reference, one run, and the mean over runs of each sampler; zoom, pan and exposure are common to all." +
            (data.exact === false
                ? ` To keep the page small they are JPEG${kShrink > 1 ? ` of means over ${squares(kShrink)}` : ""}: values are some per cent off.`
                : ""),
        shown.map((group) =>
            el(
                "div",
                { class: "group" },
                el("h3", {}, group.title),
                later(() => make(group)),
            ),
        ),
    );
}
