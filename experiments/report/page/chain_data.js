// The chains of one run, draw by draw, and what their scalars tell: ranks and autocorrelation.

const kScalars = [
    { id: "raster_x", name: "place across" },
    { id: "raster_y", name: "place down" },
    { id: "log_target", name: "log target" },
    { id: "path_length", name: "path length" },
    { id: "feature", name: "feature" },
];

class Chains {
    constructor({ data: id, chains, draws, log_target: [low, high], ...rest }) {
        Object.assign(this, { chains, draws }, rest);
        const bytes = embeddedBytes(id),
            view = new DataView(bytes.buffer),
            n = chains * draws;
        const words = (plane, map) =>
            Float32Array.from({ length: n }, (_, i) => map(view.getUint16(2 * (plane * n + i), true) / 65535));
        const singles = (plane, map) => Float32Array.from({ length: n }, (_, i) => map(bytes[6 * n + plane * n + i]));
        this.values = {
            raster_x: words(0, (v) => v),
            raster_y: words(1, (v) => v),
            log_target: words(2, (v) => low + v * (high - low)),
            path_length: singles(0, (v) => v),
            feature: singles(1, (v) => v - 1),
        };
    }

    /// Scalars that are not the same everywhere.
    get scalars() {
        return kScalars.filter(({ id }) => this.values[id].some((v) => v !== this.values[id][0]));
    }

    chain(scalar, index) {
        return this.values[scalar].subarray(index * this.draws, (index + 1) * this.draws);
    }

    /// How many of each chain's draws fall into each of `bins` equal classes of the ranks of all; the same in all classes
    /// if chains agree (Vehtari et al. 2021). Equal values share their mean rank.
    rankCounts(scalar, bins) {
        const values = this.values[scalar],
            order = Uint32Array.from(values.keys()).sort((a, b) => values[a] - values[b]),
            counts = Array.from({ length: this.chains }, () => new Float64Array(bins));
        for (let i = 0; i < order.length;) {
            let end = i + 1;
            while (end < order.length && values[order[end]] === values[order[i]]) ++end;
            // Spread over all classes that the tie covers, or ties would pile up in one.
            const from = (i / order.length) * bins,
                to = (end / order.length) * bins;
            for (let bin = Math.floor(from); bin < to && bin < bins; ++bin) {
                const share = (Math.min(to, bin + 1) - Math.max(from, bin)) / (to - from);
                for (let k = i; k < end; ++k) counts[Math.floor(order[k] / this.draws)][bin] += share;
            }
            i = end;
        }
        return counts;
    }

    /// ρ at lags 0 … most of a chain around its own mean; 1 throughout for a chain that never moves.
    autocorrelation(scalar, index, most) {
        const x = this.chain(scalar, index),
            own = covariances(x, mean([...x]), most);
        return own.map((c) => (own[0] > 0 ? c / own[0] : 1));
    }

    /// ρ around the mean of all chains, over all of them: it does not fall to 0 where chains stay apart.
    commonAutocorrelation(scalar, most) {
        const centre = mean([...this.values[scalar]]),
            totals = new Float64Array(most + 1);
        for (let i = 0; i < this.chains; ++i)
            covariances(this.chain(scalar, i), centre, most).forEach((c, lag) => (totals[lag] += c));
        return [...totals].map((c) => (totals[0] > 0 ? c / totals[0] : 1));
    }
}

/// Means of products of deviations at lags 0 … most.
function covariances(x, centre, most) {
    return Array.from({ length: most + 1 }, (_, lag) => {
        let total = 0;
        for (let i = 0; i + lag < x.length; ++i) total += (x[i] - centre) * (x[i + lag] - centre);
        return total / (x.length - lag);
    });
}
