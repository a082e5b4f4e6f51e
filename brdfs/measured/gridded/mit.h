#pragma once

#include <brdfs/measured/measured_brdf.h>
#include <brdfs/rows/format.h>
#include <hshfit/files/mapped_file.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>

namespace hshfit::brdfs {

/// The layout of a file of MIT's anisotropic BRDFs (Ngan, Durand & Matusik 2005, "Experimental
/// Analysis of BRDF Models", EGSR, 10.2312/EGWR/EGSR05/117-126; the header is described with the
/// data): int32[16], then three planes of float32, R, G, B, little-endian.
///     header[0..3]   bins in theta_in, theta_out, phi_diff, phi_in; the last varies fastest
///     header[6]      1: the standard parametrisation, these four angles
///     header[7]      0: uniform bins
///     header[9]      0: phi_diff from 0 to 2 pi; 1: from 0 to pi
///     header[10]     3 channels
/// theta from 0 to pi/2, phi_in from 0 to 2 pi. A negative value marks a bin without a measurement.
struct MitLayout {
    static constexpr std::size_t headerBytes = 64, mostBins = 4096;

    std::size_t thetaIn = 0, thetaOut = 0, phiDifference = 0, phiIn = 0;
    bool half = false;  ///< phi_diff up to pi only

    std::size_t cells() const { return thetaIn * thetaOut * phiDifference * phiIn; }
    std::size_t fileBytes() const { return headerBytes + 3 * cells() * sizeof(float); }
};

/// A measured anisotropic BRDF in such a file, read from the mapped bytes.
///
/// Assumptions where the description is silent: a value belongs to the centre of its bin, theta_in
/// and phi_in are angles of wi, phi_diff = phi_out - phi_in, and azimuths count from +x towards +y.
/// With header[9] = 1, f beyond phi_diff = pi is that with wi and wo exchanged. The values times
/// `scale` are f in 1/sr.
///
/// Interpolation is multilinear between the centres, over the valid bins among the sixteen, and
/// periodic in azimuth. It is constant within half a bin of theta = 0 and 90 deg, and of the ends
/// of a half phi_diff. Without a valid bin, f is 0 and not covered. NaN and infinite values are
/// taken as invalid, and checkIntact() throws InputError naming one that was read. No
/// symmetry is claimed.
class MitBrdf : public MeasuredBrdf {
public:
    /// `bytes` have to outlive it. Throws InputError if the header or the size are wrong.
    MitBrdf(std::span<const unsigned char> bytes, std::string name, double scale = 1);
    static std::unique_ptr<MitBrdf> open(const std::string& path, double scale = 1);

    std::string name() const override;
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    /// 3e-3: the interpolation has a kink at every node, and the measurements err by more.
    double defaultTolerance() const override { return 3e-3; }
    std::vector<Fact> facts() const override;
    Census census() const override;
    std::vector<Axis> axes() const override;
    void checkIntact() const override;
    void checkReadable() const override;

    const MitLayout& layout() const { return layout_; }

private:
    struct Corners;
    struct Outgoing;
    Outgoing outgoing(const Direction& wo) const;
    Corners corners(const Outgoing& wo, double theta, double phi) const;
    void prefetch(const Corners& at) const;
    double interpolate(const Corners& at, std::size_t channel) const;
    double averageOfValid(const Corners& at, std::size_t channel, double* weight) const;
    float raw(std::size_t channel, std::size_t cell) const {
        float value;
        const std::size_t index = channel * layout_.cells() + cell;
        std::memcpy(&value, bytes_.data() + MitLayout::headerBytes + index * sizeof value,
                    sizeof value);
        return value;
    }

    std::unique_ptr<MappedFile> file_;  ///< none if the caller owns the bytes
    std::span<const unsigned char> bytes_;
    std::string name_;
    MitLayout layout_;
    double scale_;
    Channels channels_ = Channels::rgb();
    Laws laws_{.nonNegative = true};
    mutable std::atomic<std::int64_t> corrupt_{-1};  ///< channel * cells + cell
};

/// The row of the table of formats.
const Format& mitFormat();

}  // namespace hshfit::brdfs
