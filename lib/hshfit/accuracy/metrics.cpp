#include <hshfit/accuracy/metrics.h>

#include <hshfit/error.h>
#include <hshfit/projection/horizon.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/quadrature/ring_points.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hshfit::inline accuracy {
namespace {

/// f and g at one pair of directions, with c = cos(theta_i).
struct Sample {
    double f, g, c;
    double logRatio = 0;  ///< ln((f c + 1e-3) / (g c + 1e-3)), for Shared::logRatio
    double growth = 0;    ///< ln(1 + g c) - ln(1 + f c), for Shared::growth
    double clamped() const { return std::max(g, 0.0); }
};

/// A part that several metrics use.
enum class Shared { none, logRatio, growth };

/// A metric as the ratio of two sums over samples, then `finish`. Metrics that are not of this form
/// (maximum, albedo, reciprocity) have no `term` and are computed apart.
struct Formula {
    Metric metric;
    double (*term)(const Sample&);
    double (*scale)(const Sample&);  ///< null: the mean over directions
    double (*finish)(double);
    Shared shared = Shared::none;
};

double square(double x) {
    return x * x;
}
double identity(double x) {
    return x;
}
double squareRoot(double x) {
    return x < 0 ? 0 : std::sqrt(x);
}

constexpr double logOffset = 1e-3, rootOffset = 1e-6;

const Formula formulas[] = {
    {{"relative-l2", "root of the integral of (g - f)^2 over that of f^2", "", true},
     [](const Sample& s) { return square(s.g - s.f); },
     [](const Sample& s) { return square(s.f); },
     squareRoot},
    {{"relative-l2-cosine", "the same with f c and g c", "", false},
     [](const Sample& s) { return square((s.g - s.f) * s.c); },
     [](const Sample& s) { return square(s.f * s.c); },
     squareRoot},
    {{"captured-energy", "1 - relative-l2^2: Eq. 15 for a projection at its own directions",
      "Gautron et al. 2004", true},
     [](const Sample& s) { return square(s.g - s.f); },
     [](const Sample& s) { return square(s.f); },
     [](double x) { return 1 - x; }},
    {{"log", "mean |ln((f c + 1e-3) / (g c + 1e-3))|", "", false},
     [](const Sample& s) { return std::abs(s.logRatio); },
     nullptr,
     identity,
     Shared::logRatio},
    {{"ngan", "root mean square of (g - f) c", "Ngan, Durand & Matusik 2005", false},
     [](const Sample& s) { return square((s.g - s.f) * s.c); },
     nullptr,
     squareRoot},
    {{"low", "mean (ln(1 + g c) - ln(1 + f c))^2", "Löw et al. 2012", false},
     [](const Sample& s) { return square(s.growth); },
     nullptr,
     identity,
     Shared::growth},
    {{"fores", "mean cube root of ((g - f) c)^2", "Fores, Ferwerda & Gu 2012", false},
     [](const Sample& s) { return std::cbrt(square((s.g - s.f) * s.c)); },
     nullptr,
     identity},
    {{"nbrdf", "mean |ln(1 + f c) - ln(1 + g c)|", "Sztrajman et al. 2021", false},
     [](const Sample& s) { return std::abs(s.growth); },
     nullptr,
     identity,
     Shared::growth},
    {{"cube-root", "root mean square of (g c + 1e-6)^(1/3) - (f c + 1e-6)^(1/3)", "", false},
     [](const Sample& s) {
         return square(std::cbrt(s.clamped() * s.c + rootOffset) -
                       std::cbrt(s.f * s.c + rootOffset));
     },
     nullptr,
     squareRoot},
    {{"log-rms", "root mean square of ln((f c + 1e-3) / (g c + 1e-3))",
      "Nielsen, Jensen & Ramamoorthi 2015", false},
     [](const Sample& s) { return square(s.logRatio); },
     nullptr,
     squareRoot,
     Shared::logRatio},
    {{"negativity", "integral of max(-g c, 0) over that of f c", "", false},
     [](const Sample& s) { return std::max(-s.g * s.c, 0.0); },
     [](const Sample& s) { return s.f * s.c; },
     identity},
    {{"maximum", "largest |g - f| c over the nodes, and where", "", false},
     nullptr,
     nullptr,
     nullptr},
    {{"albedo", "largest |difference| of directional albedo, and where", "", false},
     nullptr,
     nullptr,
     nullptr},
    {{"reciprocity", "root mean square of g(wi,wo) - g(wo,wi), over that of g", "", false},
     nullptr,
     nullptr,
     nullptr},
};
constexpr std::size_t formulaCount = std::size(formulas);

/// Sums over one outgoing direction, or over all of them.
struct Sums {
    double term[formulaCount] = {}, scale[formulaCount] = {};
    double weight = 0;
    double maximum = -1;
    Direction maximumWi, maximumWo;
    double albedoDifference = 0;
};

/// The formulas of the metrics that are asked for.
class Asked {
public:
    explicit Asked(std::span<const Metric* const> metrics) {
        for (const Metric* metric : metrics) {
            const auto m = static_cast<std::size_t>(metric - metricCatalog().data());
            if (!formulas[m].term) continue;
            terms_.push_back(m);
            logRatio_ |= formulas[m].shared == Shared::logRatio;
            growth_ |= formulas[m].shared == Shared::growth;
        }
    }
    void add(Sample sample, double weight, Sums& sums) const {
        if (logRatio_)
            sample.logRatio = std::log((sample.f * sample.c + logOffset) /
                                       (sample.clamped() * sample.c + logOffset));
        if (growth_)
            sample.growth =
                std::log1p(sample.clamped() * sample.c) - std::log1p(sample.f * sample.c);
        sums.weight += weight;
        for (const std::size_t m : terms_) {
            sums.term[m] += weight * formulas[m].term(sample);
            if (formulas[m].scale) sums.scale[m] += weight * formulas[m].scale(sample);
        }
    }

private:
    std::vector<std::size_t> terms_ = {};
    bool logRatio_ = false, growth_ = false;
};

/// Values of all channels of f and g at a batch; a grey one is repeated.
class PairEvaluator {
public:
    PairEvaluator(const Brdf& f, const Brdf& g) : f_(f), g_(g) {
        const Channels &a = f.channels(), &b = g.channels();
        if (!a.serve(b) && !b.serve(a)) {
            throw UsageError(fmt::format("{} has channels {}, {} has {}: they cannot be compared",
                                         f.name(), fmt::join(a.names(), " "), g.name(),
                                         fmt::join(b.names(), " ")));
        }
        channels = std::max(a.count(), b.count());
    }
    void eval(const Direction& wo, DirectionBatch wi, std::vector<double>& f,
              std::vector<double>& g) const {
        evalOne(f_, wo, wi, f);
        evalOne(g_, wo, wi, g);
    }
    std::size_t channels = 1;

private:
    void evalOne(const Brdf& brdf, const Direction& wo, DirectionBatch wi,
                 std::vector<double>& values) const {
        values.resize(channels * wi.count);
        brdf.eval(wo, wi, values.data());
        for (std::size_t c = brdf.channels().count(); c < channels; ++c) {
            std::copy_n(values.begin(), wi.count, values.begin() + c * wi.count);
        }
    }
    const Brdf &f_, &g_;
};

Sums sumOver(const PairEvaluator& pair, const Asked& asked, const Direction& wo,
             const HemisphereGrid& grid) {
    Sums sums;
    std::vector<double> f, g;
    std::vector<double> albedo(pair.channels, 0.0);
    RingPoints points(grid);
    while (points.next()) {
        const double mu = points.mu();
        pair.eval(wo, points.directions(), f, g);
        for (std::size_t k = 0; k < f.size(); ++k) {
            const std::size_t j = k % points.count();
            const double weight = points.weight(j);
            asked.add({f[k], g[k], mu}, weight, sums);
            albedo[k / points.count()] += weight * mu * (g[k] - f[k]);
            if (const double error = std::abs(g[k] - f[k]) * mu; error > sums.maximum) {
                sums.maximum = error;
                sums.maximumWi = points.direction(j);
            }
        }
    }
    for (double a : albedo) sums.albedoDifference = std::max(sums.albedoDifference, std::abs(a));
    sums.maximumWo = wo;
    return sums;
}

/// Reciprocity depends on g alone: pairs of 24 directions spread over the hemisphere.
double reciprocityDefect(const Brdf& g) {
    constexpr int count = 24;
    std::vector<Direction> directions;
    for (int k = 0; k < count; ++k) {
        const double mu = (k + 0.5) / count, phi = k * pi * (3 - std::sqrt(5.0));
        directions.push_back(directionFromAngles(std::acos(mu), phi));
    }
    double defect = 0, norm = 0;
    for (int a = 0; a < count; ++a) {
        for (int b = 0; b < a; ++b) {
            const auto forward = evaluate(g, directions[a], directions[b]);
            const auto backward = evaluate(g, directions[b], directions[a]);
            for (std::size_t c = 0; c < forward.size(); ++c) {
                defect += square(forward[c] - backward[c]);
                norm += 0.5 * (square(forward[c]) + square(backward[c]));
            }
        }
    }
    return norm > 0 ? std::sqrt(defect / norm) : 0;
}

/// The values at one quadrature level, in the order of the catalog.
struct LevelValues {
    double value[formulaCount] = {};
    Direction maximumWi, maximumWo, albedoWo;
};

LevelValues valuesAt(const Brdf& f, const Brdf& g, const PairEvaluator& pair, const Asked& asked,
                     const OutgoingSet& outgoing, int level,
                     const std::function<void()>& progress) {
    std::vector<Sums> perDirection(outgoing.size());
    tbb::parallel_for(std::size_t{0}, outgoing.size(), [&](std::size_t k) {
        if (outgoing.solidAngles[k] > 0) {
            const Direction& wo = outgoing.directions[k];
            std::vector<Lobe> lobes = f.lobes(wo);
            const std::vector<Lobe> others = g.lobes(wo);
            lobes.insert(lobes.end(), others.begin(), others.end());
            perDirection[k] =
                sumOver(pair, asked, wo,
                        gridFor(lobes, wo, {.order = 24, .level = level, .squeezed = true}));
        }
        progress();
    });
    Sums total;
    LevelValues result;
    for (std::size_t k = 0; k < outgoing.size(); ++k) {
        const Sums& sums = perDirection[k];
        const double w = outgoing.solidAngles[k];
        total.weight += w * sums.weight;
        for (std::size_t m = 0; m < formulaCount; ++m) {
            total.term[m] += w * sums.term[m];
            total.scale[m] += w * sums.scale[m];
        }
        if (sums.maximum > total.maximum) {
            total.maximum = sums.maximum;
            result.maximumWi = sums.maximumWi;
            result.maximumWo = sums.maximumWo;
        }
        if (sums.albedoDifference >= total.albedoDifference && w > 0) {
            total.albedoDifference = sums.albedoDifference;
            result.albedoWo = sums.maximumWo;
        }
    }
    for (std::size_t m = 0; m < formulaCount; ++m) {
        const std::string_view name = formulas[m].metric.name;
        if (formulas[m].term) {
            const double scale = formulas[m].scale ? total.scale[m] : total.weight;
            result.value[m] = formulas[m].finish(total.term[m] / scale);
        } else if (name == "maximum") {
            result.value[m] = total.maximum;
        } else if (name == "albedo") {
            result.value[m] = total.albedoDifference;
        } else {
            result.value[m] = reciprocityDefect(g);
        }
    }
    return result;
}

/// The reason why integrals of f^2 and g^2 without a cosine do not exist, or empty.
std::string whyNoSquares(const Brdf& f, const Brdf& g, const OutgoingSet& outgoing,
                         const CompareOptions& options) {
    for (const Brdf* brdf : {&f, &g}) {
        const std::string& given = brdf == &f ? options.reference : options.approximation;
        for (std::size_t k = 0; k < outgoing.size(); ++k) {
            if (outgoing.solidAngles[k] == 0) continue;
            const Direction& wo = outgoing.directions[k];
            const auto behaviour = horizonBehaviour(*brdf, wo, Quantity::brdf);
            if (!behaviour.energyExists(Basis::Inner::solidAngle)) {
                return fmt::format(
                    "{} grows like cos(theta_i)^-{:.2f} towards the horizon: the integral of its "
                    "square does not exist; relative-l2-cosine does",
                    given.empty() ? brdf->name() : given, behaviour.exponent);
            }
        }
    }
    return {};
}

std::vector<Metric> metricsOf() {
    std::vector<Metric> metrics;
    for (const Formula& formula : formulas) metrics.push_back(formula.metric);
    return metrics;
}

}  // namespace

std::span<const Metric> metricCatalog() {
    static const std::vector<Metric> metrics = metricsOf();
    return metrics;
}

std::vector<const Metric*> selectMetrics(std::string_view names) {
    std::vector<const Metric*> chosen;
    const auto catalog = metricCatalog();
    if (names == "all") {
        for (const Metric& metric : catalog) chosen.push_back(&metric);
        return chosen;
    }
    for (std::size_t start = 0; start <= names.size();) {
        const std::size_t comma = std::min(names.find(',', start), names.size());
        const std::string_view name = names.substr(start, comma - start);
        const auto found = std::find_if(catalog.begin(), catalog.end(),
                                        [&](const Metric& m) { return m.name == name; });
        if (found == catalog.end())
            throw spelling::unknown("metric", name, spelling::namesOf(catalog, {"all"}));
        chosen.push_back(&*found);
        start = comma + 1;
    }
    return chosen;
}

OutgoingSet comparedOutgoing(bool isotropic) {
    return isotropic ? OutgoingSet::elevations(16) : OutgoingSet::parabolic(16, 16);
}

std::vector<MetricValue> compare(const Brdf& f, const Brdf& g, const OutgoingSet& outgoing,
                                 std::span<const Metric* const> metrics,
                                 const CompareOptions& options) {
    const PairEvaluator pair(f, g);
    const Asked asked(metrics);
    const std::string noSquares = whyNoSquares(f, g, outgoing, options);
    std::atomic<std::size_t> done = 0;
    const auto progress = [&] {
        const std::size_t now = ++done;
        if (options.progress) options.progress(now, 2 * outgoing.size());
    };
    const LevelValues coarse = valuesAt(f, g, pair, asked, outgoing, options.level - 1, progress);
    const LevelValues fine = valuesAt(f, g, pair, asked, outgoing, options.level, progress);
    f.checkIntact();
    g.checkIntact();

    std::vector<MetricValue> results;
    for (const Metric* metric : metrics) {
        const auto index = static_cast<std::size_t>(metric - metricCatalog().data());
        MetricValue result;
        result.metric = metric;
        const double value = fine.value[index];
        if (metric->squaresWithoutCosine && !noSquares.empty()) {
            result.reason = noSquares;
        } else if (!std::isfinite(value)) {
            result.reason = "the reference is zero or a value is not finite";
        } else {
            result.value = value;
            result.error = std::abs(value - coarse.value[index]);
            if (metric->name == "maximum") result.wi = fine.maximumWi;
            if (metric->name == "maximum") result.wo = fine.maximumWo;
            if (metric->name == "albedo") result.wo = fine.albedoWo;
        }
        results.push_back(std::move(result));
    }
    return results;
}

std::vector<MetricValue> compareSamples(std::span<const double> f, std::span<const double> g,
                                        std::span<const double> cosines,
                                        std::span<const double> weights) {
    Sums sums;
    const Asked asked(selectMetrics("all"));
    for (std::size_t k = 0; k < f.size(); ++k) {
        const std::size_t at = k % cosines.size();
        asked.add({f[k], g[k], cosines[at]}, weights[at], sums);
        sums.maximum = std::max(sums.maximum, std::abs(g[k] - f[k]) * cosines[at]);
    }
    std::vector<MetricValue> results;
    for (std::size_t m = 0; m < formulaCount; ++m) {
        MetricValue result;
        result.metric = &metricCatalog()[m];
        double value = sums.maximum;
        if (formulas[m].term) {
            const double scale = formulas[m].scale ? sums.scale[m] : sums.weight;
            value = formulas[m].finish(sums.term[m] / scale);
        }
        if (!formulas[m].term && result.metric->name != "maximum") {
            result.reason = "takes more than samples";
        } else if (!std::isfinite(value)) {
            result.reason = "the reference is zero or a value is not finite";
        } else {
            result.value = value;
        }
        results.push_back(std::move(result));
    }
    return results;
}

}  // namespace hshfit::inline accuracy
