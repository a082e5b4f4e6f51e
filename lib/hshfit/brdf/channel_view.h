#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/brdf/steps.h>
#include <hshfit/brdf/transmission.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline brdf {

/// A BRDF whose channels are weighted sums of another's at the same directions: the colours of a
/// spectrum, or the mean of the channels. The samples behind the other BRDF, converted value by
/// value, are therefore the samples behind this one.
class ChannelView final : public Brdf,
                          public HasKinkCurves,
                          public HasSteps,
                          public HasOutgoingLobes {
public:
    /// Everything that differs from the BRDF that is seen.
    struct Look {
        std::string name;
        Channels channels;
        Laws laws;
        std::vector<std::vector<double>> weights;  ///< [channel][channel of the BRDF]
        std::vector<Fact> facts = {};              ///< in addition to the facts of the BRDF
    };
    ChannelView(std::shared_ptr<const Brdf> seen, Look look)
        : seen_(std::move(seen)), look_(std::move(look)) {}

    const Brdf& seen() const { return *seen_; }
    /// `from`: a value per channel of `seen()`; `to`: one per channel of this.
    void convert(std::span<const double> from, std::span<double> to) const;

    std::string name() const override { return look_.name; }
    const Channels& channels() const override { return look_.channels; }
    const Laws& laws() const override { return look_.laws; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override {
        seen_->coverage(wo, wi, covered);
    }
    std::vector<Lobe> lobes(const Direction& wo) const override { return seen_->lobes(wo); }
    std::vector<Lobe> outgoingLobes(const Direction& wi) const override {
        return outgoingLobesOf(*seen_, wi);
    }
    std::vector<double> kinks(const Direction& wo) const override { return seen_->kinks(wo); }
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return kinkCurvesOf(*seen_, wo);
    }
    std::vector<double> outgoingKinks(const Direction& wi) const override {
        return outgoingKinksOf(*seen_, wi);
    }
    std::vector<KinkCurve> outgoingKinkCurves(const Direction& wi) const override {
        return outgoingKinkCurvesOf(*seen_, wi);
    }
    int squareLevels() const override { return squareLevelsOf(*seen_); }
    double defaultTolerance() const override { return seen_->defaultTolerance(); }
    std::vector<Fact> facts() const override;
    void checkIntact() const override { seen_->checkIntact(); }

private:
    std::shared_ptr<const Brdf> seen_;
    Look look_;
};

}  // namespace hshfit::inline brdf
