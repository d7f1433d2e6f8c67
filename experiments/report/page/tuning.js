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
    const columns = [
        ...names.map((name) => ({
            title: name.split(".").slice(2).join("."),
            names: true,
            value: ({ values }) => (isNumber(values[name]) ? values[name] : JSON.stringify(values[name])),
            show: ({ values }) => said(values[name]),
        })),
        ...rounds.map((round, k) => ({
            title: [`round ${k + 1}`, el("span", { class: "ci" }, budgetText(round.budget))],
            value: ({ scores }) => scores[k],
            show: ({ scores }) => (isNumber(scores[k]) ? number(Math.exp(scores[k])) : scores[k] === null ? "failed" : kDash),
        })),
        { title: "", kind: "text", show: ({ values }) => (same(values) ? "chosen" : "") },
    ];
    return section(
        "tuning",
        "Tuning",
        `Parameters of ${sampler} that were tried, with their ${metricName(primaryMetric)} (geometric mean over scenes); the best of a round went on with more budget. ${sampler} is compared with the parameters chosen here, at random numbers that no round used; ${sampler}_untuned is as it was written.`,
        sortableTable("tuning", columns, sorted, { id: "tuning-table", rowClass: ({ values }) => (same(values) ? "winner" : null) }),
    );
}
