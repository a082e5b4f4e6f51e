#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/brdf/steps.h>

#include <memory>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// A grey BRDF for each of several wavelengths, as one spectral BRDF: channel c is f of line c.
///   laws, coverage   what all lines keep; where all are covered
///   lobes, kinks     of all lines, equal ones once; the tolerance is the largest of all lines'
/// Lines are by ascending wavelengths in nm; `name` opens the BRDF again (a path).
class Spectrum final : public Brdf, public HasKinkCurves, public HasSteps {
public:
    struct Line {
        double wavelength = 0;
        std::unique_ptr<Brdf> brdf;  ///< grey
    };
    Spectrum(std::vector<Line> lines, std::string name);

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    std::vector<Lobe> lobes(const Direction& wo) const override;
    std::vector<double> kinks(const Direction& wo) const override;
    /// The first line's kinks: the models of a fit have the same at every wavelength.
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override;
    std::vector<double> outgoingKinks(const Direction& wi) const override;
    std::vector<KinkCurve> outgoingKinkCurves(const Direction& wi) const override;
    int squareLevels() const override;
    double defaultTolerance() const override;
    /// The model of each wavelength: "550nm".
    std::vector<Fact> facts() const override;
    void checkIntact() const override;

private:
    std::vector<Line> lines_;
    std::string name_;
    Channels channels_;
    Laws laws_;
};

}  // namespace hshfit::brdfs
