#include <hshfit/material_library/shared_functions.h>

#include <hshfit/material_library/log_terms.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <cassert>
#include <cmath>

namespace hshfit::material_library {
namespace {

/// Half precision holds every whole number up to 2048, and so every coordinate of at most
/// `widestHalf` bits; with scales, which take three quarters of it, of at most `widestScaled`. The
/// first of two halves of a wider one is a multiple of this one, and both are exact.
constexpr std::uint8_t widestHalf = 12, widestScaled = 10;
constexpr double wholeHalves = 2048, scaledHalves = 64;
constexpr double quarters = 4;  ///< of which scales are multiples

}  // namespace

Representation sharedFunctions(const Basis& basis) {
    const LogTerms& terms = logTerms();
    const std::size_t count = terms.size(), channels = basis.size() + 1;
    Representation functions;
    std::vector<std::string> names{"mean"};
    for (std::size_t k = 1; k < channels; ++k) names.push_back(fmt::format("component {}", k));
    functions.head.channels = Channels::named(std::move(names), {});
    functions.head.isotropic = functions.head.bilateral = functions.head.reciprocal = true;
    functions.head.generator = std::string("hshfit ") + version;
    functions.halfway = terms.all().orders();
    HalfwayArray content{.halfway = {.shape = {channels, terms.all().size()}, .values = {}},
                         .lobe = LogTerms::lobe(),
                         .ceilings = std::vector<HalfwayCeiling>(channels)};
    content.halfway.values.assign(channels * terms.all().size(), 0.0);
    for (std::size_t k = 0; k < channels; ++k) {
        for (std::size_t t = 0; t < count; ++t)
            content.halfway.values[k * terms.all().size() + terms.kept()[t]] =
                k == 0 ? basis.mean[t] : basis.step * basis.components[(k - 1) * count + t];
    }
    functions.content = std::move(content);
    return functions;
}

std::vector<TexelPart> texelParts(const Basis& basis) {
    std::vector<TexelPart> parts;
    for (std::size_t k = 0; k < basis.size(); ++k) {
        if (basis.widths[k] > (basis.scaled ? widestScaled : widestHalf))
            parts.push_back({k + 1, basis.scaled ? scaledHalves : wholeHalves});
        parts.push_back({k + 1, 1});
    }
    return parts;
}

std::vector<double> texelsOf(const Basis& basis, const Material& material) {
    assert(material.kind == Kind::coded);
    const std::size_t bytes = basis.channelBytes();
    const std::vector<TexelPart> parts = texelParts(basis);
    std::vector<double> texels(4 * (parts.size() + 1), 0.0);
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t from = material.channels == 1 ? 0 : c;
        const ChannelCode code =
            unpack(basis, std::span(material.codes).subspan(from * bytes, bytes));
        double rest = 0;
        for (std::size_t n = 0; n < parts.size(); ++n) {
            const auto& [function, scale] = parts[n];
            if (n == 0 || parts[n - 1].function != function)
                rest =
                    std::round(quarters * code.coordinates[function - 1] / basis.step) / quarters;
            const bool last = n + 1 == parts.size() || parts[n + 1].function != function;
            texels[4 * n + c] = last ? rest : std::trunc(rest / scale);
            rest -= scale * texels[4 * n + c];
        }
        texels[4 * parts.size() + c] = std::round((code.top - std::log(logOffset)) * topsPerLog);
    }
    return texels;
}

}  // namespace hshfit::material_library
