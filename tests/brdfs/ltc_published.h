#pragma once

// The tables that Heitz, Dupuy, Hill & Neubelt published for GGX, 64 x 64.

#include <brdfs/fit/ltc.h>
#include <brdfs/measured/text_reader.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace hshfit::test {

inline std::string contentOfFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// IEEE 754 binary16.
inline double fromHalf(std::uint16_t bits) {
    const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
    const double size =
        exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
    return bits & 0x8000 ? -size : size;
}

/// The texels of a DDS file of halves, after its header of 128 bytes.
inline std::vector<double> ddsTexels(const std::string& bytes) {
    std::vector<double> values;
    for (std::size_t at = 128; at + 1 < bytes.size(); at += 2) {
        const auto low = static_cast<unsigned char>(bytes[at]);
        const auto high = static_cast<unsigned char>(bytes[at + 1]);
        values.push_back(fromHalf(static_cast<std::uint16_t>(low | high << 8)));
    }
    return values;
}

class PublishedLtc {
public:
    static constexpr int size = 64;

    /// `folder` holds ltc_1.dds, ltc_2.dds and ltc.inc.
    explicit PublishedLtc(const std::string& folder)
        : first_(ddsTexels(contentOfFile(folder + "/ltc_1.dds"))),
          second_(ddsTexels(contentOfFile(folder + "/ltc_2.dds"))) {
        const std::string text = contentOfFile(folder + "/ltc.inc");
        const std::size_t table = text.find("tabMinv[size*size]");
        if (table == std::string::npos) return;
        std::size_t at = text.find('{', table) + 1;
        const std::size_t end = text.find(';', at);
        for (std::string_view rest; at < end && inverses_.size() < 9 * size * size; ++at) {
            rest = std::string_view(text).substr(at, end - at);
            double value = 0;
            if (!brdfs::takeNumber(rest, value)) continue;
            inverses_.push_back(value);
            at = end - rest.size();
        }
    }

    bool complete() const {
        constexpr std::size_t cells = size * size;
        return first_.size() == 4 * cells && second_.size() == 4 * cells &&
               inverses_.size() == 9 * cells;
    }
    const double* texel(int picture, int row, int column) const {
        return (picture == 0 ? first_ : second_).data() + 4 * (row * size + column);
    }
    /// A table as read from the picture (halves), and from the text (six decimals).
    std::array<brdfs::Ltc, 2> matrices(int row, int column) const {
        const double* p = texel(0, row, column);
        const double* m = inverses_.data() + 9 * (row * size + column);
        return {{{.a = p[0], .c = p[1], .b = p[2], .d = p[3]},
                 {.a = m[0] / m[4], .c = m[2] / m[4], .b = m[6] / m[4], .d = m[8] / m[4]}}};
    }

private:
    std::vector<double> first_, second_, inverses_;
};

}  // namespace hshfit::test
