#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/brdf/steps.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/sampling/sampler.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The syntax of a sum of BRDFs, in one line.
inline constexpr std::string_view sumHelp =
    "any specifications joined by '+', each with an optional weight and ' * ': "
    "'lambert:kd=0.1 + 0.5 * ggx:alpha=0.2'";

/// Every '+' may be part of a path, so that splitting asks the file system for each pair of them.
inline constexpr std::size_t mostTerms = 256;

/// One term of a sum; the weight is in [0, 1e6].
struct WeightedSpec {
    double weight = 1;
    std::string spec;
};

/// Splits "SPEC + WEIGHT * SPEC + …" at every '+' that is not in a number, with or without spaces
/// around it. A text for which `isWhole` is true (an existing path) is not split; the longest is
/// tried first. One term of weight 1 if `spec` is no sum. Throws UsageError for an empty term, a
/// weight out of range, or more than `mostTerms`.
std::vector<WeightedSpec> splitSum(std::string_view spec, bool (*isWhole)(std::string_view));

/// sum_t weight_t f_t. Grey terms count for every channel of the others.
///   laws       what all terms keep; energy only if every term does and the weights add up to at
///              most 1, since no more is known of the albedos
///   coverage   where all terms are covered
///   lobes, kinks, facts   of all terms; the tolerance is the largest of all terms'
/// Throws UsageError for rgb with spectral terms and for spectra of different wavelengths.
class Sum final : public Brdf,
                  public HasKinkCurves,
                  public HasSteps,
                  public HasOutgoingLobes,
                  public HasSamplers {
public:
    struct Term {
        double weight = 1;
        std::unique_ptr<Brdf> brdf;
    };
    explicit Sum(std::vector<Term> terms);

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    std::vector<Lobe> lobes(const Direction& wo) const override;
    std::vector<Lobe> outgoingLobes(const Direction& wi) const override;
    std::vector<double> kinks(const Direction& wo) const override;
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override;
    std::vector<double> outgoingKinks(const Direction& wi) const override;
    std::vector<KinkCurve> outgoingKinkCurves(const Direction& wi) const override;
    int squareLevels() const override;
    double defaultTolerance() const override;
    /// The densities of all terms; `all` is false if a term has none of its own. More than 8
    /// densities give an empty list.
    Known samplers() const override;
    std::vector<Fact> facts() const override;
    void checkIntact() const override;

private:
    std::vector<Term> terms_;
    std::string name_;
    Channels channels_;
    Laws laws_;
};

}  // namespace hshfit::brdfs
