#include <hshfit/projection/albedo.h>

#include <hshfit/brdf/kink_curve.h>
#include <hshfit/brdf/steps.h>
#include <hshfit/error.h>
#include <hshfit/projection/internal/rings.h>
#include <hshfit/stop_request.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline projection {
namespace {

/// One level: the integral in each channel, and the root of the integral of (f cos)^2, which bounds
/// the rounding of integrals that cancel.
struct Level {
    std::vector<double> values;
    double norm = 0;
    std::size_t evaluations = 0;
};

/// Levels on rings of elevation.
class Rings {
public:
    Rings(const Brdf& brdf, const Direction& wo)
        : brdf_(brdf),
          wo_(wo),
          lobes_(brdf.lobes(wo)),
          kinks_(brdf.kinks(wo)),
          curves_(kinkCurvesOf(brdf, wo)) {}

    static int first() { return 0; }
    static int believed() { return 1; }

    /// Computes a level; false if it takes more evaluations than these.
    bool at(int level, std::size_t evaluations, Level& out) {
        const HemisphereGrid grid =
            gridFor(lobes_, wo_, {.order = 1, .level = level, .squeezed = true}, kinks_, curves_);
        if (grid.points() > evaluations) return false;
        sampleRings(brdf_, wo_, grid, Quantity::brdfCosine, azimuths_, /*even=*/false, spectrum_);
        out = {.values = std::vector<double>(spectrum_.channels), .evaluations = grid.points()};
        for (std::size_t r = 0; r < spectrum_.rings; ++r) {
            out.norm += grid.weights[r] * spectrum_.squares[r];
            for (std::size_t c = 0; c < spectrum_.channels; ++c)
                out.values[c] += grid.weights[r] * spectrum_.part(r, c, 0) * std::sqrt(2 * pi);
        }
        out.norm = std::sqrt(out.norm);
        return true;
    }

private:
    const Brdf& brdf_;
    Direction wo_;
    std::vector<Lobe> lobes_;
    std::vector<double> kinks_;
    std::vector<KinkCurve> curves_;
    const AzimuthTables azimuths_{1};
    RingSpectrum spectrum_;
};

/// Levels on the square of equal projected solid angles, 2^level by 2^level nodes at the centres of
/// cells: exact where f is constant on such cells.
class Squares {
public:
    Squares(const Brdf& brdf, const Direction& wo, int cells, std::size_t evaluations)
        : brdf_(brdf), wo_(wo), cells_(cells), first_(cells) {
        while (first_ > 0 && 5 * nodes(first_) > evaluations) --first_;
    }

    int first() const { return first_; }
    /// The first level whose change tells an error: the one before has a node in every cell.
    int believed() const { return cells_ + 1; }

    bool at(int level, std::size_t evaluations, Level& out) {
        constexpr int most = 14;
        if (level > most || nodes(level) > evaluations) return false;
        const std::size_t side = std::size_t{1} << level, channels = brdf_.channels().count();
        const double width = 1 / static_cast<double>(side), weight = pi * width * width;
        out = {.values = std::vector<double>(channels), .evaluations = nodes(level)};
        std::vector<double> x(side), y(side), z(side), f(channels * side);
        double squares = 0;
        for (std::size_t b = 0; b < side; ++b) {
            for (std::size_t a = 0; a < side; ++a) {
                const Direction wi = directionFromSquare({(static_cast<double>(a) + 0.5) * width,
                                                          (static_cast<double>(b) + 0.5) * width});
                x[a] = wi.x, y[a] = wi.y, z[a] = wi.z;
            }
            brdf_.eval(wo_, {x.data(), y.data(), z.data(), side}, f.data());
            for (std::size_t c = 0; c < channels; ++c) {
                double sum = 0;
                for (std::size_t a = 0; a < side; ++a) {
                    sum += f[c * side + a];
                    squares += f[c * side + a] * f[c * side + a];
                }
                out.values[c] += weight * sum;
            }
        }
        out.norm = std::sqrt(weight * squares);
        if (!std::isfinite(out.norm)) {
            brdf_.checkIntact();  // bad data has its own, more exact message
            throw NumericError(fmt::format("{}: not finite for theta_o = {:.6g} degrees",
                                           brdf_.name(), degrees(polarAngle(wo_))));
        }
        return true;
    }

private:
    static std::size_t nodes(int level) { return std::size_t{1} << (2 * level); }

    const Brdf& brdf_;
    Direction wo_;
    int cells_, first_;
};

template <class Levels>
AlbedoEstimate refined(Levels levels, const AlbedoOptions& options) {
    AlbedoEstimate result;
    result.error = std::numeric_limits<double>::infinity();
    double before = result.error;  // relative changes
    for (int level = levels.first(); !result.converged; ++level) {
        stopIfRequested();
        Level found;
        if (!levels.at(level, options.maxEvaluations - result.evaluations, found)) break;
        result.evaluations += found.evaluations;
        double change = 0, scale = 0;
        for (std::size_t c = 0; c < found.values.size(); ++c) {
            if (level > levels.first())
                change = std::max(change, std::abs(found.values[c] - result.values[c]));
            scale = std::max(scale, std::abs(found.values[c]));
        }
        result.values = std::move(found.values);
        if (level == levels.first()) continue;
        result.error = change;
        if (level < levels.believed()) continue;
        constexpr double rounding = 1e-13;
        scale = std::max(scale, rounding * found.norm / options.tolerance);
        // Twice in a row: two levels may agree by accident where f has steps. Once is enough where
        // changes fall fast.
        constexpr double fast = 0.1;
        const double enough = std::max(scale * options.tolerance, options.absolute);
        result.converged = change <= enough * (before <= enough ? 1 : fast);
        before = change;
    }
    return result;
}

std::vector<double> valuesOf(AlbedoEstimate found, const Brdf& brdf, const Direction& w,
                             const char* what) {
    if (found.converged) return std::move(found.values);
    throw NumericError(fmt::format("{}: the {} = {:.6g} degrees did not converge", brdf.name(),
                                   what, degrees(polarAngle(w))));
}

}  // namespace

AlbedoEstimate estimateAlbedo(const Brdf& brdf, const Direction& wo, const AlbedoOptions& options) {
    const int cells = squareLevelsOf(brdf);
    if (cells > 0) return refined(Squares(brdf, wo, cells, options.maxEvaluations), options);
    return refined(Rings(brdf, wo), options);
}

AlbedoEstimate estimateReflectance(const Brdf& brdf, const Direction& wi,
                                   const AlbedoOptions& options) {
    if (brdf.laws().reciprocal) return estimateAlbedo(brdf, wi, options);
    return estimateAlbedo(Exchanged(brdf), wi, options);
}

std::vector<double> directionalAlbedo(const Brdf& brdf, const Direction& wo, double tolerance) {
    return valuesOf(estimateAlbedo(brdf, wo, {.tolerance = tolerance}), brdf, wo,
                    "albedo at theta_o");
}

std::vector<double> directionalReflectance(const Brdf& brdf, const Direction& wi,
                                           double tolerance) {
    return valuesOf(estimateReflectance(brdf, wi, {.tolerance = tolerance}), brdf, wi,
                    "reflectance at theta_i");
}

}  // namespace hshfit::inline projection
