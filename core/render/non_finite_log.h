#pragma once
// Which samples and steps met a value that is not finite: how many by cause, and the first ones, to be made again.

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "core/base/non_finite.h"

namespace ulam {

struct NonFiniteEvent {
    enum class Kind : uint8_t { Pilot, Bootstrap, Sample, Step };
    Kind kind = Kind::Sample;
    uint64_t unit = 0;  ///< its number among those of its kind
    // Of a step:
    uint32_t chain = 0;
    uint64_t step = 0;
    std::string cause = {};

    /// In the order of the work.
    friend bool operator<(const NonFiniteEvent& a, const NonFiniteEvent& b) {
        return std::tie(a.kind, a.unit) < std::tie(b.kind, b.unit);
    }
    template <class Archive>
    void archive(Archive& a) {
        a(kind, unit, chain, step, cause);
    }
};

/// Of one worker, or of all.
class NonFiniteLog {
public:
    static constexpr size_t kKept = 16;

    void add(NonFiniteEvent event) {
        ++counts_[event.cause];
        first_.push_back(std::move(event));
        keepFirst();
    }
    /// More of a cause, of which no more is known.
    void count(const std::string& cause, uint64_t values) {
        if (values > 0) counts_[cause] += values;
    }
    /// Takes everything from another and leaves that empty.
    void take(NonFiniteLog& other) {
        for (const auto& [cause, count] : other.counts_) counts_[cause] += count;
        first_.insert(first_.end(), other.first_.begin(), other.first_.end());
        other = {};
        keepFirst();
    }
    template <class Archive>
    void archive(Archive& a) {
        a(counts_, first_);
    }

    const std::map<std::string, uint64_t>& counts() const { return counts_; }
    const std::vector<NonFiniteEvent>& first() const { return first_; }

private:
    void keepFirst() {
        std::sort(first_.begin(), first_.end());
        if (first_.size() > kKept) first_.resize(kKept);
    }

    std::map<std::string, uint64_t> counts_;
    std::vector<NonFiniteEvent> first_;
};

}  // namespace ulam
