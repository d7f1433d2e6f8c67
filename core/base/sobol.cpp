#include "core/base/sobol.h"

namespace ulam {

ScrambledSobol::Table ScrambledSobol::table() {
    // Degree and inner coefficients of the primitive polynomial, and the first direction numbers.
    struct Dimension {
        int degree;
        uint32_t coefficients;
        std::array<uint32_t, 3> first;
    };
    constexpr Dimension kDimensions[3] = {{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}};

    std::array<Bits, 32> directions;
    for (int i = 0; i < 32; ++i) directions[size_t(i)][0] = 1u << (31 - i);  // van der Corput
    for (int k = 0; k < 3; ++k) {
        const Dimension& d = kDimensions[k];
        for (int i = 0; i < 32; ++i) {
            uint32_t& v = reinterpret_cast<uint32_t*>(&directions[size_t(i)])[k + 1];
            const auto before = [&](int n) { return directions[size_t(i - n)][k + 1]; };
            if (i < d.degree) {
                v = d.first[size_t(i)] << (31 - i);
                continue;
            }
            v = before(d.degree) ^ before(d.degree) >> d.degree;
            for (int n = 1; n < d.degree; ++n)
                if (d.coefficients >> (d.degree - 1 - n) & 1) v ^= before(n);
        }
    }
    Table table{};
    for (int byte = 0; byte < 4; ++byte)
        for (uint32_t value = 0; value < 256; ++value)
            for (int bit = 0; bit < 8; ++bit)
                if (value >> bit & 1) table[size_t(byte)][value] ^= reverse(directions[size_t(8 * byte + bit)]);
    return table;
}

}  // namespace ulam
