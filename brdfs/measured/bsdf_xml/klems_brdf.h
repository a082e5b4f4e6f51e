#pragma once

#include <brdfs/measured/bsdf_xml/angle_basis.h>
#include <brdfs/measured/bsdf_xml/document.h>
#include <brdfs/measured/bsdf_xml/selection.h>
#include <brdfs/measured/measured_brdf.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/brdf/steps.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Reflection or transmission in a matrix of patch pairs (Klems 1994): f is constant for wi in one
/// patch of the incident basis and wo in one of the outgoing basis. With (x, y) in the file's plane
/// (see BsdfSelection), the outgoing patch contains (x, y) of wo, and the incident patch (-x, -y)
/// of wi, the direction towards which the light goes: a mirror fills the diagonal, and so does a
/// clear pane, because wo of a transmission is mirrored at the surface.
///
/// Negative values are taken as 0, as in Radiance. So are NaN and infinite values, for which
/// checkIntact() throws InputError. f is 0 beyond a basis that ends above the
/// horizon. Laws are claimed where the matrix has them exactly; reciprocity, never of a
/// transmission.
class KlemsBrdf : public MeasuredBrdf, public HasKinkCurves, public HasSteps {
public:
    /// Throws InputError for unknown bases, matrices of wrong size, and words among the
    /// numbers.
    KlemsBrdf(const BsdfDocument& document, BsdfSelection selection);

    std::string name() const override { return selection_.name; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    /// The rings of the incident basis.
    std::vector<double> kinks(const Direction& wo) const override;
    /// The meridians between patches of the incident basis.
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override;
    std::vector<double> outgoingKinks(const Direction& wi) const override;
    std::vector<KinkCurve> outgoingKinkCurves(const Direction& wi) const override;
    int squareLevels() const override { return 0; }
    /// The patches, where both bases are the same and turning by 180 degrees keeps them.
    std::size_t cells() const override { return movable() ? incident_.patches() : 0; }
    std::size_t cellOf(const Direction& wi) const override { return incidentPatch(wi); }
    Direction cellCentre(std::size_t cell) const override;
    double defaultTolerance() const override { return selection_.tolerance; }
    std::vector<Fact> facts() const override;
    void checkIntact() const override { selection_.checkIntact(); }
    void checkReadable() const override {}
    Census census() const override { return census_; }
    std::vector<Axis> axes() const override;

    const AngleBasis& incident() const { return incident_; }
    const AngleBasis& outgoing() const { return outgoing_; }
    /// f for a pair of patches.
    double value(std::size_t channel, std::size_t incident, std::size_t outgoing) const {
        return values_[(channel * outgoing_.patches() + outgoing) * incident_.patches() + incident];
    }
    /// Directional-hemispherical reflectance of an incident patch as the file defines it: the sum
    /// over outgoing patches of f times projected solid angle.
    double directionalReflectance(std::size_t channel, std::size_t incident) const;
    /// Takes note of the reflection of light from the same side: conservation of energy is then
    /// about both together. False, and nothing changes, for a reflection over other cells or
    /// in other channels.
    bool addReflection(const KlemsBrdf& reflection);
    void addFact(Fact fact) { selection_.facts.push_back(std::move(fact)); }

private:
    std::vector<double> readMatrix(const BsdfDocument& document, const BsdfBlock& block);
    void readSpectrum(const BsdfDocument& document);
    void combineColours(std::vector<std::vector<double>> xyz);
    void findLaws();
    bool movable() const;
    std::vector<KinkCurve> meridians(const AngleBasis& basis) const;
    bool sameUnder(int sign, int turn, bool exchanged) const;
    bool dependsOnRingsOnly() const;
    std::size_t incidentPatch(const Direction& wi) const;
    std::size_t outgoingPatch(const Direction& wo) const;

    BsdfSelection selection_;
    AngleBasis incident_, outgoing_;
    Channels channels_;
    Laws laws_;
    Census census_;
    std::vector<double> values_;          ///< [channel][outgoing][incident]
    std::vector<unsigned char> missing_;  ///< [outgoing][incident]: NaN or infinite
    /// For a transmission: the largest sum with the reflection of the same patch, where it is
    /// known.
    std::optional<double> withReflection_;
};

}  // namespace hshfit::brdfs
