// The page, in reading order.

function subtitle() {
    const experiment = data.experiment ?? {};
    const budget = budgetText(experiment.budget);
    const replicates = [...new Set(cells.map((cell) => cell.replicates).filter(isNumber))];
    const plural = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;
    const film = experiment.film;
    return [
        plural(new Set(cells.map((cell) => cell.scene)).size, "scene"),
        plural(samplerNames.length, "sampler"),
        replicates.length && `${replicates.join(", ")} runs each`,
        budget && `${budget} a run`,
        film?.width && `${film.width} × ${film.height}`,
        experiment.max_depth && `path length up to ${experiment.max_depth}`,
        `primary metric ${metricName(primaryMetric ?? kDash)}`,
        experiment.baseline && `baseline ${experiment.baseline}`,
    ]
        .filter(Boolean)
        .join(" · ");
}

/// Calls `whenDone` when all is made.
function render(whenDone = () => {}) {
    waiting.length = 0;
    const name = summary.name ?? data.experiment?.name ?? "run";
    const sections = [
        verdictSection(),
        tuningSection(),
        sweepSection(),
        cellsSection(),
        convergenceSection(),
        spectrumSection(),
        imagesSection(),
        techniquesSection(),
        chainsSection(),
        mutationsSection(),
        occupancySection(),
        caughtSection(),
        ledgerSection(),
        provenanceSection(),
    ].filter(Boolean);
    const links = sections.map((s) => el("a", { href: `#${s.id}` }, s.querySelector("h2").textContent));
    document
        .getElementById("page")
        .replaceChildren(
            el(
                "header",
                {},
                el("p", { class: "kind" }, "Ulam · comparison at equal cost"),
                el("h1", {}, name.replace(/_/g, " ")),
                el("p", { class: "subtitle" }, subtitle()),
            ),
            el("nav", { "aria-label": "sections" }, links),
            el("main", { "aria-busy": "true" }, ...[alarmBox()].filter(Boolean), ...sections),
        );
    const done = () => {
        document.querySelector("main").removeAttribute("aria-busy");
        whenDone();
    };
    setTimeout(() => decodeJpegs().then(() => makeWaiting(done)));
}

render();

let carried = null; // until the page is whole, when the colours change once more before it is
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    carried ??= reportView.get();
    render(() => {
        if (carried) reportView.set(carried);
        carried = null;
    });
});
