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

const tableOf = (header) => header.closest("table").getAttribute("aria-label");

const tableOrders = () =>
    [...document.querySelectorAll("main th[aria-sort]")].map((header) => ({
        table: tableOf(header),
        column: header.textContent,
        direction: header.ariaSort,
    }));

function sortTable({ table, column, direction }) {
    const header = [...document.querySelectorAll("main th:has(> button)")].find(
        (other) => tableOf(other) === table && other.textContent === column,
    );
    while (header && header.ariaSort !== direction) header.querySelector("button").click();
}

window.reportView = {
    get: () => ({ viewers: viewsOfViewers(), chosen: chosenOptions(), orders: tableOrders(), scroll: scrollY }),
    set({ viewers: views = [], chosen = [], orders = [], scroll }) {
        setViewers(views);
        chooseOptions(chosen);
        orders.forEach(sortTable);
        if (scroll !== undefined) scrollTo({ top: scroll, behavior: "instant" });
    },
};
