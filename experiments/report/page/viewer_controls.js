// What stands below a viewer's stage: exposure, what is shown, the split, which run.

class ViewerControls {
    /// `viewer.set` takes what they change of its state.
    constructor(viewer) {
        this.exposureValue = el("output");
        this.exposure = el("input", {
            type: "range",
            class: "exposure",
            min: -12,
            max: 12,
            step: 0.25,
            "aria-label": "exposure in stops",
            oninput: () => viewer.set({ exposure: Number(this.exposure.value) }),
        });
        this.showButtons = viewer.shows.map(({ id, key, name }) => {
            const input = el("input", {
                type: "radio",
                class: `${id}-toggle`,
                name: `show-${viewer.group.id}`,
                onchange: () => viewer.set({ show: id }),
            });
            return { id, input, label: el("label", {}, input, ` ${name} `, key && el("kbd", {}, key)) };
        });
        this.splitBox = el("input", {
            type: "checkbox",
            class: "split-toggle",
            onchange: () => viewer.set({ split: this.splitBox.checked ? 0.5 : null }),
        });
        this.leftChoice = el(
            "select",
            {
                class: "split-left",
                "aria-label": "picture left of the divider",
                onchange: () => viewer.set({ left: this.leftChoice.selectedIndex }),
            },
            viewer.entries.map((entry) =>
                el("option", {}, entry.kind === "mean" ? `${entry.title}, mean` : entry.title),
            ),
        );
        this.worstBox = el("input", {
            type: "checkbox",
            class: "worst-toggle",
            onchange: () => viewer.set({ worst: this.worstBox.checked }),
        });
        this.element = el(
            "div",
            { class: "controls" },
            el("label", {}, "exposure ", this.exposure, this.exposureValue),
            el(
                "div",
                { class: "shows", role: "radiogroup", "aria-label": "what is shown" },
                this.showButtons.map(({ label }) => label),
            ),
            el("label", {}, this.splitBox, " split ", el("kbd", {}, "s"), " left: ", this.leftChoice),
            el("label", {}, this.worstBox, " worst run ", el("kbd", {}, "w")),
            el("button", { type: "button", onclick: () => viewer.reset() }, "reset view ", el("kbd", {}, "0")),
            el(
                "p",
                { class: "note" },
                el("kbd", {}, "1"),
                " … ",
                el("kbd", {}, "9"),
                " flip · drag to pan · ",
                el("kbd", {}, "+"),
                " ",
                el("kbd", {}, "−"),
                " or click, then wheel, to zoom · ",
                el("kbd", {}, "["),
                " ",
                el("kbd", {}, "]"),
                " exposure · drag the two frames by their corners, or focus them and use the arrows; so is the divider",
            ),
        );
    }

    update(state) {
        this.exposure.value = state.exposure;
        this.exposureValue.textContent = `${state.exposure > 0 ? "+" : ""}${plain(state.exposure)} EV`;
        for (const { id, input } of this.showButtons) input.checked = id === state.show;
        this.splitBox.checked = state.split !== null;
        this.leftChoice.selectedIndex = state.left;
        this.leftChoice.disabled = state.split === null;
        this.worstBox.checked = state.worst;
    }
}
