#include <hshfit/material_library/log_brdf.h>

#include <hshfit/material_library/log_terms.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace hshfit::material_library {
namespace {

/// The sums of all channels, each in the order of the terms. Channels side by side do not wait for
/// each other's additions, which took half of the time of a picture.
template <std::size_t channels>
void sumTerms(const double* exponents, const std::vector<double>& terms, double* sums) {
    std::array<double, channels> sum{};
    const std::size_t size = terms.size();
    for (std::size_t t = 0; t < size; ++t)
        for (std::size_t c = 0; c < channels; ++c) sum[c] += exponents[c * size + t] * terms[t];
    std::copy(sum.begin(), sum.end(), sums);
}

}  // namespace

LogBrdf::LogBrdf(LogMaterial material, std::string name)
    : material_(std::move(material)),
      name_(std::move(name)),
      channels_(material_.channels() == 3 ? Channels::rgb() : Channels::grey()) {
    assert(material_.channels() == 1 || material_.channels() == 3);
    assert(material_.exponents.size() == material_.channels() * logTerms().size());
    laws_.nonNegative = laws_.isotropic = laws_.mirrorSymmetric = laws_.reciprocal = true;
}

void LogBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = material_.channels(), size = logTerms().size();
    std::fill_n(out, channels * wi.count, 0.0);
    if (!(wo.z > 0)) return;
    std::vector<double> terms(size);
    for (std::size_t k = 0; k < wi.count; ++k) {
        if (!(wi.z[k] > 0)) continue;
        logTerms().evaluate({wi.x[k], wi.y[k], wi.z[k]}, wo, terms.data());
        std::array<double, 3> sums;
        if (channels == 3)
            sumTerms<3>(material_.exponents.data(), terms, sums.data());
        else
            sumTerms<1>(material_.exponents.data(), terms, sums.data());
        for (std::size_t c = 0; c < channels; ++c) {
            const double f = std::exp(std::min(sums[c], material_.tops[c])) - logOffset;
            out[c * wi.count + k] = std::max(f, 0.0);
        }
    }
}

std::vector<Lobe> LogBrdf::lobes(const Direction&) const {
    return {{.about = Lobe::About::halfway, .width = 0.02}};
}

}  // namespace hshfit::material_library
