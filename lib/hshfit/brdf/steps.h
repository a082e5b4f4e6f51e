#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/brdf/kink_curve.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline brdf {

/// A BRDF with steps: a table that is read without interpolation, or one made of such tables.
/// Quadrature that did not know the steps could miss a whole cell at several levels in a row.
class HasSteps {
public:
    /// Kinks over wo for one wi; Brdf::kinks and HasKinkCurves::kinkCurves have the kinks over wi
    /// for one wo.
    virtual std::vector<double> outgoingKinks(const Direction& wi) const = 0;
    virtual std::vector<KinkCurve> outgoingKinkCurves(const Direction& wi) const = 0;

    /// n > 0: over wi for a wo, and over wo for a wi, no cell is narrower than the cells of a grid
    /// of 2^n by 2^n on the square of `directionFromSquare`. 0: kinks and curves name all steps.
    virtual int squareLevels() const = 0;

    /// The number of cells of wi: for every wo, f is constant within a cell. The cells of wo have
    /// the same borders. 0 where such cells are not known.
    virtual std::size_t cells() const { return 0; }
    virtual std::size_t cellOf(const Direction&) const { return 0; }
    virtual Direction cellCentre(std::size_t) const { return {0, 0, 1}; }

protected:
    ~HasSteps() = default;
};

/// The kinks of a BRDF that does not say: the ones over wi with the roles exchanged, which are
/// right for a reciprocal BRDF.
std::vector<double> outgoingKinksOf(const Brdf& brdf, const Direction& wi);
std::vector<KinkCurve> outgoingKinkCurvesOf(const Brdf& brdf, const Direction& wi);
/// 0 for a BRDF that does not say.
int squareLevelsOf(const Brdf& brdf);

/// A point of the unit square.
struct SquarePoint {
    double u = 0, v = 0;
};

/// The square onto the hemisphere by the concentric map of Shirley & Chiu, "A Low Distortion Map
/// Between Disk and Square", J. Graphics Tools 2(3), 1997, taken as (x, y) of a unit vector: equal
/// areas of the square are equal projected solid angles, cos(theta) d omega = pi du dv.
Direction directionFromSquare(const SquarePoint& point);

/// g(wi, wo) = f(wo, wi): integrals over wi for a wo become integrals over wo for a wi. It refers
/// to `brdf`, which has to outlive it.
class Exchanged final : public Brdf, public HasKinkCurves, public HasSteps {
public:
    explicit Exchanged(const Brdf& brdf) : brdf_(brdf) {}

    std::string name() const override { return brdf_.name(); }
    const Channels& channels() const override { return brdf_.channels(); }
    const Laws& laws() const override { return brdf_.laws(); }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    std::vector<Lobe> lobes(const Direction& wo) const override;
    std::vector<double> kinks(const Direction& wo) const override {
        return outgoingKinksOf(brdf_, wo);
    }
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return outgoingKinkCurvesOf(brdf_, wo);
    }
    std::vector<double> outgoingKinks(const Direction& wi) const override {
        return brdf_.kinks(wi);
    }
    std::vector<KinkCurve> outgoingKinkCurves(const Direction& wi) const override {
        return kinkCurvesOf(brdf_, wi);
    }
    int squareLevels() const override { return squareLevelsOf(brdf_); }
    double defaultTolerance() const override { return brdf_.defaultTolerance(); }
    void checkIntact() const override { brdf_.checkIntact(); }

private:
    const Brdf& brdf_;
};

}  // namespace hshfit::inline brdf
