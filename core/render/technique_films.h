#pragma once
// One image per bidirectional technique, weighted and unweighted (Veach 1997, figure 10.3).

#include "core/image/film.h"
#include "core/path/bidirectional.h"

#include <map>
#include <string>

namespace ulam {

class TechniqueFilms {
public:
    TechniqueFilms(int width, int height, const ReconstructionFilter& filter) : width_(width), height_(height), filter_(filter) {}

    void add(const Contribution& contribution, int pixel);
    /// Takes everything from another and leaves that empty.
    void take(TechniqueFilms& other);
    template <class Archive>
    void archive(Archive& a) {
        std::vector<std::array<int, 2>> techniques;
        for (const auto& [technique, pair] : films_) techniques.push_back({technique.first, technique.second});
        a(techniques);
        for (const auto& [s, t] : techniques) a(films({s, t}));
    }

    /// Adds "s02_t03_weighted" and so on; the weighted ones sum to the whole image. `counted` has the number of samples
    /// of each pixel.
    void develop(const Film& counted, double splatScale, std::map<std::string, Image>& images) const;

private:
    using Pair = std::array<Film, 2>;
    Pair& films(std::pair<int, int> technique);

    int width_, height_;
    ReconstructionFilter filter_;
    std::map<std::pair<int, int>, Pair> films_;
};

}  // namespace ulam
