#pragma once

#include <brdfs/rows/writer.h>

#include <string>
#include <vector>

namespace hshfit::brdfs {

struct SliceOptions {
    std::size_t size = 512;  ///< pixels a side
    /// theta_h is 90 x^2 deg for x from 0 to 1, as in a MERL table, instead of 90 x, which
    /// gives lobes of glossy materials more pixels.
    bool rootHalf = false;
    bool halfPixels = false;  ///< 16-bit floats: half the size, 11 significant bits, at most 65504
    /// The number of phi_d: 90 deg and further ones, evenly spaced over 180 deg (360 for a BRDF
    /// that does not claim reciprocity).
    std::size_t slices = 1;
    double phiHalf = 0;  ///< degrees; matters for an anisotropic BRDF only
};

/// Writes slices of a BRDF as an OpenEXR picture of the form that readSlicePicture (slice.h)
/// describes: over theta_h and theta_d as in Burley 2012, f in 1/sr, channels R, G, B or Y or
/// wavelengths, further phi_d in layers. Attributes `hshfit:…` name the axes. Returns a sentence
/// for each loss. Throws NumericError where f is negative, not finite or too large for the pixels,
/// OutputError if the file cannot be written or exists and may not be replaced, UsageError for
/// more than 2^26 values.
std::vector<std::string> writeSlices(const Brdf& brdf, const std::string& path,
                                     const SliceOptions& slices, const WriteOptions& options);

/// The row of the table of writers.
const Writer& slicesWriter();

}  // namespace hshfit::brdfs
