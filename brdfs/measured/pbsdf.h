#pragma once

#include <brdfs/measured/measured_brdf.h>
#include <brdfs/measured/mueller.h>
#include <brdfs/rows/format.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// A measured polarimetric BRDF (Baek et al. 2020, "Image-Based Acquisition and Modeling of
/// Polarimetric Reflectance", ACM TOG 39(4)) in a tensor file (tensor_file.h): Mueller matrices
/// M[phi_d][theta_d][theta_h][wavelength][4][4], f32, and the nodes phi_d, theta_d, theta_h (f32,
/// radians, 1 x n) and wvls (u16, nm). The reader uses M00, the reflectance of unpolarised light in
/// 1/sr, or others (MuellerElements), whose Stokes vectors have the axes of the file. It is
/// isotropic and spectral.
///
/// theta_h, theta_d and phi_d are Rusinkiewicz's angles, with wi towards the light and phi_d =
/// 0 where wi leans away from the normal. f is linear in the angles between the nodes and
/// constant beyond. Files with empty angles (shape 0 x n) are read as evenly spaced: theta from
/// 0 to 90, phi_d from -180 to 180 degrees. Interpolation leaves out nodes that lack one of the
/// elements that are read, or whose M00 is 0 as in cells below the horizon; without any of the
/// eight nodes f is 0. Negative values of M00 become 0. The degree of polarisation follows from
/// interpolated elements. Reciprocity does not hold in measured files.
class PbsdfBrdf : public MeasuredBrdf {
public:
    /// `name` is the path of the file. Throws InputError naming field and offset.
    PbsdfBrdf(std::span<const unsigned char> bytes, std::string name,
              MuellerElements elements = MuellerElements());
    static std::unique_ptr<PbsdfBrdf> open(const std::string& path,
                                           MuellerElements elements = MuellerElements());

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    /// Covered where one of the eight nodes has a value.
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    /// 3e-3: the interpolation has kinks, and the measurements err by more.
    double defaultTolerance() const override { return 3e-3; }
    std::vector<Fact> facts() const override;
    Census census() const override;
    std::vector<Axis> axes() const override;

private:
    struct Corners;
    Corners corners(const Direction& wo, const Direction& wi) const;
    std::size_t vertex(std::size_t p, std::size_t d, std::size_t h) const;
    bool hasValue(std::size_t vertex) const;
    /// The sum of the matrices at some nodes, by weight.
    MuellerElements::Matrix matrixAt(const Corners& corners, std::size_t wavelength) const;
    void addNode(std::size_t vertex, Census& census) const;
    /// The places of `elements_`, after M00 where that is not among them.
    std::size_t planes() const { return places_.size(); }
    std::size_t wavelengths() const { return channels_.wavelengths.size(); }
    const float* at(std::size_t vertex, std::size_t wavelength) const {
        return values_.data() + (vertex * wavelengths() + wavelength) * planes();
    }

    std::string name_;
    MuellerElements elements_;
    std::vector<std::size_t> places_;
    Channels channels_;
    Laws laws_;
    std::vector<double> phiDifference_, thetaDifference_, thetaHalf_;  ///< ascending, radians
    bool anglesAssumed_ = false;
    std::vector<float> values_;  ///< [phi_d][theta_d][theta_h][wavelength][plane]
};

/// The row of the table of formats.
const Format& pbsdfFormat();

}  // namespace hshfit::brdfs
