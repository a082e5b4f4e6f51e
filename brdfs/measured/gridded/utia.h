#pragma once

#include <brdfs/measured/measured_brdf.h>
#include <brdfs/rows/format.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

struct UtiaOptions {
    /// f between 75 deg, the last node, and the horizon. linear: extrapolated from the last two
    /// nodes, as in the database's own programs. constant: the value at 75 deg.
    enum class Beyond { linear, constant };
    /// The colour space of the three planes: linear Rec. 709, the same with the sRGB curve, or CIE
    /// XYZ (D65).
    enum class Colours { rgb, srgb, xyz };
    Beyond beyond = Beyond::linear;
    Colours colours = Colours::rgb;
    double scale = 1;  ///< f in 1/sr = scale x decoded value
};

/// An anisotropic BRDF of the UTIA database (Filip & Vavra 2014, "Template-Based Sampling of
/// Anisotropic BRDFs", CGF 33(7), 10.1111/cgf.12477): 6 x 48 x 6 x 48 nodes in RGB, with
///     theta = 0, 15, … 75 deg,    phi = 0, 7.5, … 352.5 deg
/// for the illumination (wi) and the view (wo): value (i, v) of a plane is at 288 i + v, where
/// i = 48 (theta_i / 15) + phi_i / 7.5, and v likewise. `.bin`: three planes of float64,
/// little-endian; `.exr`: 288 x 288 pixels, row i, column v, channels R, G, B.
///
/// Interpolation is multilinear in the four angles and periodic in azimuth; negative results become
/// 0. The 48 values for the one direction at theta = 0 are replaced by their mean, which makes f
/// single-valued at the normal. A NaN is replaced by the value at the nearest azimuth of view that
/// has one, and checkIntact() throws InputError naming the first. Directions past 75 deg are not
/// covered. The table is copied, so that the file is not needed later. No symmetry is claimed.
class UtiaBrdf : public MeasuredBrdf {
public:
    static constexpr std::size_t thetas = 6, phis = 48, nodes = thetas * phis;
    static constexpr std::size_t values = 3 * nodes * nodes;
    static constexpr std::size_t fileBytes = values * sizeof(double);

    /// `bytes` of a file of either form; `name` is its path. Throws InputError for other contents.
    UtiaBrdf(std::span<const unsigned char> bytes, std::string name, const UtiaOptions& options);
    static std::unique_ptr<UtiaBrdf> open(const std::string& path, const UtiaOptions& options);

    std::string name() const override;
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    std::vector<double> kinks(const Direction& wo) const override;  ///< the rings of the nodes
    /// 3e-3: the interpolation has a kink at every node, and the measurements err by more.
    double defaultTolerance() const override { return 3e-3; }
    std::vector<Fact> facts() const override;
    Census census() const override { return census_; }
    std::vector<Axis> axes() const override;
    void checkIntact() const override;
    void checkReadable() const override {}

private:
    struct Place;
    struct Value {
        double rgb[4];  ///< the fourth is 0: a whole number of vector registers
    };
    Place place(double theta, double phi) const;
    Value seenFrom(const Place& wo, std::size_t node) const;

    void takeStock(const std::vector<double>& stored);
    void fillMissing(std::vector<double>& stored) const;
    void decode(std::vector<double>& stored) const;
    void averageAtNormal();
    std::uint64_t negativeBeyond() const;

    std::string name_;
    UtiaOptions options_;
    bool picture_ = false;
    std::vector<Value> table_;  ///< [wi node][wo node]
    Census census_;
    std::ptrdiff_t firstBad_ = -1;  ///< index of the first value that is no number
    double poleSpread_ = 0;
    Channels channels_ = Channels::rgb();
    Laws laws_{.nonNegative = true};
};

/// The row of the table of formats.
const Format& utiaFormat();

}  // namespace hshfit::brdfs
