#pragma once

#include <brdfs/measured/rgl_normals.h>
#include <brdfs/rows/writer.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The resolution of an RGL file. These are the defaults, unless the source is an RGL file and only
/// wavelengths are chosen: then the source's resolution is the default.
struct RglResolution {
    std::size_t theta = 32;     ///< incident elevations
    std::size_t phi = 9;        ///< incident azimuths of a quarter circle; isotropic: 1
    std::size_t slice = 96;     ///< colours per side of the square, per incident direction
    std::size_t normals = 128;  ///< normals per side of their square
    /// The share of a Lambertian distribution in the distribution of normals.
    double floor = 0.05;
    /// The share of an even distribution in the normals seen from an incident direction.
    double share = 0.5;
    /// None: retro-reflection, or the average if that fits the BRDF better, or uniform if the
    /// BRDF gives no distribution.
    std::optional<NormalsFrom> from = {};
    bool wholeCircle = false;  ///< azimuths all around, of mirror-symmetric BRDFs too
};

/// f sampled at the vertices of the RGL layout (rgl.h), so that the layout evaluates to f there.
/// Incident elevations are at 89 (k / (n - 1))^0.6 degrees. Vertices without an outgoing direction
/// hold a linear continuation of f cos(theta_o) below the horizon, negative where f is finite
/// at it, so that interpolated values reach 0 at the horizon and not within a cell above it. An
/// anisotropic BRDF has the whole circle of azimuths, or a quarter if it is mirror symmetric.
///
/// Throws NumericError where a value is not finite or overflows a float.
RglTables sampleRgl(const Brdf& brdf, const RglResolution& resolution, const WriteOptions& options,
                    std::vector<std::string>& alterations);

/// Writes tables as an RGL `.bsdf` file, with the luminance by which renderers sample.
/// Throws OutputError.
void writeRglTables(const RglTables& tables, const std::string& path, const WriteOptions& options);

/// The row of the table of writers.
const Writer& rglWriter();

}  // namespace hshfit::brdfs
