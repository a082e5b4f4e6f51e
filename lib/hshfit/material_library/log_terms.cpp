#include <hshfit/material_library/log_terms.h>

#include <array>
#include <cassert>

namespace hshfit::material_library {
namespace {

constexpr HalfwayOrders orders{16, 8, 7};
// The least errors over sixty tables, among 0.01, 0.02 and 0.05.
constexpr double roughness = 0.02;
constexpr std::size_t mostTerms = 512;

}  // namespace

LogTerms::LogTerms()
    : terms_(orders, {.isotropic = true, .bilateral = true, .reciprocal = true}), axes_(lobe()) {
    assert(terms_.size() <= mostTerms);
    for (std::size_t t = 0; t < terms_.size(); ++t) {
        const HalfwayTerm& term = terms_.list()[t];
        if (term.lobe || term.i > 0 || term.k > 0) kept_.push_back(t);
    }
}

HalfwayLobe LogTerms::lobe() {
    return {.along = roughness, .across = roughness, .turn = 0, .shelf = 1};
}

void LogTerms::evaluate(const Direction& wi, const Direction& wo, double* out) const {
    std::array<double, mostTerms> all;
    terms_.evaluate(axes_.at(wi, wo), all.data());
    for (std::size_t t = 0; t < kept_.size(); ++t) out[t] = all[kept_[t]];
}

const LogTerms& logTerms() {
    static const LogTerms terms;
    return terms;
}

}  // namespace hshfit::material_library
