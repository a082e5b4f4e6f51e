#pragma once

#include <brdfs/measured/bsdf_xml/document.h>
#include <brdfs/measured/bsdf_xml/selection.h>
#include <brdfs/measured/bsdf_xml/tensor_tree.h>
#include <brdfs/measured/measured_brdf.h>
#include <hshfit/brdf/steps.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Reflection or transmission in a tensor tree over the squares of squareFromDisc, constant on each
/// leaf. With (x, y) in the file's plane (see BsdfSelection):
///     rank 4:  (u, v) of (-x, -y) of wi, (u, v) of (x, y) of wo;
///     rank 3:  (1 - sin(theta_i)) / 2, (u, v) of (x, y) of wo turned so that -wi has azimuth 0.
/// Half of the cube of rank 3 has no directions. A mirror lies on the diagonal of rank 4, and so
/// does a clear pane, wo of a transmission being mirrored at the surface.
///
/// Negative values are taken as 0, as in Radiance. So are NaN and infinite values, for which
/// checkIntact() throws InputError. With trees for CIE u' and v' the BRDF is RGB, with trees for
/// wavelengths spectral. Laws are claimed if the trees have them exactly. Rank 3 and
/// transmissions never claim reciprocity, and several trees never claim conservation of energy.
class TreeBrdf : public MeasuredBrdf, public HasSteps {
public:
    /// Throws InputError as TensorTree does.
    TreeBrdf(const BsdfDocument& document, BsdfSelection selection);

    std::string name() const override { return selection_.name; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    /// The brightest cells, if they are far above the average: quadrature could miss narrow ones.
    std::vector<Lobe> lobes(const Direction& wo) const override;
    std::vector<double> outgoingKinks(const Direction&) const override { return {}; }
    std::vector<KinkCurve> outgoingKinkCurves(const Direction&) const override { return {}; }
    int squareLevels() const override;
    /// The finest cells of the incident square; of rank 3 the rings.
    std::size_t cells() const override;
    std::size_t cellOf(const Direction& wi) const override;
    Direction cellCentre(std::size_t cell) const override;
    double defaultTolerance() const override { return selection_.tolerance; }
    std::vector<Fact> facts() const override;
    void checkIntact() const override { selection_.checkIntact(); }
    void checkReadable() const override {}
    Census census() const override { return census_; }
    std::vector<Axis> axes() const override;

    /// The tree of f, of luminance, or of the first wavelength.
    const TensorTree& tree() const { return trees_[0]; }
    /// Directional-hemispherical reflectances as the file defines them: pi times the average over
    /// the outgoing square, for each cell of the finest grid of incident coordinates, first
    /// coordinate fastest. Rank 3: from grazing (first) to normal incidence.
    std::vector<double> directionalReflectances() const;
    /// Takes note of the reflection of light from the same side: conservation of energy is then a
    /// law of both together. False, and nothing changes, for a reflection over other cells or in
    /// other channels.
    bool addReflection(const TreeBrdf& reflection);
    void addFact(Fact fact) { selection_.facts.push_back(std::move(fact)); }

private:
    TensorTree::Point pointFor(const Direction& wo, double x, double y) const;
    void addTree(const BsdfDocument& document, const BsdfBlock& block);
    void findLaws();

    BsdfSelection selection_;
    Channels channels_;
    Laws laws_;
    Census census_;
    std::vector<TensorTree> trees_;       ///< one, Y, u' and v', or one a wavelength
    std::vector<unsigned char> missing_;  ///< leaves of the first that are NaN or infinite
    /// For a transmission: the largest sum with the reflection of the same cell, where it is known.
    std::optional<double> withReflection_;
};

}  // namespace hshfit::brdfs
