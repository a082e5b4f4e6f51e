#include <hshfit/gpu/viewer_reference.h>

#include <hshfit/error.h>
#include <hshfit/gpu/highlight.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::gpu {

const double ReferenceTable::lastThetaDifference = radians(89);

namespace {

/// Below this elevation the values at it are taken, because some models have a pole at the horizon.
const double lowest = radians(1);

std::size_t index(int i) {
    return static_cast<std::size_t>(i);
}

/// A position between two nodes.
struct Cell {
    int first = 0, second = 0;
    double fraction = 0;
};

/// Position `x` in [0, 1] between `count` nodes, the first at 0 and the last at 1.
Cell between(double x, int count) {
    if (count == 1) return {};
    const double place = std::clamp(x, 0.0, 1.0) * (count - 1);
    const int first = std::min(static_cast<int>(place), count - 2);
    return {first, first + 1, place - first};
}

/// The stored part of the circle of azimuths: phi_d -> phi_d + pi is reciprocity; -phi_d is the
/// mirror image if f does not depend on phi_h.
struct Arc {
    double range;
    bool mirrored;  ///< ends are mirrors; otherwise the arc repeats

    double node(int k, int count) const { return range * k / (mirrored ? count - 1 : count); }
    Cell cell(double angle, int count) const {
        const double period = mirrored ? 2 * range : range;
        const double rest = angle - period * std::floor(angle / period);
        if (mirrored) return between(std::min(rest, period - rest) / range, count);
        const double place = rest / range * count;
        const int first = std::min(static_cast<int>(place), count - 1);
        return {first, (first + 1) % count, place - first};
    }
};

Arc arcOf(const ReferenceTable& table) {
    const double period = table.reciprocal ? pi : 2 * pi;
    if (table.isotropic && table.bilateral) return {period / 2, true};
    return {period, false};
}

/// Half and difference angles; theta_h at most what keeps both directions at `lowest`: the lower
/// one has z = cos(theta_h) cos(theta_d) - sin(theta_h) sin(theta_d) |cos(phi_d)|.
DirectionPair above(double thetaHalf, double phiHalf, double thetaDifference,
                    double phiDifference) {
    const double along = std::cos(thetaDifference);
    const double across = std::sin(thetaDifference) * std::abs(std::cos(phiDifference));
    const double share = std::min(1.0, std::sin(lowest) / std::hypot(along, across));
    const double limit = std::max(0.0, std::acos(share) - std::atan2(across, along));
    return fromHalfDifference(std::min(thetaHalf, limit), phiHalf, thetaDifference, phiDifference);
}

/// A node's place from -1 to 1, or from 0 where the mirror symmetry gives the rest, as s|s|.
double signedSquare(int i, int count, bool mirrored) {
    const double s = mirrored ? i / (count - 1.0) : 2 * i / (count - 1.0) - 1;
    return s * std::abs(s);
}

DirectionPair nodePair(const ReferenceTable& table, int column, int row, int azimuth, int rest) {
    const double phi = arcOf(table).node(azimuth, table.azimuths);
    if (table.isotropic) {
        const double u = column / (table.width - 1.0), v = row / (table.height - 1.0);
        return above(u * u * pi / 2, 0, v * ReferenceTable::lastThetaDifference, phi);
    }
    const double x = signedSquare(column, table.width, table.bilateral);
    const double y = signedSquare(row, table.height, table.bilateral);
    const double phiHalf = x == 0 && y == 0 ? 0 : std::atan2(y, x);
    const double thetaHalf = std::asin(std::min(1.0, std::hypot(x, y)));
    return above(thetaHalf, phiHalf,
                 ReferenceTable::lastThetaDifference * rest / (table.rest - 1.0), phi - phiHalf);
}

/// The position of a pair: columns, rows, azimuths, rest.
std::array<Cell, 4> cellsOf(const ReferenceTable& table, const Direction& wi, const Direction& wo) {
    const Direction sum{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
    const Direction gap{wi.x - wo.x, wi.y - wo.y, wi.z - wo.z};
    const double across = std::hypot(sum.x, sum.y), along = std::sqrt(dot(sum, sum));
    const double cosine = across > 0 ? sum.x / across : 1, sine = across > 0 ? sum.y / across : 0;
    const double thetaD = std::atan2(std::sqrt(dot(gap, gap)), along);
    // The difference vector in the frame of the half vector, times `along`.
    const double dx = sum.z * (cosine * wi.x + sine * wi.y) - across * wi.z;
    const double dy = along * (cosine * wi.y - sine * wi.x);
    const double phiD = std::atan2(dy, dx);
    if (table.isotropic) {
        return {between(std::sqrt(std::atan2(across, sum.z) / (pi / 2)), table.width),
                between(thetaD / ReferenceTable::lastThetaDifference, table.height),
                arcOf(table).cell(phiD, table.azimuths), Cell{}};
    }
    double phi = phiD + std::atan2(sine, cosine), x = sum.x / along, y = sum.y / along;
    if (table.bilateral && x < 0) phi = pi - phi;
    if (table.bilateral && y < 0) phi = -phi;
    const auto place = [&](double h) {
        const double s = std::sqrt(std::abs(h));
        return table.bilateral ? s : 0.5 + std::copysign(0.5 * s, h);
    };
    return {between(place(x), table.width), between(place(y), table.height),
            arcOf(table).cell(phi, table.azimuths),
            between(thetaD / ReferenceTable::lastThetaDifference, table.rest)};
}

/// Terms of van der Corput's sequence in a base.
double radicalInverse(int n, int base) {
    double result = 0, digit = 1;
    for (; n > 0; n /= base) {
        digit /= base;
        result += digit * (n % base);
    }
    return result;
}

/// Odd pairs lie around the highlight, even ones anywhere.
DirectionPair errorPair(int n, double roughness) {
    const std::array x = {radicalInverse(n, 3), radicalInverse(n, 5), radicalInverse(n, 7),
                          radicalInverse(n, 11)};
    if (n % 2 == 0) {
        const auto uniform = [](double z, double turn) {
            return directionFromAngles(std::acos(z), 2 * pi * turn);
        };
        return {uniform(x[0], x[1]), uniform(x[2], x[3])};
    }
    const double thetaHalf = std::atan(roughness * std::sqrt(x[0] / (1 - x[0])));
    return fromHalfDifference(thetaHalf, 2 * pi * x[1], x[2] * pi / 2, 2 * pi * x[3]);
}

double errorOf(const ReferenceTable& table, const Brdf& brdf, int pairs) {
    const double least = std::sin(radians(5));
    std::array<double, 3> found{};
    double wrong = 0, all = 0;
    for (int n = 1; n <= 2 * pairs; ++n) {
        const DirectionPair pair = errorPair(n, table.roughness);
        if (pair.wi.z < least || pair.wo.z < least) continue;
        const std::vector<double> f = evaluate(brdf, pair.wi, pair.wo);
        table.eval(pair.wi, pair.wo, found.data());
        for (std::size_t c = 0; c < f.size(); ++c) {
            const double value = std::max(f[c], 0.0) * pair.wi.z;
            wrong += std::pow(found[c] * pair.wi.z - value, 2);
            all += value * value;
        }
    }
    return all > 0 ? std::sqrt(wrong / all) : 0;
}

double fromHalf(std::uint16_t bits) {
    Imath::half value;
    value.setBits(bits);
    return value;
}

double cosDifference(const Direction& wi, const Direction& wo) {
    return std::hypot(wi.x + wo.x, wi.y + wo.y, wi.z + wo.z) / 2;
}

}  // namespace

void ReferenceTable::eval(const Direction& wi, const Direction& wo, double* f) const {
    std::fill_n(f, channels, 0.0);
    if (wi.z <= 0 || wo.z <= 0) return;
    const auto cells = cellsOf(*this, wi, wo);
    std::array<double, 3> roots{};
    for (int corner = 0; corner < 16; ++corner) {
        double weight = 1;
        std::array<int, 4> at{};
        for (std::size_t k = 0; k < 4; ++k) {
            const bool second = corner >> k & 1;
            weight *= second ? cells[k].fraction : 1 - cells[k].fraction;
            at[k] = second ? cells[k].second : cells[k].first;
        }
        const std::size_t node =
            index(((at[3] * azimuths + at[2]) * height + at[1]) * width + at[0]);
        for (int c = 0; c < channels; ++c) {
            roots[index(c)] += weight * fromHalf(cubeRoots[node * index(channels) + index(c)]);
        }
    }
    for (int c = 0; c < channels; ++c) {
        f[c] = std::pow(roots[index(c)], 3) / cosDifference(wi, wo);
    }
}

ReferenceTable tabulate(const Brdf& brdf, const ReferenceOptions& options) {
    if (brdf.channels().kind == Channels::Kind::spectral) {
        throw UsageError(fmt::format(
            "{}: the viewer shows grey or RGB; give the spectral BRDF as rgb:SPEC", brdf.name()));
    }
    ReferenceTable table;
    table.isotropic = brdf.laws().isotropic;
    table.bilateral = brdf.laws().mirrorSymmetric;
    table.reciprocal = brdf.laws().reciprocal;
    table.channels = static_cast<int>(brdf.channels().count());
    table.roughness = highlightRoughness(brdf);
    const int side = table.bilateral ? options.half : 2 * options.half - 1;
    table.width = table.isotropic ? options.thetaHalf : side;
    table.height = table.isotropic ? options.thetaDifference : side;
    table.azimuths = table.isotropic ? options.phiDifference : options.phiDifferenceOfFour;
    table.rest = table.isotropic ? 1 : options.thetaDifferenceOfFour;
    const int nodes = table.width * table.height * table.azimuths * table.rest;
    table.cubeRoots.reserve(index(nodes * table.channels));
    for (int n = 0; n < nodes; ++n) {
        const int layer = n / (table.width * table.height);
        const auto [wi, wo] = nodePair(table, n % table.width, n / table.width % table.height,
                                       layer % table.azimuths, layer / table.azimuths);
        for (const double f : evaluate(brdf, wi, wo)) {
            const double value = std::isfinite(f) ? std::max(f, 0.0) * cosDifference(wi, wo) : 0;
            const double root = std::min(std::cbrt(value), 65504.0);
            table.cubeRoots.push_back(Imath::half(static_cast<float>(root)).bits());
        }
    }
    table.error = errorOf(table, brdf, options.errorPairs);
    return table;
}

}  // namespace hshfit::gpu
