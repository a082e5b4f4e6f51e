#include <hshfit/material_library/log_brdf.h>

#include <hshfit/material_library/log_terms.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::material_library {

LogBrdf::LogBrdf(LogMaterial material, std::string name)
    : material_(std::move(material)),
      name_(std::move(name)),
      channels_(material_.channels() == 3 ? Channels::rgb() : Channels::grey()) {
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
        for (std::size_t c = 0; c < channels; ++c) {
            const double* exponents = material_.exponents.data() + c * size;
            double sum = 0;
            for (std::size_t t = 0; t < size; ++t) sum += exponents[t] * terms[t];
            const double f = std::exp(std::min(sum, material_.tops[c])) - logOffset;
            out[c * wi.count + k] = std::max(f, 0.0);
        }
    }
}

std::vector<Lobe> LogBrdf::lobes(const Direction&) const {
    return {{.about = Lobe::About::halfway, .width = 0.02}};
}

}  // namespace hshfit::material_library
