#pragma once

#include <brdfs/measured/measured_brdf.h>
#include <brdfs/measured/rgl_tables.h>
#include <brdfs/rows/format.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/files/tensor_file.h>

#include <memory>
#include <span>
#include <string>

namespace hshfit::brdfs {

/// The contents of an RGL file, checked.
struct RglTables {
    std::string description;
    IncidentGrid incident;
    /// The number of times that the measured azimuths cover the circle by symmetry: 0 isotropic,
    /// 1 all measured, 2 half of them (turned by 180 deg), 4 a quarter (mirrored at both axes).
    int reduction = 0;
    /// Whether f depends on the azimuth difference alone: `reduction` is 0 and no table, sigma
    /// among them, varies with phi_i.
    bool isotropic = false;
    bool jacobian = true;  ///< false: the values are f cos already, without ndf and sigma
    Plane ndf, sigma;
    std::unique_ptr<VisibleNormals> normals;
    Spectra spectra;
    Channels channels;

    /// Throws InputError naming the field and its offset.
    static RglTables load(const TensorFile& file);

    /// Takes out two defects of files that pictures show (docs/reference/measured.md): detail of
    /// ndf that is finer than the vertices of the colours, which these cannot make up for in
    /// between (ln ndf is smoothed along elevation, and f stays at every vertex), and, for
    /// isotropic materials, the azimuths of the slice at the normal, of which the mean is taken.
    void smooth();

    /// The meaning of a vertex of a colour slice: f(wi, wo) wo.z = value * factor. A value with
    /// wo below the horizon only takes part in the interpolation.
    struct Node {
        Direction wi, wo;
        double u = 0, v = 0;  ///< of the half vector
        double factor = 1;
    };
    Node node(std::size_t slice, std::size_t row, std::size_t column) const;
    /// The factor of a node with these directions; wi is the incident direction of the slice.
    double factor(std::size_t slice, const Direction& wi, const Direction& wo) const;
    double factorAt(double u, double v, double thetaIncident, double phiIncident) const;
};

/// The tables of a file as Dupuy & Jakob evaluate them, or after RglTables::smooth.
enum class RglReading { published, smooth };

/// A measured BRDF in an RGL `.bsdf` file (see rgl_tables.h and tensor_file.h). With h the half
/// vector, u(theta) = sqrt(2 theta / pi), v(phi) = phi / 2 pi + 1/2, and phi_h - phi_i in place of
/// phi_h for isotropic materials:
///     f(wi, wo) cos(theta_o) = spectra_wi(x, y) ndf(h) / (4 sigma(wi)),
///     (x, y) = P_wi(u(theta_h), v(phi_h)),      P: cumulative distribution of visible normals.
/// wi is the direction that the file calls incident. eval divides by max(cos(theta_o), 1e-9).
/// Values are finite, but grow without bound as wo nears the horizon, where the tables do not
/// fall to 0. Negative colours (outside of Rec. 709) become 0 after interpolation. The tables
/// are copied, so that the file is not needed later.
///
/// Reciprocity is not enforced and does not hold: f(wi, wo) and f(wo, wi) were measured
/// independently.
class RglBrdf : public MeasuredBrdf {
public:
    /// `name` is the path of the file; name() adds a reading other than the published one to it.
    /// Throws InputError for invalid bytes.
    RglBrdf(std::span<const unsigned char> bytes, std::string name,
            RglReading reading = RglReading::published);
    static std::unique_ptr<RglBrdf> open(const std::string& path,
                                         RglReading reading = RglReading::published);

    std::string name() const override { return name_; }
    const Channels& channels() const override { return tables_.channels; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    /// eval without vector instructions chosen at run time: the reference for RGB, and the path of
    /// eval for spectra.
    void evalScalar(const Direction& wo, DirectionBatch wi, double* out) const;

    /// Incident directions between the file's first and last are covered; beyond them f is
    /// constant in wi. The files do not reliably mark the vertices that were measured.
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;

    /// One lobe about the half vector, as wide as the distribution of normals.
    std::vector<Lobe> lobes(const Direction& wo) const override;
    /// 3e-3: the interpolation has kinks, and the measurements err by more.
    double defaultTolerance() const override { return 3e-3; }
    std::vector<Fact> facts() const override;
    /// A cell is a vertex of a colour slice; f there is its value times factor / cos(theta_o).
    Census census() const override;
    std::vector<Axis> axes() const override;

    const RglTables& tables() const { return tables_; }

private:
    struct Block;
    void evalAt(const Block& block, std::size_t k, double cosine, double* out,
                std::size_t stride) const;

    std::string name_;
    RglTables tables_;
    Laws laws_;
    double lobeWidth_ = 1;
};

/// The row of the table of formats.
const Format& rglFormat();

}  // namespace hshfit::brdfs
