// How a sampler was tuned before it was compared: what was tried, and what was left after each round.

function tuningSection() {
    const { tuning } = summary;
    if (!tuning?.candidates?.length) return null;
    const { sampler, candidates, rounds, winner } = tuning;
    const names = Object.keys(candidates[0].values),
        same = (values) => JSON.stringify(values) === JSON.stringify(winner),
        said = (value) => (isNumber(value) ? plain(value) : JSON.stringify(value));
    const last = (candidate) => candidate.scores.length,
        score = (candidate) => candidate.scores.at(-1) ?? Number.MAX_VALUE;
    const sorted = [...candidates].sort((a, b) => last(b) - last(a) || score(a) - score(b));
    const row = ({ values, scores }) =>
        el(
            "tr",
            { class: same(values) ? "winner" : "" },
            names.map((name) => el("th", { scope: "row" }, said(values[name]))),
            rounds.map((_, k) => el("td", {}, isNumber(scores[k]) ? number(Math.exp(scores[k])) : scores[k] === null ? "failed" : kDash)),
            el("td", { class: "text" }, same(values) ? "chosen" : ""),
        );
    const head = [
        ...names.map((name) => el("th", { scope: "col" }, name.split(".").slice(2).join("."))),
        ...rounds.map((round, k) =>
            el("th", { scope: "col" }, `round ${k + 1}`, el("span", { class: "ci" }, budgetText(round.budget))),
        ),
        el("th", { scope: "col" }, ""),
    ];
    return section(
        "tuning",
        "Tuning",
        `Parameters of ${sampler} that were tried, with their ${metricName(primaryMetric)} (geometric mean over scenes); the best of a round went on with more budget. ${sampler} is compared with the parameters chosen here, at random numbers that no round used; ${sampler}_untuned is as it was written.`,
        el(
            "div",
            { class: "scroll" },
            el("table", { id: "tuning-table" }, el("thead", {}, el("tr", {}, head)), el("tbody", {}, sorted.map(row))),
        ),
    );
}
