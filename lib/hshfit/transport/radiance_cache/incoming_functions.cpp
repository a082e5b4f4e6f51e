#include <hshfit/transport/radiance_cache/incoming_functions.h>

#include <algorithm>

namespace hshfit::inline transport::inline radiance_cache {

IncomingFunctions::IncomingFunctions(std::shared_ptr<const Basis> basis)
    : basis_(std::move(basis)) {
    for (int l = 0; l < basis_->order(); ++l) {
        for (int m = -l; m <= l; ++m)
            if (basis_->has(l, m)) slots_.push_back(slotOf(l, m));
        for (int m = 1; m <= l; ++m) {
            if (!basis_->has(l, m)) continue;
            const auto placeOf = [&](int slot) {
                return static_cast<std::size_t>(std::ranges::find(slots_, slot) - slots_.begin());
            };
            pairs_.push_back({m, placeOf(slotOf(l, m)), placeOf(slotOf(l, -m))});
        }
    }
}

bool IncomingFunctions::cosine() const {
    return !basis_ || basis_->inner() == Basis::Inner::projectedSolidAngle;
}

bool IncomingFunctions::zonal(std::size_t function) const {
    if (!basis_) return true;
    for (int l = 0; l < basis_->order(); ++l)
        if (slots_[function] == slotOf(l, 0)) return true;
    return false;
}

void IncomingFunctions::tabulate(DirectionBatch directions, float* out) const {
    if (!basis_) {
        for (std::size_t k = 0; k < directions.count; ++k)
            out[k] = static_cast<float>(directions.z[k]);
        return;
    }
    const auto all = static_cast<std::size_t>(basis_->slots());
    std::vector<float> values(directions.count * all);
    basis_->evaluate(directions, values.data());
    for (std::size_t k = 0; k < directions.count; ++k) {
        const float factor = cosine() ? static_cast<float>(directions.z[k]) : 1;
        for (const int slot : slots_)
            *out++ = factor * values[k * all + static_cast<std::size_t>(slot)];
    }
}

}  // namespace hshfit::inline transport::inline radiance_cache
