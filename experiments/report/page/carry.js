// What a reader looks at in the images, for the next report of a run that goes on (ulam watch).

const entryName = (entry) => `${entry.kind} ${entry.title}`;

window.reportView = {
    get: () =>
        viewers.map(({ group, state, entries }) => ({
            ...state,
            scene: group.title,
            shown: entryName(entries[state.shown]),
            left: entryName(entries[state.left]),
        })),
    set(views) {
        for (const { scene, shown, left, ...state } of views) {
            const viewer = viewers.find((other) => other.group.title === scene);
            const indexOf = (name) => Math.max(0, viewer.entries.findIndex((entry) => entryName(entry) === name));
            viewer?.set({ ...state, shown: indexOf(shown), left: indexOf(left) });
        }
    },
};
