#pragma once

#include <hshfit/brdf/brdf.h>

#include <string>
#include <vector>

namespace hshfit::brdfs {

enum class GaussianKind {
    /// a exp(lambda (w.p - 1)): Wang, Ren, Gong, Snyder & Guo 2009, 10.1145/1618452.1618479
    spherical,
    /// a max(w.p, 0) exp(-lambda (w.x)^2 - mu (w.y)^2): Xu et al. 2013, 10.1145/2508363.2508386;
    /// its sharpness about p is 2 lambda and 2 mu in terms of the spherical ones
    anisotropic,
};

/// One lobe about an axis p in the plane of incidence; x lies in that plane, y across it.
struct GaussianLobe {
    double tilt = 0;  ///< of p from the mirror direction, radians; positive towards the horizon
    double sharpness = 1;                ///< lambda
    double across = 1;                   ///< mu; only anisotropic
    std::vector<double> amplitude = {};  ///< 1/sr, per channel
};

/// Value and derivatives of a lobe of amplitude 1, for wo in the plane xz at -x (so that the mirror
/// direction, at `theta` from the normal, is on the side of +x).
struct GaussianValue {
    double value = 0, byTilt = 0, byLogSharpness = 0, byLogAcross = 0;
};
GaussianValue evaluateLobe(GaussianKind kind, const GaussianLobe& lobe, double theta,
                           const Direction& wi);

/// Lobes for one elevation of wo, and how well they fit there.
struct GaussianElevation {
    double theta = 0;  ///< of wo, radians
    std::vector<GaussianLobe> lobes = {};
    double error = 0;  ///< root of the ratio of weighted integrals, (f - g)^2 to f^2
    double albedo = 0, fittedAlbedo = 0;  ///< of f and of g, channels averaged
    bool converged = false;
};

/// f(wi, wo) as a sum of Gaussians of wi about the mirror direction, for elevations of wo that
/// ascend. Between two of them, both mixtures are turned to the mirror direction and mixed linearly
/// in theta; outside of them the nearest holds. Isotropic and non-negative, not reciprocal.
class GaussianMixture final : public Brdf {
public:
    struct Content {
        std::string name;    ///< a specification, or a path
        std::string source;  ///< what it was fitted to
        GaussianKind kind = GaussianKind::spherical;
        Channels channels = {};
        std::vector<GaussianElevation> elevations = {};
    };
    explicit GaussianMixture(Content content) : content_(std::move(content)) {}

    const Content& content() const { return content_; }
    std::string name() const override { return content_.name; }
    const Channels& channels() const override { return content_.channels; }
    const Laws& laws() const override;
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    std::vector<Lobe> lobes(const Direction& wo) const override;
    std::vector<Fact> facts() const override;

private:
    Content content_;
};

}  // namespace hshfit::brdfs
