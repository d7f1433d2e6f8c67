#include "core/render/technique_films.h"

#include <fmt/format.h>

namespace ulam {

TechniqueFilms::Pair& TechniqueFilms::films(std::pair<int, int> technique) {
    return films_.try_emplace(technique, Pair{Film(width_, height_, filter_), Film(width_, height_, filter_)}).first->second;
}

void TechniqueFilms::add(const Contribution& c, int pixel) {
    Pair& pair = films({c.technique.s, c.technique.t});
    const Spectrum values[2] = {c.value, c.value / c.weight};
    for (size_t i = 0; i < 2; ++i) {
        if (c.technique.t == 1) pair[i].splat(c.raster, values[i]);
        else pair[i].addSample(pixel, values[i]);
    }
}

void TechniqueFilms::take(TechniqueFilms& other) {
    for (auto& [technique, pair] : other.films_) {
        Pair& mine = films(technique);
        for (size_t i = 0; i < 2; ++i) mine[i].take(pair[i]);
    }
}

void TechniqueFilms::develop(const Film& counted, double splatScale, std::map<std::string, Image>& images) const {
    for (const auto& [technique, pair] : films_)
        for (size_t i = 0; i < 2; ++i)
            images[fmt::format("s{:02}_t{:02}_{}", technique.first, technique.second, i == 0 ? "weighted" : "unweighted")] =
                pair[i].developCountedBy(counted, splatScale);
}

}  // namespace ulam
