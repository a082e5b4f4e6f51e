// RGL tables from any BRDF.

#include <brdfs/measured/rgl_writer.h>
#include <hshfit/error.h>

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace hshfit::brdfs {
namespace {

/// The start of the linear continuation below the horizon.
constexpr double horizonHeight = 1e-4;
constexpr double lastElevation = 89;  // degrees

struct Normals {
    Plane ndf, sigma;
    double unevenness = std::numeric_limits<double>::infinity();
};

/// The mean of S^2 over the square of the mean of S, the stored values: 1 if all are the same.
double unevenness(const Brdf& brdf, const Plane& ndf, bool isotropic) {
    constexpr NormalsGrid grid{33, 33};
    constexpr std::size_t points = 16;
    double first = 0, second = 0, count = 0;
    for (const double elevation : {5.0, 30.0, 55.0, 80.0}) {
        for (const double azimuth : {-170.0, -115.0}) {
            if (isotropic && azimuth > -150) continue;
            const Direction wi = directionFromAngles(radians(elevation), radians(azimuth));
            const VisibleNormals visible(visibleNormals(ndf, wi, 0, grid, 0), grid.rows,
                                         grid.columns);
            for (std::size_t i = 0; i < points * points; ++i) {
                const double x = (static_cast<double>(i % points) + 0.5) / points;
                const double y = (static_cast<double>(i / points) + 0.5) / points;
                const auto [u, v] = visible.sample(x, y, 0);
                const Direction h = directionFromAngles(u * u * pi / 2, (v - 0.5) * 2 * pi);
                const double twice = 2 * dot(wi, h);
                const Direction wo{twice * h.x - wi.x, twice * h.y - wi.y, twice * h.z - wi.z};
                ++count;
                if (!(wo.z > 0)) continue;
                const std::vector<double> f = evaluate(brdf, wi, wo);
                const double value =
                    brightness(brdf.channels(), f.data()) * wo.z / std::max(ndf.at(u, v), 1e-30);
                first += value;
                second += value * value;
            }
        }
    }
    return first > 0 ? count * second / (first * first) : std::numeric_limits<double>::infinity();
}

Normals normalsFrom(const Brdf& brdf, NormalsFrom from, NormalsGrid grid, double floor) {
    Normals normals;
    normals.ndf = estimateNormals(brdf, from, grid, floor);
    if (normals.ndf.values.empty()) return normals;
    normals.unevenness = unevenness(brdf, normals.ndf, grid.rows == 2);
    return normals;
}

/// Retro-reflection, unless the options name another source or another fits much better.
Normals chooseNormals(const Brdf& brdf, const RglResolution& resolution, NormalsGrid grid,
                      std::vector<std::string>& alterations) {
    if (resolution.from == NormalsFrom::uniform) return {};
    if (resolution.from) {
        Normals normals = normalsFrom(brdf, *resolution.from, grid, resolution.floor);
        if (normals.ndf.values.empty()) {
            throw NumericError(
                fmt::format("{}: no distribution of normals comes out: f is 0 or not finite where "
                            "it is looked at; from=uniform needs none",
                            brdf.name()));
        }
        return normals;
    }
    Normals retro = normalsFrom(brdf, NormalsFrom::retroReflection, grid, resolution.floor);
    Normals average = normalsFrom(brdf, NormalsFrom::average, grid, resolution.floor);
    if (retro.unevenness <= 1.25 * average.unevenness && !retro.ndf.values.empty()) return retro;
    if (!average.ndf.values.empty()) {
        constexpr std::string_view chosen =
            "the distribution of normals is averaged over difference angles: ";
        alterations.push_back(
            retro.ndf.values.empty()
                ? fmt::format("{}there is no retro-reflection to take it from", chosen)
                : fmt::format("{}with that from retro-reflection, stored values would vary more "
                              "(mean square over square mean {:.3g}, not {:.3g})",
                              chosen, retro.unevenness, average.unevenness));
        return average;
    }
    alterations.emplace_back(
        "no distribution of normals comes out of this BRDF: the file holds f cos(theta_o) on a "
        "uniform grid of half vectors (jacobian = 0)");
    return {};
}

IncidentGrid incidentGrid(const Brdf& brdf, const RglResolution& resolution) {
    IncidentGrid grid;
    for (std::size_t t = 0; t < resolution.theta; ++t) {
        const double part = static_cast<double>(t) / static_cast<double>(resolution.theta - 1);
        grid.theta.push_back(static_cast<float>(radians(lastElevation * std::pow(part, 0.6))));
    }
    if (brdf.laws().isotropic) {
        grid.phi = {0};
        return grid;
    }
    const std::size_t quarters = brdf.laws().mirrorSymmetric && !resolution.wholeCircle ? 1 : 4;
    const std::size_t steps = quarters * (resolution.phi - 1);
    for (std::size_t p = 0; p <= steps; ++p) {
        const double turn = static_cast<double>(p) / static_cast<double>(resolution.phi - 1);
        grid.phi.push_back(static_cast<float>(-pi + turn * pi / 2));
    }
    return grid;
}

/// Fills one slice's row of colours.
class RowSampler {
public:
    RowSampler(const Brdf& brdf, RglTables& tables) : brdf_(brdf), tables_(tables) {}

    void fill(std::size_t slice, std::size_t row) {
        Spectra& spectra = tables_.spectra;
        std::vector<double> values(spectra.channels);
        for (std::size_t c = 0; c < spectra.columns; ++c) {
            const RglTables::Node node = tables_.node(slice, row, c);
            if (node.wo.z > 0) {
                sample(node.wi, node.wo, node.factor, values);
            } else {
                continuation(node, slice, values);
            }
            float* to = spectra.values.data() +
                        ((slice * spectra.rows + row) * spectra.columns + c) * spectra.channels;
            for (std::size_t k = 0; k < values.size(); ++k) {
                to[k] = static_cast<float>(values[k]);
                if (!std::isfinite(to[k])) fail(node, values[k]);
                if (to[k] < 0 && node.wo.z > 0) ++negative;
            }
        }
    }

    std::atomic<std::size_t> negative = 0;

private:
    void sample(const Direction& wi, const Direction& wo, double factor,
                std::vector<double>& values) const {
        brdf_.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, values.data());
        if (brdf_.channels().count() < values.size()) {
            std::fill(values.begin() + 1, values.end(), values[0]);
        }
        for (double& value : values) value *= wo.z / factor;
    }

    /// The continuation is linear in the height of wo, from the values at the horizon and as far
    /// above.
    void continuation(const RglTables::Node& node, std::size_t slice,
                      std::vector<double>& values) const {
        const double height = std::max(-node.wo.z, horizonHeight);
        std::vector<double> above(values.size());
        const auto at = [&](double z, std::vector<double>& out) {
            const double across = std::hypot(node.wo.x, node.wo.y);
            const double scale = across > 0 ? std::sqrt(1 - z * z) / across : 0;
            const Direction wo{node.wo.x * scale, node.wo.y * scale, z};
            sample(node.wi, wo, tables_.factor(slice, node.wi, wo), out);
        };
        at(std::min(height, 1.0), above);
        at(horizonHeight, values);
        for (std::size_t k = 0; k < values.size(); ++k) values[k] = 2 * values[k] - above[k];
    }

    [[noreturn]] void fail(const RglTables::Node& node, double value) const {
        const auto angles = [](const Direction& w) {
            return fmt::format("{:.4g},{:.4g}", degrees(polarAngle(w)), degrees(azimuth(w)));
        };
        throw NumericError(
            fmt::format("{}: f cos(theta_o) / weight is {} at wi {} and wo {} degrees; an RGL file "
                        "holds finite 32-bit floats",
                        brdf_.name(), value, angles(node.wi), angles(node.wo)));
    }

    const Brdf& brdf_;
    RglTables& tables_;
};

void setNormals(RglTables& tables, Normals normals, const RglResolution& resolution) {
    const NormalsGrid grid{resolution.normals, resolution.normals};
    tables.jacobian = !normals.ndf.values.empty();
    const std::size_t slices = tables.incident.phi.size() * tables.incident.theta.size();
    std::vector<float> densities(slices * grid.rows * grid.columns, 1.0F);
    if (tables.jacobian) {
        tables.sigma = projectedAreas(normals.ndf, tables.isotropic ? 2 : 33, 128);
        tables.ndf = std::move(normals.ndf);
        tbb::parallel_for(std::size_t{0}, slices, [&](std::size_t s) {
            const double phi = tables.incident.phi[s / tables.incident.theta.size()];
            const double theta = tables.incident.theta[s % tables.incident.theta.size()];
            const auto slice = visibleNormals(tables.ndf, directionFromAngles(theta, phi),
                                              tables.isotropic ? phi : 0, grid, resolution.share);
            std::ranges::copy(slice, densities.begin() +
                                         static_cast<std::ptrdiff_t>(s * grid.rows * grid.columns));
        });
    } else {
        tables.ndf = tables.sigma = Plane{2, 2, std::vector<float>(4, 1.0F)};
    }
    tables.normals = std::make_unique<VisibleNormals>(densities, grid.rows, grid.columns);
}

}  // namespace

RglTables sampleRgl(const Brdf& brdf, const RglResolution& resolution, const WriteOptions& options,
                    std::vector<std::string>& alterations) {
    RglTables tables;
    tables.description = brdf.name();
    tables.isotropic = brdf.laws().isotropic;
    const bool quarter = brdf.laws().mirrorSymmetric && !resolution.wholeCircle;
    tables.reduction = tables.isotropic ? 0 : quarter ? 4 : 1;
    tables.incident = incidentGrid(brdf, resolution);
    tables.channels =
        brdf.channels().kind == Channels::Kind::grey ? Channels::rgb() : brdf.channels();
    const NormalsGrid grid{tables.isotropic ? 2 : resolution.normals, resolution.normals};
    setNormals(tables, chooseNormals(brdf, resolution, grid, alterations), resolution);

    const std::size_t slices = tables.incident.phi.size() * tables.incident.theta.size();
    const std::size_t n = resolution.slice;
    tables.spectra = {tables.channels.count(), n, n, {}};
    tables.spectra.values.resize(slices * n * n * tables.spectra.channels);
    RowSampler sampler(brdf, tables);
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, slices * n, [&](std::size_t i) {
        sampler.fill(i / n, i % n);
        const std::size_t now = ++done;
        if (options.progress) options.progress(now, slices * n);
    });
    brdf.checkIntact();
    if (sampler.negative > 0) {
        alterations.push_back(fmt::format(
            "{} stored values are negative: what is negative after interpolation is read as 0",
            sampler.negative.load()));
    }
    return tables;
}

}  // namespace hshfit::brdfs
