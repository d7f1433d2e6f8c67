// What a viewer can show.

/// Errors per pixel need a reference of the images' own size.
function comparableReference(group) {
    const reference = picture(referenceId(group));
    const sizes = group.cells.map((cell) => picture(pictureIds(cell).mean)).filter(Boolean);
    return sizes.every((p) => p.width === reference?.width && p.height === reference?.height) ? reference : null;
}

/// In the order of the keys: reference, one replicate of each cell, mean of each cell. Those of replicates have no picture
/// before `chooseReplicates`.
function viewerEntries(group, reference) {
    const withImages = group.cells.filter((cell) => pictureIds(cell).mean !== undefined);
    const entries = reference ? [{ title: "reference", picture: reference, kind: "reference" }] : [];
    for (const cell of withImages) entries.push({ cell, kind: "replicate", title: cell.label });
    for (const cell of withImages)
        entries.push({
            cell,
            kind: "mean",
            title: cell.label,
            note: `mean of ${cell.replicates ?? "all"} runs`,
            picture: picture(pictureIds(cell).mean),
        });
    return entries;
}

const entryCaption = ({ title, note }) => `${title}${note ? `, ${note}` : ""}`;

/// `which`: "median" or "worst", by the error.
function chooseReplicates(entries, which) {
    for (const entry of entries.filter(({ kind }) => kind === "replicate")) {
        const ids = pictureIds(entry.cell),
            index = replicateIndex(entry.cell, ids[`${which}_replicate`]);
        const value = entry.cell.metrics?.[primaryMetric]?.values?.[index];
        entry.picture = picture(ids[which]);
        entry.note = `${which} run${isNumber(value) ? `, ${metricName(primaryMetric)} ${number(value)}` : ""}`;
    }
}
