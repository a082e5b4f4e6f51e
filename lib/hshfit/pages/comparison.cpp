#include <hshfit/error.h>
#include <hshfit/pages/comparison.h>
#include <hshfit/pictures/sphere_picture.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hshfit::inline pages {
namespace {

constexpr std::size_t mapEdge = 90;

/// The channels of the comparison: a grey BRDF takes the channels of the other.
Channels channelsOf(const Brdf& a, const Brdf& b) {
    const Channels &x = a.channels(), &y = b.channels();
    if (x.serve(y)) return y;
    if (y.serve(x)) return x;
    throw UsageError(fmt::format("{} has channels {}, {} has {}: they cannot be compared", a.name(),
                                 fmt::join(x.names(), " "), b.name(), fmt::join(y.names(), " ")));
}

/// f at pairs of directions, all channels, one pair after the other.
class Sampler {
public:
    Sampler(const Brdf& brdf, const std::vector<std::size_t>& drawn)
        : brdf_(brdf), drawn_(drawn), values_(brdf.channels().count()) {}

    const std::vector<double>& operator()(const DirectionPair& pair) {
        brdf_.eval(pair.wo, {&pair.wi.x, &pair.wi.y, &pair.wi.z, 1}, values_.data());
        return values_;
    }
    void append(const std::vector<double>& values, std::vector<std::vector<double>>& curve) const {
        curve.resize(drawn_.size());
        for (std::size_t i = 0; i < drawn_.size(); ++i) {
            curve[i].push_back(values[values.size() == 1 ? 0 : drawn_[i]]);
        }
    }
    void append(const DirectionPair& pair, std::vector<std::vector<double>>& curve) {
        append((*this)(pair), curve);
    }
    double mean(const DirectionPair& pair) {
        double sum = 0;
        for (const double value : (*this)(pair)) sum += value;
        return sum / static_cast<double>(values_.size());
    }

private:
    const Brdf& brdf_;
    const std::vector<std::size_t>& drawn_;
    std::vector<double> values_;
};

/// The two BRDFs with the comparison that they are sampled for.
struct Both {
    const Brdf &reference, &approximation;
    const std::vector<std::size_t>& drawn;

    /// The curve through the pairs of directions at these angles.
    template <class PairAt>
    ComparisonCurve curve(double azimuth, double slice, std::vector<double> angles,
                          PairAt pairAt) const {
        ComparisonCurve result{azimuth, slice, std::move(angles), {}, {}};
        Sampler f(reference, drawn), g(approximation, drawn);
        for (const double angle : result.angles) {
            const DirectionPair pair = pairAt(angle);
            f.append(pair, result.reference);
            g.append(pair, result.approximation);
        }
        return result;
    }
};

ComparisonCurve polarCurve(const Both& both, double azimuth, double thetaOut) {
    std::vector<double> angles;
    for (int half = -179; half <= 179; ++half) angles.push_back(half / 2.0);
    for (const double peak : {-thetaOut, thetaOut}) {
        const auto at = std::lower_bound(angles.begin(), angles.end(), peak);
        if (at == angles.end() || *at != peak) angles.insert(at, peak);
    }
    const double phi = radians(azimuth);
    const Direction wo = directionFromAngles(radians(thetaOut), phi);
    return both.curve(azimuth, thetaOut, std::move(angles), [&](double angle) {
        return DirectionPair{directionFromAngles(radians(-angle), phi), wo};
    });
}

ComparisonCurve halfCurve(const Both& both, double azimuth, double thetaDifference) {
    std::vector<double> angles;
    for (int i = 0; i < 180; ++i) angles.push_back(90 * (i / 180.0) * (i / 180.0));
    return both.curve(azimuth, thetaDifference, std::move(angles), [&](double angle) {
        return fromHalfDifference(radians(angle), radians(azimuth), radians(thetaDifference),
                                  pi / 2);
    });
}

ComparisonCurve albedoCurve(const Both& both, double azimuth, const AlbedoTable& f,
                            const AlbedoTable& g) {
    ComparisonCurve curve{azimuth, 0, {}, {}, {}};
    std::vector<double> values;
    for (int degree = 0; degree < 90; ++degree) {
        curve.angles.push_back(degree);
        const Direction wo = directionFromAngles(radians(degree), radians(azimuth));
        const auto append = [&](const Brdf& brdf, const AlbedoTable& table,
                                std::vector<std::vector<double>>& to) {
            values.resize(brdf.channels().count());
            table.at(wo, values);
            Sampler(brdf, both.drawn).append(values, to);
        };
        append(both.reference, f, curve.reference);
        append(both.approximation, g, curve.approximation);
    }
    return curve;
}

ResidualMap residualMap(const Both& both, double azimuth) {
    ResidualMap map{.azimuth = azimuth,
                    .thetaHalf = {},
                    .thetaDifference = {},
                    .logRatio = std::vector<double>(mapEdge * mapEdge),
                    .measured = std::vector<unsigned char>(mapEdge * mapEdge)};
    for (std::size_t i = 0; i < mapEdge; ++i) {
        const double middle = (static_cast<double>(i) + 0.5) / mapEdge;
        map.thetaHalf.push_back(90 * middle * middle);
        map.thetaDifference.push_back(90 * middle);
    }
    tbb::parallel_for(std::size_t{0}, mapEdge, [&](std::size_t row) {
        Sampler f(both.reference, both.drawn), g(both.approximation, both.drawn);
        for (std::size_t column = 0; column < mapEdge; ++column) {
            const DirectionPair pair =
                fromHalfDifference(radians(map.thetaHalf[column]), radians(azimuth),
                                   radians(map.thetaDifference[row]), pi / 2);
            const double of = f.mean(pair), by = g.mean(pair), ratio = std::log10(by / of);
            const bool positive = of > 0 && by > 0 && std::isfinite(ratio);
            const std::size_t cell = row * mapEdge + column;
            map.logRatio[cell] = positive ? ratio : std::numeric_limits<double>::quiet_NaN();
            both.reference.coverage(pair.wo, {&pair.wi.x, &pair.wi.y, &pair.wi.z, 1},
                                    &map.measured[cell]);
        }
    });
    return map;
}

void drawSpheres(Comparison& comparison, const Brdf& reference, const Brdf& approximation,
                 const AlbedoTable& f, const AlbedoTable& g, const SphereOptions& options) {
    comparison.rig = options.rig;
    comparison.referenceSphere = renderSphere(reference, f, options);
    comparison.approximationSphere = renderSphere(approximation, g, options);
    comparison.difference =
        sphereDifference(comparison.referenceSphere, comparison.approximationSphere);
    comparison.stops = automaticExposure({&comparison.referenceSphere, 1});
    comparison.amplification = amplificationFor(comparison.difference, comparison.stops);
    comparison.reference.notFinite = comparison.referenceSphere.notFinite;
    comparison.approximation.notFinite = comparison.approximationSphere.notFinite;
}

std::vector<MetricValue> allMetrics(const Brdf& reference, const Brdf& approximation,
                                    const OutgoingSet& outgoing, const ComparisonOptions& options) {
    if (!options.metrics.empty()) return options.metrics;
    const auto all = selectMetrics("all");
    return compare(reference, approximation, outgoing, all, {.progress = options.progress});
}

}  // namespace

std::vector<std::size_t> drawnChannels(const Channels& channels) {
    std::vector<std::size_t> drawn;
    const std::size_t count = channels.count();
    if (count <= 4) {
        for (std::size_t c = 0; c < count; ++c) drawn.push_back(c);
        return drawn;
    }
    const auto& nm = channels.wavelengths;
    if (nm.front() > 450 || nm.back() < 650) return {0, count / 2, count - 1};
    for (const double wanted : {450.0, 550.0, 650.0}) {
        const auto nearest = std::min_element(nm.begin(), nm.end(), [&](double a, double b) {
            return std::abs(a - wanted) < std::abs(b - wanted);
        });
        const auto index = static_cast<std::size_t>(nearest - nm.begin());
        if (drawn.empty() || drawn.back() != index) drawn.push_back(index);
    }
    return drawn;
}

Comparison makeComparison(const Brdf& reference, const Brdf& approximation,
                          const ComparisonOptions& options) {
    const bool isotropic = reference.laws().isotropic && approximation.laws().isotropic;
    Comparison result;
    result.channels = channelsOf(reference, approximation);
    result.drawn = drawnChannels(result.channels);
    result.outgoing = options.outgoing ? *options.outgoing
                      : isotropic      ? OutgoingSet::elevations(16)
                                       : OutgoingSet::parabolic(16, 16);
    result.picture = options.picture;
    result.metrics = allMetrics(reference, approximation, result.outgoing, options);
    const AlbedoTable f(reference), g(approximation);
    result.reference = {reference.name(), reference.channels(), reference.laws(), f.error()};
    result.approximation = {approximation.name(), approximation.channels(), approximation.laws(),
                            g.error()};

    std::vector<double> azimuths = isotropic ? std::vector<double>{0} : std::vector<double>{0, 90};
    std::vector<double> slices = {10, 30, 50, 70};
    if (result.outgoing.map == OutgoingSet::Map::direction) {
        // Without the last digits, which the way through a unit vector has cost.
        const auto clean = [](double angle) { return std::round(degrees(angle) * 1e9) / 1e9; };
        azimuths = {clean(azimuth(result.outgoing.directions[0]))};
        slices = {clean(polarAngle(result.outgoing.directions[0]))};
    }
    const Both both{reference, approximation, result.drawn};
    for (const double at : azimuths) {
        for (const double slice : slices) result.polar.push_back(polarCurve(both, at, slice));
        for (const double slice : {0.0, 20.0, 40.0, 60.0, 80.0}) {
            result.half.push_back(halfCurve(both, at, slice));
        }
        result.albedo.push_back(albedoCurve(both, at, f, g));
        result.residuals.push_back(residualMap(both, at));
    }
    drawSpheres(result, reference, approximation, f, g, options.sphere);
    reference.checkIntact();
    approximation.checkIntact();
    return result;
}

}  // namespace hshfit::inline pages
