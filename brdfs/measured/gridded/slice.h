#pragma once

#include <brdfs/measured/measured_brdf.h>
#include <brdfs/measured/own_samples.h>
#include <brdfs/rows/format.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The nodes of slices in half and difference angles (Rusinkiewicz 1998). Node i of n
/// is at x = (i + shift) / n, where
///     theta_h = 90 x deg, or 90 x^2 deg if `rootHalf`,     theta_d = 90 x deg.
struct SliceLayout {
    std::size_t halfCount = 0, differenceCount = 0;
    bool rootHalf = false;
    double shift = 0.5;       ///< 0: a value holds at the start of its bin
    std::vector<double> phi;  ///< phi_d in degrees, ascending, from 0 to below `period`
    double period = 180;      ///< 180, or 360 without reciprocity
    bool stated = true;       ///< whether the file says that it holds slices

    double thetaHalf(double i) const;        ///< radians
    double thetaDifference(double i) const;  ///< radians
    std::size_t nodes() const { return phi.size() * differenceCount * halfCount; }
};

/// An isotropic BRDF from slices of constant phi_d: one at phi_d = 90 deg, which is the plane of
/// the figures of Burley 2012 ("Physically Based Shading at Disney", SIGGRAPH course), or several.
/// A single slice holds for every phi_d; between several, f is linear in phi_d, which is periodic.
/// f is linear in the indices of theta_h and theta_d, and constant beyond the first and last nodes.
///
/// Negative values, NaN, and nodes with a direction below the horizon are invalid.
/// Interpolation leaves them out, and f is 0 without a valid node. checkIntact() throws
/// InputError naming the first NaN. Directions with valid nodes around them are covered; a
/// single slice covers only pairs within half a degree of its difference azimuth.
class SliceBrdf : public MeasuredBrdf, public HasCells {
public:
    /// `stored`: [phi][theta_d][theta_h][channel]. `kind`: the format's name, for info.
    SliceBrdf(SliceLayout layout, Channels channels, std::vector<float> stored, std::string name,
              std::string kind);

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    /// One lobe about the half vector. Its width follows from the theta_h at which f of the slice
    /// nearest
    /// phi_d = 90 deg, at theta_d = theta_o, is midway between its first and its least value.
    std::vector<Lobe> lobes(const Direction& wo) const override;
    /// 3e-3: the interpolation has a kink at every node, and the measurements err by more.
    double defaultTolerance() const override { return 3e-3; }
    std::vector<Fact> facts() const override;
    Census census() const override { return census_; }
    std::vector<Axis> axes() const override;
    void checkIntact() const override;
    void checkReadable() const override {}
    void giveCells(CellReceiver& receiver) const override;
    /// No: cells of a few slices are no sample of all pairs, while f holds for all of them.
    bool cellsAreDefault() const override { return false; }
    bool holdsBeyondCoverage() const override { return true; }

    const SliceLayout& layout() const { return layout_; }

private:
    struct Corners;
    Corners corners(double thetaHalf, double thetaDifference, double phi) const;
    double interpolate(const Corners& at, std::size_t channel, double* weight) const;
    void takeStock();

    SliceLayout layout_;
    Channels channels_;
    std::vector<float> values_;  ///< -1 where invalid
    std::string name_, kind_;
    Laws laws_{.nonNegative = true, .isotropic = true};
    Census census_;
    std::string damage_;  ///< message of checkIntact()
};

/// A `.slice` file of exactly 97,200 bytes: float32 [theta_d 90][theta_h 90][R, G, B], the cells of
/// a MERL table (merl_layout.h) at phi_d = 90 deg, in 1/sr, little-endian.
std::unique_ptr<SliceBrdf> readMerlSlice(std::span<const unsigned char> bytes,
                                         const std::string& name);

/// A picture with theta_h from 0 deg at the left to 90 at the right and theta_d from 0 at the
/// bottom to 90 at the top. A value is f in 1/sr at the centre of its pixel. Channels R, G, B
/// or Y or wavelengths ("550nm") for phi_d = 90 deg. Files of slice_writer.h carry attributes that
/// name the axes, have further slices in layers ("phi045.R") and may have 90 x^2 for theta_h;
/// pictures without the attributes are read as above. Both functions throw InputError for other
/// contents.
std::unique_ptr<SliceBrdf> readSlicePicture(std::span<const unsigned char> bytes,
                                            const std::string& name);

/// "phi045", "phi022,5": the layer of a slice, phi in degrees.
std::string sliceLayerName(double phi);

/// Rows of the table of formats.
const Format& merlSliceFormat();
const Format& slicesFormat();

}  // namespace hshfit::brdfs
