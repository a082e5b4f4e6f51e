#include <brdfs/fit/loss.h>

#include <brdfs/rows/spec.h>
#include <hshfit/error.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace hshfit::brdfs {
namespace {

/// Keeps logarithms and roots, and their slopes, finite at f = 0. The first is as in the metric
/// `log`; the second is a hundredth of the cube root of a fabric's f c.
constexpr double logOffset = 1e-3, rootOffset = 1e-6;

constexpr std::array table{
    Loss{"l2", "f", "", Loss::Kind::l2, true, "relative-l2"},
    Loss{"cosine", "f c", "Ngan, Durand & Matusik 2005, 10.2312/EGWR/EGSR05/117-126",
         Loss::Kind::cosine, true, "relative-l2-cosine"},
    Loss{"log", "ln(1 + f c)", "Löw et al. 2012, 10.1145/2077341.2077350", Loss::Kind::log, false,
         "low"},
    Loss{"cube-root", "(f c + 1e-6)^(1/3)",
         "Fores, Ferwerda & Gu 2012, 10.2352/CIC.2012.20.1.art00025", Loss::Kind::cubeRoot, false,
         "cube-root"},
    Loss{"log-relative", "ln(f c + 1e-3)",
         "Nielsen, Jensen & Ramamoorthi 2015, 10.1145/2816795.2818085", Loss::Kind::logRelative,
         false, "log-rms"},
    Loss{"picture", "lightness of spheres under five lights", "CIE 15:2004, lightness L*",
         Loss::Kind::picture, false, ""},
};

/// Lightness L* / 100 of a radiance x over the radiance of white; above white, which pictures clip,
/// it goes on with a slope that falls.
Mapped lightness(double x) {
    constexpr double delta = 6.0 / 29, knee = delta * delta * delta;
    if (x <= knee) return {1.16 * x / (3 * delta * delta), 1.16 / (3 * delta * delta)};
    if (x <= 1) {
        const double root = std::cbrt(x);
        return {1.16 * root - 0.16, 1.16 / (3 * root * root)};
    }
    constexpr double reach = 0.25, slope = 1.16 / 3;
    return {1 + slope * reach * std::log1p((x - 1) / reach), slope / (1 + (x - 1) / reach)};
}

}  // namespace

std::span<const Loss> losses() {
    return table;
}

const Loss& findLoss(std::string_view name) {
    const auto found = std::ranges::find(table, name, &Loss::name);
    if (found != table.end()) return *found;
    throw spelling::unknown("loss", name, spelling::namesOf(table));
}

std::string_view lossName(Loss::Kind kind) {
    return std::ranges::find(table, kind, &Loss::kind)->name;
}

Mapped mapValue(Loss::Kind kind, double f, double cosine) {
    if (kind == Loss::Kind::l2) return {f, 1};
    if (kind == Loss::Kind::cosine) return {f * cosine, cosine};
    const double x = std::max(f, 0.0) * cosine;
    if (kind == Loss::Kind::picture) return lightness(x);
    if (kind == Loss::Kind::log) return {std::log1p(x), cosine / (1 + x)};
    if (kind == Loss::Kind::logRelative) return {std::log(x + logOffset), cosine / (x + logOffset)};
    const double root = std::cbrt(x + rootOffset);
    return {root, cosine / (3 * root * root)};
}

Robust findRobust(std::string_view name) {
    for (const Robust robust : {Robust::none, Robust::huber, Robust::cauchy})
        if (robustName(robust) == name) return robust;
    throw spelling::unknown("robust kernel", name,
                            std::array{robustName(Robust::none), robustName(Robust::huber),
                                       robustName(Robust::cauchy)});
}

std::string_view robustName(Robust robust) {
    return robust == Robust::none ? "none" : robust == Robust::huber ? "huber" : "cauchy";
}

Kernel applyKernel(Robust robust, double scale, double squared) {
    const double limit = scale * scale;
    if (robust == Robust::cauchy)
        return {limit * std::log1p(squared / limit), limit / (limit + squared)};
    if (robust == Robust::none || squared <= limit) return {squared, 1};
    const double size = std::sqrt(squared);
    return {2 * scale * size - limit, scale / size};
}

}  // namespace hshfit::brdfs
