#include <brdfs/measured/merl_layout.h>
#include <brdfs/measured/merl_writer.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <fmt/core.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::brdfs {
namespace {

void checkRepresentable(const Brdf& brdf) {
    requireReflection(brdf, "merl");
    if (!brdf.laws().isotropic) {
        throw UsageError(brdf.name() + ": is anisotropic; a MERL file holds isotropic BRDFs only");
    }
    if (brdf.channels().kind == Channels::Kind::spectral) {
        throw UsageError(
            fmt::format("{}: is spectral ({} wavelengths); a MERL file holds red, "
                        "green and blue only",
                        brdf.name(), brdf.channels().count()));
    }
}

/// The stored value of every channel at one node.
std::array<double, 3> sampleNode(const Brdf& brdf, std::size_t h, std::size_t d, std::size_t p) {
    const auto [ih, id, ip] =
        std::array{static_cast<double>(h), static_cast<double>(d), static_cast<double>(p)};
    if (merlBelowHorizon(ih, id, ip)) return {-1, -1, -1};
    const DirectionPair pair = merlDirections(ih, id, ip);
    std::array<double, 3> values{};
    brdf.eval(pair.wo, {&pair.wi.x, &pair.wi.y, &pair.wi.z, 1}, values.data());
    if (brdf.channels().count() == 1) values[1] = values[2] = values[0];
    for (std::size_t c = 0; c < 3; ++c) {
        if (!(values[c] >= 0) || !std::isfinite(values[c])) {
            throw NumericError(
                fmt::format("{}: f is {} at theta_h {:.4g}, theta_d {}, phi_d {} "
                            "degrees; a MERL cell holds finite values from 0",
                            brdf.name(), values[c], degrees(merlHalfAngle(ih)), id, ip));
        }
        values[c] /= merlScale[c];
    }
    return values;
}

}  // namespace

void writeMerl(const Brdf& brdf, const std::string& path, const WriteOptions& options) {
    checkRepresentable(brdf);
    AtomicFile file(path,
                    options.force ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse);
    const MerlLayout layout{.azimuthCount = brdf.laws().reciprocal ? 180u : 360u};
    std::vector<double> cells(3 * layout.cells());
    tbb::parallel_for(
        tbb::blocked_range2d<std::size_t>(0, MerlLayout::halfCount, 0, MerlLayout::differenceCount),
        [&](const tbb::blocked_range2d<std::size_t>& range) {
            for (std::size_t h = range.rows().begin(); h < range.rows().end(); ++h) {
                for (std::size_t d = range.cols().begin(); d < range.cols().end(); ++d) {
                    for (std::size_t p = 0; p < layout.azimuthCount; ++p) {
                        const std::array<double, 3> values = sampleNode(brdf, h, d, p);
                        for (std::size_t c = 0; c < 3; ++c) {
                            cells[c * layout.cells() + layout.cell(h, d, p)] = values[c];
                        }
                    }
                }
            }
        });
    brdf.checkIntact();
    const std::int32_t header[3] = {90, 90, static_cast<std::int32_t>(layout.azimuthCount)};
    file.write(std::as_bytes(std::span(header)));
    file.write(std::as_bytes(std::span(cells)));
    file.commit();
}

const Writer& merlWriter() {
    static const Writer writer{
        .name = "merl",
        .help = "MERL table of half and difference angles, isotropic, RGB",
        .extension = ".binary",
        .parameters = {},
        .write =
            [](const Brdf& brdf, const std::string& path, const Parameters&,
               const WriteOptions& options) {
                writeMerl(brdf, path, options);
                return std::vector<std::string>();
            },
    };
    return writer;
}

}  // namespace hshfit::brdfs
