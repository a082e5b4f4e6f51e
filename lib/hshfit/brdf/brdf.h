#pragma once

// `Brdf::eval` is f in 1/sr, never f cos(theta).

#include <hshfit/brdf/channels.h>
#include <hshfit/brdf/directions.h>

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace hshfit::inline brdf {

/// The laws that a BRDF promises to keep. Tests hold every catalog entry to its promises, and the
/// projector skips work by isotropy and mirror symmetry.
struct Laws {
    bool nonNegative = false;
    bool reciprocal = false;        ///< f(wi, wo) = f(wo, wi)
    bool isotropic = false;         ///< unchanged when both directions turn about the normal
    bool mirrorSymmetric = false;   ///< unchanged when both directions are mirrored at the xz plane
                                    ///< or both at the yz plane
    bool energyConserving = false;  ///< integral of f cos(theta_o) over wo at most 1 for every wi
};

/// A hint for placing quadrature nodes: where f peaks for a given wo, and how fast it varies there.
struct Lobe {
    enum class About {
        axis,     ///< depends on the angle between wi and `axis`
        halfway,  ///< depends on the slope of the half vector against the normal (microfacets)
    };
    About about = About::axis;
    /// Distance, in radians of that angle (or in units of slope), from the peak to the nearest
    /// point off the real axis where f stops being smooth: alpha for GGX; 2.5 standard deviations
    /// for a Gaussian, whose trapezoid sums converge faster. Smaller costs more nodes.
    double width = 1;
    Direction axis = {};  ///< for About::halfway with a spread, x or y: where it is wider
    /// The width along the axis on which the lobe is wider, for an anisotropic half-vector lobe; 0:
    /// as `width`.
    double spread = 0;
};

/// One line of `info`: a name in snake_case and its value.
using Fact = std::pair<std::string, std::variant<std::string, double, std::int64_t, bool>>;

/// A bidirectional reflectance distribution function, analytic or measured.
/// Implementations are immutable and may be evaluated from many threads at once.
class Brdf {
public:
    virtual ~Brdf() = default;

    /// The canonical specification, which opens the same BRDF again.
    virtual std::string name() const = 0;
    virtual const Channels& channels() const = 0;
    virtual const Laws& laws() const = 0;

    /// f(wi, wo) in 1/sr for one outgoing and `wi.count` incoming directions.
    /// out[c * wi.count + k] for channel c and direction k. Domain: unit vectors; f is 0 where
    /// wi.z <= 0 or wo.z <= 0. Must not throw for any pair of unit vectors.
    virtual void eval(const Direction& wo, DirectionBatch wi, double* out) const = 0;

    /// covered[k] = 1 where f rests on measured samples, 0 where it was continued beyond them or is
    /// absent. A model covers every pair of directions above the horizon.
    virtual void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const;

    /// The peaks of f as a function of wi. None for a BRDF as smooth as Lambert's.
    virtual std::vector<Lobe> lobes(const Direction& wo) const;

    /// Heights cos(theta_i) of rings on which f has a kink for this wo, such as max(cos theta_i,
    /// cos theta_o): quadrature puts panel ends there.
    virtual std::vector<double> kinks(const Direction& wo) const;

    /// The relative quadrature tolerance to ask for by default. Interpolated tables have kinks in
    /// their values, and far larger measurement errors, so that 1e-6 would not improve them.
    virtual double defaultTolerance() const { return 1e-6; }

    /// Further lines of `info` about this BRDF: dimensions, invalid cells, provenance, ….
    virtual std::vector<Fact> facts() const { return {}; }

    /// Throws InputError if the data behind this BRDF was lost since it was opened
    /// (a mapped file that shrank). Called after the last evaluation of a job.
    virtual void checkIntact() const {}
};

/// f for a single pair, one value per channel.
std::vector<double> evaluate(const Brdf& brdf, const Direction& wi, const Direction& wo);

}  // namespace hshfit::inline brdf
