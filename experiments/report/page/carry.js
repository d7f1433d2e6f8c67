// What a reader has chosen, for the page that takes the place of this one: the next report of a run that goes on (ulam
// watch), or the same in other colours.

const entryName = (entry) => `${entry.kind} ${entry.title}`;

const viewsOfViewers = () =>
    viewers.map(({ group, state, entries }) => ({
        ...structuredClone(state),
        scene: group.title,
        shown: entryName(entries[state.shown]),
        left: entryName(entries[state.left]),
    }));

function setViewers(views) {
    for (const { scene, shown, left, ...state } of views) {
        const viewer = viewers.find((other) => other.group.title === scene);
        const indexOf = (name) => Math.max(0, viewer.entries.findIndex((entry) => entryName(entry) === name));
        viewer?.set({ ...structuredClone(state), shown: indexOf(shown), left: indexOf(left) });
    }
}

/// Selects outside of viewers have names of their own. In the order of the page: some make others.
const namedSelects = () => [...document.querySelectorAll("main select[aria-label]:not(.viewer select)")];

const chosenOptions = () =>
    namedSelects().map((select) => [select.getAttribute("aria-label"), select.selectedOptions[0]?.textContent]);

function chooseOptions(chosen) {
    for (const [name, text] of chosen) {
        const select = namedSelects().find((other) => other.getAttribute("aria-label") === name);
        const index = [...(select?.options ?? [])].findIndex((option) => option.textContent === text);
        if (index < 0 || index === select.selectedIndex) continue;
        select.selectedIndex = index;
        select.dispatchEvent(new Event("change"));
    }
}

const tableHeaders = () => [...document.querySelectorAll("#cell-table th")];

function tableOrder() {
    const sorted = tableHeaders().find((header) => header.ariaSort);
    return sorted && { column: sorted.textContent, direction: sorted.ariaSort };
}

function sortTable({ column, direction }) {
    const header = tableHeaders().find((other) => other.textContent === column);
    while (header && header.ariaSort !== direction) header.querySelector("button").click();
}

window.reportView = {
    get: () => ({ viewers: viewsOfViewers(), chosen: chosenOptions(), order: tableOrder(), scroll: scrollY }),
    set({ viewers: views = [], chosen = [], order, scroll }) {
        setViewers(views);
        chooseOptions(chosen);
        if (order) sortTable(order);
        if (scroll !== undefined) scrollTo({ top: scroll, behavior: "instant" });
    },
};
