#pragma once

#include <hshfit/brdf/brdf.h>

#include <functional>
#include <string>
#include <utility>

namespace hshfit::test {

/// A BRDF of any formula, covered where `covers` is true, or everywhere if it is empty. With
/// two wavelengths, the second channel is half of the first.
class FormulaBrdf : public Brdf {
public:
    using Function = std::function<double(const Direction& wi, const Direction& wo)>;
    using Predicate = std::function<bool(const Direction& wi, const Direction& wo)>;
    explicit FormulaBrdf(Function f, Predicate covers = {}, Laws laws = {.isotropic = true},
                         Channels channels = Channels::grey())
        : f_(std::move(f)),
          covers_(std::move(covers)),
          laws_(laws),
          channels_(std::move(channels)) {}

    std::string name() const override { return "formula"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < wi.count; ++k) {
            out[k] = f_({wi.x[k], wi.y[k], wi.z[k]}, wo);
            if (channels_.count() == 2) out[wi.count + k] = out[k] / 2;
        }
    }
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override {
        for (std::size_t k = 0; k < wi.count; ++k)
            covered[k] = !covers_ || covers_({wi.x[k], wi.y[k], wi.z[k]}, wo);
    }

private:
    Function f_;
    Predicate covers_;
    Laws laws_;
    Channels channels_;
};

}  // namespace hshfit::test
