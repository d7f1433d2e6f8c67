// What a reader chose to see, for the next report of a run that goes on (ulam watch).

window.reportView = {
    get: () =>
        viewers.map((viewer) => {
            const { title, kind } = viewer.entries[viewer.state.shown];
            return { ...viewer.state, scene: viewer.group.title, title, kind };
        }),
    set(views) {
        for (const { scene, title, kind, ...state } of views) {
            const viewer = viewers.find((other) => other.group.title === scene);
            const shown = viewer?.entries.findIndex((entry) => entry.title === title && entry.kind === kind) ?? -1;
            if (viewer) viewer.set({ ...state, shown: Math.max(0, shown) });
        }
    },
};
