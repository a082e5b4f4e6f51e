#include "content_key.h"

#include <hshfit/files/checksum.h>
#include <hshfit/files/mapped_file.h>

#include <cmath>
#include <span>
#include <vector>

namespace hshfit::jobs {
namespace {

namespace fs = std::filesystem;

/// The k-th of n directions, even over the hemisphere.
Direction latticeDirection(std::size_t k, std::size_t n) {
    const double golden = (std::sqrt(5.0) - 1) / 2;
    const double z = (static_cast<double>(k) + 0.5) / static_cast<double>(n);
    const double phi = 2 * pi * std::fmod(golden * static_cast<double>(k), 1.0);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace

std::string filesKey(std::string_view specification, const fs::path& folder) {
    constexpr std::string_view separators = ":,+=";
    std::vector<std::size_t> cuts{0};
    for (std::size_t k = 0; k < specification.size(); ++k)
        if (separators.find(specification[k]) != std::string_view::npos) cuts.push_back(k + 1);
    cuts.push_back(specification.size() + 1);
    std::string text;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        for (std::size_t j = i + 1; j < cuts.size(); ++j) {
            const fs::path name = specification.substr(cuts[i], cuts[j] - 1 - cuts[i]);
            for (const fs::path& place : {name, folder / name}) {
                std::error_code error;
                if (name.empty() || !fs::is_regular_file(place, error) ||
                    fs::file_size(place, error) == 0)
                    continue;
                const MappedFile file(place.string());
                text += place.string() + " " + sha256(std::as_bytes(file.bytes())) + "\n";
                file.checkIntact();
            }
        }
    }
    return text;
}

std::string valuesKey(const Brdf& brdf) {
    constexpr std::size_t side = 32;
    const std::size_t channels = brdf.channels().count();
    std::vector<double> values(side * side * channels);
    for (std::size_t o = 0; o < side; ++o) {
        const Direction wo = latticeDirection(o, side);
        for (std::size_t i = 0; i < side; ++i) {
            const Direction wi = latticeDirection(i, side);
            brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, values.data() + (o * side + i) * channels);
        }
    }
    return sha256(std::as_bytes(std::span(values))) + "\n";
}

}  // namespace hshfit::jobs
