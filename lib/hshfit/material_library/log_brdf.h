#pragma once

#include <hshfit/brdf/brdf.h>

#include <string>
#include <vector>

namespace hshfit::material_library {

/// ln(f + logOffset) of a material as sums of logTerms(), and its bounds.
struct LogMaterial {
    std::vector<double> exponents;  ///< [channel][term]
    std::vector<double> tops;       ///< the greatest ln(f + logOffset), [channel]

    std::size_t channels() const { return tops.size(); }
    std::size_t bytes() const { return sizeof(float) * (exponents.size() + tops.size()); }
};

/// f = max(exp(min(sum of exponents, top)) - logOffset, 0), in 1/sr: never negative, nowhere above
/// the bound of the channel. Isotropic, mirror symmetric and reciprocal.
class LogBrdf final : public Brdf {
public:
    /// One channel is grey, three are linear Rec. 709.
    LogBrdf(LogMaterial material, std::string name);

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    std::vector<Lobe> lobes(const Direction& wo) const override;
    /// 1e-2, as of the halfway form: f has kinks where it is cut off.
    double defaultTolerance() const override { return 1e-2; }

    const LogMaterial& material() const { return material_; }

private:
    LogMaterial material_;
    std::string name_;
    Channels channels_;
    Laws laws_;
};

}  // namespace hshfit::material_library
