#pragma once

#include <hshfit/brdf/directions.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::bases {

/// Slot of (l, m) in a coefficient vector: l(l+1) + m. Every basis uses it, with zeros in the
/// slots of functions that it does not have.
constexpr int slotOf(int l, int m) {
    return l * (l + 1) + m;
}

struct BasisOptions {
    /// Multiply functions of odd m by -1, as both source papers do.
    bool condonShortley = false;
};

/// Real functions on the hemisphere (or sphere) in separable form
///     B_{l,m}(theta, phi) = T_l^{|m|}(theta) az_m(phi),     0 <= l < order, |m| <= l,
/// with az_m = 1/sqrt(2 pi), cos(m phi)/sqrt(pi), sin(|m| phi)/sqrt(pi) for m = 0, > 0, < 0.
/// Immutable; safe to use from many threads.
class Basis {
public:
    /// The inner product in which the functions are orthonormal, and energies are measured.
    enum class Inner {
        solidAngle,           ///< integral over the hemisphere, d omega
        projectedSolidAngle,  ///< integral over the hemisphere, cos(theta) d omega
    };

    virtual ~Basis() = default;

    virtual std::string name() const = 0;
    int order() const { return order_; }
    int slots() const { return order_ * order_; }
    bool condonShortley() const { return options_.condonShortley; }
    virtual Inner inner() const { return Inner::solidAngle; }

    /// Whether (l, m) can be non-zero in this basis; ESH and Zernike skip every other one.
    virtual bool has(int l, int m) const;
    /// Number of functions that this basis has in bands 0 .. order-1.
    int functionCount(int order) const;

    /// Theta parts T_l^m, l = m .. order-1, for one m >= 0 at `points.size()` elevations:
    /// out[(l - m) * points.size() + p]. Functions that the basis lacks are written as 0.
    /// Values below the smallest normal number are flushed to 0; there is no overflow.
    virtual void theta(int m, std::span<const Elevation<double>> points, double* out) const = 0;
    virtual void theta(int m, std::span<const Elevation<float>> points, float* out) const = 0;

    /// The functions that f is integrated against, laid out as for `theta`. They are the basis
    /// functions themselves, except for a basis that solves a Gram system (LSOSH), which uses an
    /// orthonormal set that spans the same space band by band.
    virtual void analysisTheta(int m, std::span<const Elevation<double>> points, double* out) const;

    /// Coefficients of this basis truncated to `order` bands (order^2 values to `out`) from the
    /// moments <f, analysis function>, given in slots; a prefix copy unless a Gram system is
    /// solved.
    virtual void coefficientsFromMoments(const double* moments, int order, double* out) const;

    /// Squared norm of the projection of f onto the first `order` bands: the sum of the squared
    /// moments, less the part that a truncated Gram solve drops.
    virtual double capturedEnergy(const double* moments, int order) const;

    /// The position of slot i at direction k in a batch.
    enum class Layout {
        byDirection,  ///< out[k * slots() + i]
        bySlot,       ///< out[i * directions.count + k]
    };
    /// All functions at many directions. The values of a direction depend neither on its place in
    /// the batch nor on the batch's size. Float: single precision throughout.
    virtual void tabulate(DirectionBatch directions, Layout layout, double* out) const;
    virtual void tabulate(DirectionBatch directions, Layout layout, float* out) const;

    /// All functions at one direction: out[slotOf(l, m)], `slots()` values.
    void evaluate(const Direction& d, double* out) const {
        tabulate({&d.x, &d.y, &d.z, 1}, Layout::byDirection, out);
    }
    /// All functions at many directions: out[k * slots() + slotOf(l, m)].
    void evaluate(DirectionBatch directions, double* out) const {
        tabulate(directions, Layout::byDirection, out);
    }
    void evaluate(DirectionBatch directions, float* out) const {
        tabulate(directions, Layout::byDirection, out);
    }
    /// Function by function: out[slotOf(l, m) * directions.count + k].
    void evaluateColumns(DirectionBatch directions, double* out) const {
        tabulate(directions, Layout::bySlot, out);
    }
    void evaluateColumns(DirectionBatch directions, float* out) const {
        tabulate(directions, Layout::bySlot, out);
    }

protected:
    Basis(int order, BasisOptions options) : order_(order), options_(options) {}

private:
    int order_;
    BasisOptions options_;
};

/// Azimuth parts at the azimuth of `d`: out[order - 1 + m] = az_m for |m| < order, with the
/// Condon-Shortley sign if asked. At the pole phi = 0.
void azimuthParts(const Direction& d, int order, bool condonShortley, double* out);
/// (-1)^m with the Condon-Shortley phase, else 1.
double azimuthSign(int m, bool condonShortley);

}  // namespace hshfit::bases

namespace hshfit {
using bases::azimuthParts;
using bases::azimuthSign;
using bases::Basis;
using bases::BasisOptions;
using bases::slotOf;
}  // namespace hshfit
