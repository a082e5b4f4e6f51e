#include <brdfs/fit/gaussian_mixture_fit.h>

#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/quadrature/ring_points.h>

#include <ceres/ceres.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

namespace hshfit::brdfs {
namespace {

constexpr double leastSharpness = 0.01, mostSharpness = 1e7;

/// Values of f over half of the hemisphere of wi (y > 0), wo on the side of -x.
struct Slice {
    double theta = 0;
    std::size_t channels = 1;
    std::vector<Direction> wi = {};
    std::vector<double> areas = {};   ///< d omega, both halves counted
    std::vector<double> values = {};  ///< [channel * wi.size() + k]
};

Slice sliceOf(const Brdf& brdf, double theta, int level) {
    Slice slice{.theta = theta, .channels = brdf.channels().count()};
    const Direction wo = directionFromAngles(theta, pi);
    const HemisphereGrid grid =
        gridFor(brdf.lobes(wo), wo, {.order = 7, .level = level, .squeezed = true});
    constexpr std::size_t mostPoints = 1'000'000;
    if (grid.points() > mostPoints)
        throw NumericError(
            fmt::format("{}: wo at {:.2f} degrees needs {} quadrature points, more than {}; its "
                        "lobe is too narrow",
                        brdf.name(), degrees(theta), grid.points(), mostPoints));
    std::vector<double> x, y, z;
    RingPoints points(grid);
    while (points.next()) {
        for (std::size_t j = 0; j < points.count() / 2; ++j) {
            slice.wi.push_back(points.direction(j));
            slice.areas.push_back(2 * points.weight(j));
            x.push_back(slice.wi.back().x);
            y.push_back(slice.wi.back().y);
            z.push_back(slice.wi.back().z);
        }
    }
    slice.values.resize(slice.channels * slice.wi.size());
    brdf.eval(wo, {x.data(), y.data(), z.data(), x.size()}, slice.values.data());
    if (!std::ranges::all_of(slice.values, [](double v) { return std::isfinite(v); }))
        throw NumericError(fmt::format("{}: is not finite everywhere for wo at {:.2f} degrees",
                                       brdf.name(), degrees(theta)));
    return slice;
}

/// At normal incidence f depends on the angle of wi alone, and so does a lobe about the normal that
/// is as wide across as along. A tilted one would be another for every azimuth that wo comes from.
GaussianLobe lobeFrom(const double* shape, double theta) {
    if (theta == 0) return {.sharpness = std::exp(shape[1]), .across = std::exp(shape[1])};
    return {.tilt = shape[0], .sharpness = std::exp(shape[1]), .across = std::exp(shape[2])};
}

/// Residuals sqrt(area) (m(g) - m(f)), m the map of the loss, scaled so that m(f) has norm 1.
/// Blocks: shapes (tilt, log sharpness, log across of each lobe), amplitudes [lobe * channels +
/// channel] in units of the peak.
class SliceCost final : public ceres::CostFunction {
public:
    SliceCost(const Slice& slice, const GaussianFitOptions& options, double peak)
        : slice_(slice),
          kind_(options.kind),
          loss_(options.loss),
          lobes_(options.lobes),
          peak_(peak),
          mapped_(slice.values.size()) {
        set_num_residuals(static_cast<int>(slice.values.size()));
        *mutable_parameter_block_sizes() = {3 * lobes_, lobes_ * static_cast<int>(slice.channels)};
        const std::size_t count = slice.wi.size();
        double norm = 0;
        for (std::size_t i = 0; i < mapped_.size(); ++i) {
            mapped_[i] = mapValue(loss_, slice.values[i], slice.wi[i % count].z).value;
            norm += slice.areas[i % count] * mapped_[i] * mapped_[i];
        }
        for (const double area : slice.areas) roots_.push_back(std::sqrt(area / norm));
    }

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        const std::size_t count = slice_.wi.size(), channels = slice_.channels;
        const std::size_t width = lobes_ * channels;
        double* shapes = jacobians ? jacobians[0] : nullptr;
        double* amplitudes = jacobians ? jacobians[1] : nullptr;
        if (amplitudes) std::fill(amplitudes, amplitudes + count * channels * width, 0.0);
        std::vector<GaussianValue> lobes(lobes_);
        for (std::size_t k = 0; k < count; ++k) {
            for (int j = 0; j < lobes_; ++j) {
                const double theta = slice_.theta;
                GaussianValue& g = lobes[j];
                g = evaluateLobe(kind_, lobeFrom(parameters[0] + 3 * j, theta), theta,
                                 slice_.wi[k]);
                if (theta == 0) g = {g.value, 0, g.byLogSharpness + g.byLogAcross, 0};
            }
            for (std::size_t c = 0; c < channels; ++c) {
                const std::size_t row = c * count + k;
                double sum = 0;
                for (int j = 0; j < lobes_; ++j)
                    sum += parameters[1][j * channels + c] * lobes[j].value;
                const Mapped mapped = mapValue(loss_, peak_ * sum, slice_.wi[k].z);
                residuals[row] = roots_[k] * (mapped.value - mapped_[row]);
                const double slope = roots_[k] * peak_ * mapped.slope;
                for (int j = 0; j < lobes_; ++j) {
                    const double amplitude = parameters[1][j * channels + c];
                    if (amplitudes)
                        amplitudes[row * width + j * channels + c] = slope * lobes[j].value;
                    if (!shapes) continue;
                    double* to = shapes + (row * lobes_ + j) * 3;
                    to[0] = slope * amplitude * lobes[j].byTilt;
                    to[1] = slope * amplitude * lobes[j].byLogSharpness;
                    to[2] = slope * amplitude * lobes[j].byLogAcross;
                }
            }
        }
        return true;
    }

private:
    const Slice& slice_;
    GaussianKind kind_;
    Loss::Kind loss_;
    int lobes_;
    double peak_;
    std::vector<double> mapped_, roots_;
};

/// The parts of which starts are made.
struct Features {
    double peak = 0;       ///< the largest value
    double tilt = 0;       ///< of where it is
    double sharpness = 1;  ///< of one Gaussian with that peak and the energy of f
};

Features featuresOf(const Slice& slice) {
    Features result;
    double integral = 0;
    const std::size_t count = slice.wi.size();
    for (std::size_t i = 0; i < slice.values.size(); ++i) {
        const Direction& w = slice.wi[i % count];
        integral += slice.values[i] * slice.areas[i % count] * w.z;
        if (slice.values[i] * w.z <= result.peak) continue;
        result.peak = slice.values[i] * w.z;
        result.tilt = std::atan2(w.x, w.z) - slice.theta;
    }
    integral /= static_cast<double>(slice.channels);
    if (integral > 0)
        result.sharpness = std::clamp(2 * pi * result.peak / integral, 1.0, mostSharpness / 10);
    return result;
}

struct Attempt {
    std::vector<double> shapes, amplitudes;
    double cost = HUGE_VAL;
    bool converged = false;
};

void solve(ceres::Problem& problem, int iterations, Attempt& attempt) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = iterations;
    options.function_tolerance = 1e-8;
    options.num_threads = 1;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    attempt.cost = summary.final_cost;
    attempt.converged = summary.termination_type == ceres::CONVERGENCE;
}

/// `ratio` between neighbouring sharpnesses; the first as narrow as f, or the middle one.
Attempt attemptFrom(const Slice& slice, const GaussianFitOptions& options, const Features& features,
                    double ratio, bool middle) {
    SliceCost cost(slice, options, features.peak);
    Attempt attempt;
    for (int j = 0; j < options.lobes; ++j) {
        const double power = (middle ? (options.lobes - 1) / 2.0 : 0.5) - j;
        const double sharpness = std::clamp(features.sharpness * std::pow(ratio, power),
                                            leastSharpness * 2, mostSharpness / 2);
        const double halved = options.kind == GaussianKind::spherical ? sharpness : sharpness / 2;
        attempt.shapes.insert(attempt.shapes.end(),
                              {middle ? features.tilt : 0, std::log(halved), std::log(halved)});
    }
    attempt.amplitudes.assign(options.lobes * slice.channels, 1.0 / options.lobes);

    ceres::Problem::Options problemOptions;
    problemOptions.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(problemOptions);
    double *shapes = attempt.shapes.data(), *amplitudes = attempt.amplitudes.data();
    problem.AddResidualBlock(&cost, nullptr, shapes, amplitudes);
    for (int j = 0; j < static_cast<int>(attempt.amplitudes.size()); ++j)
        problem.SetParameterLowerBound(amplitudes, j, 0);
    for (int j = 0; j < options.lobes; ++j) {
        problem.SetParameterLowerBound(shapes, 3 * j, -pi / 2);
        problem.SetParameterUpperBound(shapes, 3 * j, pi / 2);
        for (const int p : {3 * j + 1, 3 * j + 2}) {
            problem.SetParameterLowerBound(shapes, p, std::log(leastSharpness));
            problem.SetParameterUpperBound(shapes, p, std::log(mostSharpness));
        }
    }
    problem.SetParameterBlockConstant(shapes);
    solve(problem, 20, attempt);
    problem.SetParameterBlockVariable(shapes);
    solve(problem, 200, attempt);
    for (double& amplitude : attempt.amplitudes) amplitude *= features.peak;
    return attempt;
}

/// The albedo of each channel of f and of the mixture.
void addEnergy(const Slice& slice, GaussianKind kind, bool keep, GaussianElevation& result) {
    const std::size_t count = slice.wi.size();
    for (std::size_t c = 0; c < slice.channels; ++c) {
        double albedo = 0, fitted = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const double area = slice.areas[k] * slice.wi[k].z;
            albedo += area * slice.values[c * count + k];
            for (const GaussianLobe& lobe : result.lobes)
                fitted += area * lobe.amplitude[c] *
                          evaluateLobe(kind, lobe, slice.theta, slice.wi[k]).value;
        }
        if (keep && fitted > 0) {
            for (GaussianLobe& lobe : result.lobes) lobe.amplitude[c] *= albedo / fitted;
            fitted = albedo;
        }
        result.albedo += albedo / static_cast<double>(slice.channels);
        result.fittedAlbedo += fitted / static_cast<double>(slice.channels);
    }
}

/// Of f cos(theta_i), or of f where that was fitted.
double relativeError(const Slice& slice, const GaussianFitOptions& options,
                     const GaussianElevation& fit) {
    const bool cosine = options.loss != Loss::Kind::l2;
    double difference = 0, norm = 0;
    const std::size_t count = slice.wi.size();
    for (std::size_t i = 0; i < slice.values.size(); ++i) {
        const Direction& w = slice.wi[i % count];
        double value = 0;
        for (const GaussianLobe& lobe : fit.lobes)
            value +=
                lobe.amplitude[i / count] * evaluateLobe(options.kind, lobe, slice.theta, w).value;
        const double weight = slice.areas[i % count] * (cosine ? w.z * w.z : 1);
        difference += weight * std::pow(value - slice.values[i], 2);
        norm += weight * std::pow(slice.values[i], 2);
    }
    return std::sqrt(difference / norm);
}

GaussianElevation fitElevation(const Brdf& brdf, double theta, const GaussianFitOptions& options) {
    const Slice slice = sliceOf(brdf, theta, options.level);
    const Features features = featuresOf(slice);
    GaussianElevation result{.theta = theta};
    if (features.peak == 0)
        throw NumericError(
            fmt::format("{}: is 0 for wo at {:.2f} degrees", brdf.name(), degrees(theta)));
    Attempt best;
    for (const double ratio : {3.0, 10.0, 40.0})
        for (const bool middle : {false, true}) {
            Attempt attempt = attemptFrom(slice, options, features, ratio, middle);
            if (attempt.cost < best.cost) best = std::move(attempt);
            if (options.lobes == 1 && middle) break;
        }
    for (int j = 0; j < options.lobes; ++j) {
        const double* amplitude = best.amplitudes.data() + j * slice.channels;
        GaussianLobe lobe = lobeFrom(best.shapes.data() + 3 * j, theta);
        lobe.amplitude = {amplitude, amplitude + slice.channels};
        result.lobes.push_back(std::move(lobe));
    }
    // The narrowest first.
    std::ranges::sort(result.lobes, std::ranges::greater(), &GaussianLobe::sharpness);
    result.converged = best.converged;
    addEnergy(slice, options.kind, options.keepEnergy, result);
    result.error = relativeError(slice, options, result);
    return result;
}

void requireFittable(const Brdf& brdf, const OutgoingSet& outgoing,
                     const GaussianFitOptions& options) {
    if (!brdf.laws().isotropic || !brdf.laws().mirrorSymmetric)
        throw UsageError(fmt::format(
            "{}: mixtures about the mirror direction are of BRDFs that are isotropic and mirror "
            "symmetric",
            brdf.name()));
    if (outgoing.map == OutgoingSet::Map::parabolic)
        throw UsageError("a map of outgoing directions: give elevations (16) or one (45,0)");
    if (options.loss == Loss::Kind::picture)
        throw UsageError(
            "the loss picture needs lights, and fits of Gaussians have none; expected "
            "cube-root, or another loss of values");
    if (options.lobes < 1 || options.lobes > 16)
        throw UsageError(fmt::format("{} lobes: from 1 to 16 are possible", options.lobes));
}

}  // namespace

GaussianMixture fitGaussians(const Brdf& brdf, const OutgoingSet& outgoing,
                             const GaussianFitOptions& options) {
    requireFittable(brdf, outgoing, options);
    GaussianMixture::Content content{.name = fmt::format("gaussians of {}", brdf.name()),
                                     .source = brdf.name(),
                                     .kind = options.kind,
                                     .channels = brdf.channels()};
    content.elevations.resize(outgoing.size());
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, outgoing.size(), [&](std::size_t k) {
        content.elevations[k] = fitElevation(brdf, polarAngle(outgoing.directions[k]), options);
        const std::size_t count = ++done;
        if (options.progress) options.progress(count, outgoing.size());
    });
    return GaussianMixture(std::move(content));
}

}  // namespace hshfit::brdfs
