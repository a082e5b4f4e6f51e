#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/normal_filtering/mip_layout.h>

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline normal_filtering {

/// A form of the averaged distribution of microfacet normals.
enum class MipForm {
    harmonics,  ///< spherical harmonics; for wide lobes, or normals of any distribution
    /// Normals as a Gaussian in the stereographic plane, of the measured mean and covariance,
    /// convolved with D's sum of Gaussians: LEAN mapping (Olano & Baker 2010; Dupuy et al. 2013) in
    /// a plane where a turned lobe keeps its shape.
    ellipse,
};

/// A way to evaluate a filtered texel.
struct MipUse {
    MipForm form = MipForm::ellipse;
    int order = 0;  ///< bands of the harmonics that are used, odd; 0: all
    /// Whether M is taken at the normals of the facets that reflect about h; otherwise once, at the
    /// mean normal, which costs a fourth and errs at grazing angles.
    bool facets = true;
};

/// The averaged reflectance of a mip texel, in the frame of the surface. f cos(theta_i) is the sum
/// of
///     specular  E[w D(h) M] = E[w D(h)] M averaged over `normalsGiven(h)`,
///     diffuse   E[albedo / pi  max(0, n.wi) [n.wo > 0]],
/// E the average over texels of the footprint.
class FilteredTexel {
public:
    /// `texel` has layout.size() numbers, or layout.ellipseSize() if harmonics are never asked for.
    /// The table has to outlive this object. `basis` spares making makeSh(layout.order) again.
    FilteredTexel(const MipLayout& layout, std::span<const double> texel, const LobeTable& table,
                  std::shared_ptr<const Basis> basis = nullptr);

    /// The direction of the mean normal; +z where normals cancel to less than 1e-6.
    const Direction& normal() const { return normal_; }
    /// 1 for equal normals, 0 for normals that cancel.
    double meanNormalLength() const { return length_; }
    const LobePlace& lobe() const { return lobe_; }

    /// E[w_k D(h)] for each weight k. Truncated harmonics below 0 count as 0, which brings them
    /// closer to the truth everywhere and adds energy.
    void density(const MipUse& use, const Direction& h, std::span<double> out) const;

    /// The normals of those facets that reflect about h: mean and covariance of n given h, for
    /// Gaussians, as four points of equal shares. Where normals or lobes are narrow, n = h or n =
    /// normal().
    std::array<Direction, 4> normalsGiven(const Direction& h) const;
    /// The x axis of D on average, as tangent at n: that along which it is wider, or narrower where
    /// the table has widthX < widthY.
    Direction tangentAt(const Direction& n) const;

    /// E[albedo max(0, n.wi) [n.wo > 0]] by channel, from n.wi and n.wo as Gaussian variables.
    void diffuse(const Direction& wi, const Direction& wo, std::span<double> out) const;

    /// Local directions to specular f cos(theta_i) by channel. `density` has E[w_k D(h)]; wi and wo
    /// are in the frame of a facet's normal, both above its horizon.
    using Rest =
        std::function<void(const FilteredTexel& texel, const Direction& wi, const Direction& wo,
                           std::span<const double> density, std::span<double> out)>;
    /// The diffuse part of a facet over albedo / pi, where it is not Lambert's: 1 - F, say. Of
    /// directions in the frame of the facet, both above its horizon.
    using Shape =
        std::function<double(const FilteredTexel& texel, const Direction& wi, const Direction& wo)>;
    /// f cos(theta_i) by channel, as many as `out` has: specular by `rest`, diffuse from albedos
    /// (one for all channels, or one each), times `shape` at the mean normal.
    void reflect(const MipUse& use, const Rest& rest, const Direction& wi, const Direction& wo,
                 std::span<double> out, const Shape& shape = {}) const;

private:
    /// E[D(h)] by the ellipse, and mean and covariance of the normals given h in the plane.
    struct Facets {
        double density, x, y, xx, xy, yy;
    };
    Facets facets(const Direction& h) const;
    std::array<double, 3> turnedWidths(double angle) const;

    MipLayout layout_;
    std::vector<double> numbers_;
    const LobeTable* table_;
    std::shared_ptr<const Basis> basis_;
    Direction normal_;
    double length_;
    LobePlace lobe_;
    std::array<double, 3> covariance_;  ///< of normals in the plane: xx, xy, yy
};

}  // namespace hshfit::inline normal_filtering
