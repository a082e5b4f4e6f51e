#include <brdfs/measured/angles.h>
#include <brdfs/measured/rgl.h>
#include <hshfit/error.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/tensor_file.h>

#include <algorithm>
#include <cmath>
#include <utility>

#define HWY_TARGET_INCLUDE "brdfs/measured/rgl_eval_lanes.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalRgl);

constexpr std::size_t blockSize = 64;

/// The alpha of the GGX distribution with the same half width at half maximum as the normals'
/// density has, averaged over azimuth.
double widthOf(const Plane& ndf) {
    std::vector<double> profile(ndf.columns, 0.0);
    for (std::size_t i = 0; i < ndf.values.size(); ++i) profile[i % ndf.columns] += ndf.values[i];
    const auto peak = std::ranges::max_element(profile);
    std::size_t fallen = static_cast<std::size_t>(peak - profile.begin()) + 1;
    while (fallen < profile.size() && profile[fallen] > *peak / 2) ++fallen;
    if (fallen >= profile.size()) return 1;
    const double u = static_cast<double>(fallen) / static_cast<double>(profile.size() - 1);
    const double ggx = std::sqrt(std::sqrt(2.0) - 1);  // tan(theta) / alpha at half the peak
    return std::min(std::tan(std::min(u * u * pi / 2, 1.0)) / ggx, 1.0);
}

}  // namespace

/// Positions in the tables for a block of wi.
struct RglBrdf::Block {
    double uIncident[blockSize], thetaIncident[blockSize], phiIncident[blockSize];
    double uHalf[blockSize], vHalf[blockSize];

    void set(const RglTables& tables, Direction wo, const DirectionBatch& wi, std::size_t begin,
             std::size_t count);

private:
    // A copy of a block of wi, with its wo, folded into the measured azimuths.
    double ix_[blockSize], iy_[blockSize], iz_[blockSize];
    double hx_[blockSize], hy_[blockSize], hz_[blockSize];

    void fold(const RglTables& tables, const Direction& wo, const DirectionBatch& wi,
              std::size_t begin, std::size_t count);
};

void RglBrdf::Block::fold(const RglTables& tables, const Direction& wo, const DirectionBatch& wi,
                          std::size_t begin, std::size_t count) {
    const auto& phi = tables.incident.phi;
    const double middle = (phi.front() + phi.back()) / 2;
    const double cx = std::cos(middle), cy = std::sin(middle);
    for (std::size_t k = 0; k < count; ++k) {
        const double x = wi.x[begin + k], y = wi.y[begin + k];
        double signX = 1, signY = 1;
        if (tables.reduction == 2) {
            signX = signY = x * cx + y * cy < 0 ? -1 : 1;
        } else if (tables.reduction == 4) {
            signX = x * cx < 0 ? -1 : 1;
            signY = y * cy < 0 ? -1 : 1;
        }
        ix_[k] = signX * x;
        iy_[k] = signY * y;
        iz_[k] = std::max(wi.z[begin + k], 0.0);
        hx_[k] = signX * (x + wo.x);
        hy_[k] = signY * (y + wo.y);
        hz_[k] = iz_[k] + wo.z;
    }
}

// One short loop per angle, over arrays that cannot overlap: the compiler vectorises these.
void RglBrdf::Block::set(const RglTables& tables, Direction wo, const DirectionBatch& wi,
                         std::size_t begin, std::size_t count) {
    fold(tables, wo, wi, begin, count);
    for (std::size_t k = 0; k < count; ++k) {
        const double sine = std::sqrt(ix_[k] * ix_[k] + iy_[k] * iy_[k]);
        thetaIncident[k] = quadrantAngle(sine, iz_[k]);
        uIncident[k] = std::sqrt(2 / pi * thetaIncident[k]);
    }
    for (std::size_t k = 0; k < count; ++k) {
        const double sine = std::sqrt(hx_[k] * hx_[k] + hy_[k] * hy_[k]);
        uHalf[k] = std::sqrt(2 / pi * quadrantAngle(sine, hz_[k]));
    }
    if (tables.reduction == 0) {
        // The azimuth of h relative to the azimuth of wi, which is arbitrary at the normal.
        for (std::size_t k = 0; k < count; ++k) {
            const double sine = ix_[k] * hy_[k] - iy_[k] * hx_[k];
            const double cosine = ix_[k] * hx_[k] + iy_[k] * hy_[k];
            vHalf[k] = rayAngle(sine, cosine) / (2 * pi) + 0.5;
        }
    } else {
        for (std::size_t k = 0; k < count; ++k) {
            vHalf[k] = rayAngle(hy_[k], hx_[k]) / (2 * pi) + 0.5;
        }
    }
    if (tables.isotropic) {
        std::fill_n(phiIncident, count, 0.0);
        return;
    }
    // Wraps an azimuth into the full circle around the middle of the measured azimuths.
    const auto& phi = tables.incident.phi;
    const double start = (phi.front() + phi.back()) / 2 - pi;
    for (std::size_t k = 0; k < count; ++k) {
        const double angle = rayAngle(iy_[k], ix_[k]);
        phiIncident[k] = angle - 2 * pi * std::floor((angle - start) / (2 * pi));
    }
}

RglBrdf::RglBrdf(std::span<const unsigned char> bytes, std::string name, RglReading reading)
    : name_(std::move(name)) {
    tables_ = RglTables::load(TensorFile(bytes, name_));
    if (reading == RglReading::smooth) {
        tables_.smooth();
        name_ += ":reading=smooth";
    }
    laws_.nonNegative = true;
    laws_.isotropic = tables_.isotropic;
    laws_.mirrorSymmetric = tables_.reduction == 4;
    lobeWidth_ = widthOf(tables_.ndf);
}

std::unique_ptr<RglBrdf> RglBrdf::open(const std::string& path, RglReading reading) {
    const MappedFile file(path);
    try {
        auto brdf = std::make_unique<RglBrdf>(file.bytes(), path, reading);
        file.checkIntact();
        return brdf;
    } catch (const InputError&) {
        file.checkIntact();  // reports a file that was removed or cut while it was read
        throw;
    }
}

inline void RglBrdf::evalAt(const Block& block, std::size_t k, double cosine, double* out,
                            std::size_t stride) const {
    const double u = block.uHalf[k], v = block.vHalf[k];
    const Slices slices = tables_.incident.slices(block.phiIncident[k], block.thetaIncident[k]);
    const VisibleNormals::Point point = tables_.normals->invert(u, v, slices);
    double factor = 1 / cosine;
    if (tables_.jacobian) {
        const double vIncident = block.phiIncident[k] / (2 * pi) + 0.5;
        factor *= tables_.ndf.at(u, v) /
                  (4 * tables_.sigma.at(block.uIncident[k], vIncident - std::floor(vIncident)));
    }
    tables_.spectra.at(point, slices, factor, out, stride);
}

void RglBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    if (wo.z > 0 && tables_.spectra.channels == 3)
        HWY_DYNAMIC_DISPATCH(evalRgl)(tables_, wo, wi, out);
    else
        evalScalar(wo, wi, out);
}

void RglBrdf::evalScalar(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channelCount = tables_.spectra.channels;
    if (!(wo.z > 0)) {
        std::fill_n(out, channelCount * wi.count, 0.0);
        return;
    }
    const double cosine = std::max(wo.z, 1e-9);
    Block block;
    for (std::size_t begin = 0; begin < wi.count; begin += blockSize) {
        const std::size_t count = std::min(blockSize, wi.count - begin);
        block.set(tables_, wo, wi, begin, count);
        for (std::size_t k = 0; k < count; ++k) {
            double* to = out + begin + k;
            if (wi.z[begin + k] > 0) {
                evalAt(block, k, cosine, to, wi.count);
            } else {
                for (std::size_t c = 0; c < channelCount; ++c) to[c * wi.count] = 0;
            }
        }
    }
}

std::vector<Lobe> RglBrdf::lobes(const Direction&) const {
    return {{.about = Lobe::About::halfway, .width = lobeWidth_, .axis = {}}};
}

void RglBrdf::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    // The grid's angles are rounded to float.
    constexpr double rounding = 1e-6;
    const auto& [phi, theta] = tables_.incident;
    Block block;
    for (std::size_t begin = 0; begin < wi.count; begin += blockSize) {
        const std::size_t count = std::min(blockSize, wi.count - begin);
        block.set(tables_, wo, wi, begin, count);
        for (std::size_t k = 0; k < count; ++k) {
            const bool above = wo.z > 0 && wi.z[begin + k] > 0;
            const double angle = block.thetaIncident[k], turn = block.phiIncident[k];
            const bool elevation =
                angle >= theta.front() - rounding && angle <= theta.back() + rounding;
            const bool azimuth = tables_.isotropic ||
                                 (turn >= phi.front() - rounding && turn <= phi.back() + rounding);
            covered[begin + k] = above && elevation && azimuth ? 1 : 0;
        }
    }
}

}  // namespace hshfit::brdfs
