// The vectors by which models are evaluated, against double and the C++ library: for every
// instruction set of the machine, over the grid of parameters and at random ones.

#include <brdfs/models_grid.h>
#include <vector_targets.h>

#include <brdfs/analytic/term_brdf.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hshfit::brdfs {
namespace {

using test::forEveryTarget;

struct Points {
    std::vector<double> x, y, z;

    void add(const Direction& d) { x.push_back(d.x), y.push_back(d.y), z.push_back(d.z); }
    DirectionBatch batch(std::size_t first, std::size_t count) const {
        return {x.data() + first, y.data() + first, z.data() + first, count};
    }
    DirectionBatch all() const { return batch(0, x.size()); }
};

/// The mirror direction, around it at several scales, everywhere, and below the horizon.
Points ordinaryPoints(const Direction& wo, std::size_t count, Directions& directions) {
    Points points;
    points.add(mirrored(wo));
    while (points.x.size() < count) {
        const Direction d = directions.next();
        points.add(d);
        for (const double width : {1e-5, 1e-3, .1})
            points.add(directions.near(mirrored(wo), width));
        points.add({d.x, d.y, -d.z});
    }
    for (auto* axis : {&points.x, &points.y, &points.z}) axis->resize(count);
    return points;
}

Points extremePoints() {
    Points points;
    for (const Direction& d : extremeDirections()) points.add(d);
    return points;
}

/// A value above 1e-30 of the largest is exp(-69) of it at least: the 20 or so roundings in an
/// exponent, of either side, become up to 69 x 20 x 1.1e-16 of the value, and a power's logarithm
/// adds 3 units of the last place, 69 x 3.3e-16. The factor of the exponential errs by 3e-15.
constexpr double bound = 2e-13;

/// If a sum of terms cancels, errors are relative to the terms: of these models they are about
/// 1/sr, and their rounding is 1e-16 of that, ten times over.
double slackOf(std::string_view spec) {
    for (const char* model : {"eon", "openpbr-diffuse", "oren-nayar"})
        if (spec.starts_with(model)) return 1e-15;
    return 0;
}
/// sgd: F cancels where F0 and F1 do, and exp(c x^k) enlarges the errors of x^k by c x^k.
/// rough-glass: 1 - F cancels towards the critical angle.
double boundOf(std::string_view spec) {
    return spec.starts_with("sgd") || spec.starts_with("rough-glass") ? 2e-12 : bound;
}

void compare(const std::string& spec, const Brdf& brdf, const Direction& wo, const Points& points) {
    const std::size_t count = points.x.size(), channels = brdf.channels().count();
    std::vector<double> vectors(channels * count), scalars(channels * count);
    brdf.eval(wo, points.all(), vectors.data());
    dynamic_cast<const TermBrdf&>(brdf).evalScalar(wo, points.all(), scalars.data());
    const double slack = slackOf(spec), allowed = boundOf(spec);
    for (std::size_t c = 0; c < channels; ++c) {
        double largest = 0;
        for (std::size_t k = 0; k < count; ++k) largest = std::max(largest, scalars[c * count + k]);
        for (std::size_t k = 0; k < count; ++k) {
            const double v = vectors[c * count + k], s = scalars[c * count + k];
            ASSERT_TRUE(std::isfinite(v)) << v;
            // Below the second, exp itself gives 0 early (brdfs/lanes/lanes_math.h).
            if (std::max(v, s) <= std::max(1e-30 * largest, 1e-280)) continue;
            ASSERT_LE(std::abs(v - s), allowed * s + slack)
                << spec << ": " << v << " for " << s << " at wi " << points.x[k] << " "
                << points.y[k] << " " << points.z[k] << ", wo " << wo.x << " " << wo.y << " "
                << wo.z;
        }
    }
}

TEST(ModelVectors, AgreeWithDoubleOverTheGrid) {
    Directions directions(1);
    std::vector<Direction> outgoing{directions.next(), directions.next()};
    for (const double theta : {0., radians(89.99)})
        outgoing.push_back(directionFromAngles(theta, .4));
    const Points extremes = extremePoints();
    forEveryTarget([&] {
        Directions own(2);
        for (const Case& c : modelGrid()) {
            const auto brdf = openModel(c.spec);
            for (const Direction& wo : outgoing) {
                compare(c.spec, *brdf, wo, ordinaryPoints(wo, 101, own));
                compare(c.spec, *brdf, wo, extremes);
            }
        }
    });
}

/// A value of the parameter, within the ranges of fits, where materials lie.
std::string randomValue(const Parameter& parameter, Directions& directions) {
    if (parameter.kind == Parameter::Kind::choice) {
        const double size = static_cast<double>(parameter.choices.size());
        return std::string(
            parameter.choices[static_cast<std::size_t>(directions.uniform(0, size * .9999))]);
    }
    const auto& fit = parameter.fit.front();
    const auto one = [&] {
        if (!fit.logarithmic) return directions.uniform(fit.low, fit.high);
        return std::exp(directions.uniform(std::log(fit.low), std::log(fit.high)));
    };
    if (parameter.kind == Parameter::Kind::number || directions.uniform(0, 1) < .5)
        return fmt::format("{}", one());
    return fmt::format("{}/{}/{}", one(), one(), one());
}

/// The specification of a member of the model; not always one that there is.
std::string randomSpec(const Model& model, Directions& directions) {
    std::string spec;
    for (const Parameter& parameter : model.parameters) {
        const bool needed = !parameter.fallback && parameter.kind != Parameter::Kind::choice;
        if (parameter.kind != Parameter::Kind::choice && parameter.fit.empty() && !needed) continue;
        if (!needed && directions.uniform(0, 1) < .4) continue;
        spec += fmt::format("{}{}={}", spec.empty() ? "" : ",", parameter.name,
                            randomValue(parameter, directions));
    }
    return std::string(model.name) + (spec.empty() ? "" : ":") + spec;
}

TEST(ModelVectors, AgreeWithDoubleAtRandomParameters) {
    constexpr int wanted = 25;
    Directions directions(3);
    for (const Model& model : models()) {
        int found = 0;
        for (int attempt = 0; attempt < 40 * wanted && found < wanted; ++attempt) {
            const std::string spec = randomSpec(model, directions);
            std::unique_ptr<Brdf> brdf;
            try {
                brdf = openModel(spec);
            } catch (const UsageError&) {
                continue;  // keys that exclude each other
            }
            ++found;
            const Direction wo = directions.next();
            const Points points = ordinaryPoints(wo, 83, directions);
            forEveryTarget([&] { compare(spec, *brdf, wo, points); });
        }
        EXPECT_EQ(found, wanted) << model.name;
    }
}

// A direction has the same bits at every place in a batch of any size; what lies behind the batch
// is not written.
TEST(ModelVectors, ValuesDoNotDependOnTheBatch) {
    constexpr std::size_t count = 4097;
    constexpr double untouched = -7;
    forEveryTarget([&] {
        for (const Model& model : models()) {
            Directions directions(4);
            std::unique_ptr<Brdf> brdf;
            std::string spec;
            while (!brdf) {
                spec = randomSpec(model, directions);
                try {
                    brdf = openModel(spec);
                } catch (const UsageError&) {
                }
            }
            SCOPED_TRACE(spec);
            const Direction wo = directions.next();
            const Points points = ordinaryPoints(wo, count, directions);
            const std::size_t channels = brdf->channels().count();
            std::vector<double> whole(channels * count), part;
            brdf->eval(wo, points.all(), whole.data());
            for (const std::size_t length : {0, 1, 3, 7, 8, 31})
                for (const std::size_t first : {std::size_t{0}, std::size_t{5}, count - length}) {
                    part.assign(channels * length + 16, untouched);
                    brdf->eval(wo, points.batch(first, length), part.data());
                    for (std::size_t c = 0; c < channels; ++c)
                        for (std::size_t k = 0; k < length; ++k)
                            ASSERT_EQ(part[c * length + k], whole[c * count + first + k]);
                    for (std::size_t k = channels * length; k < part.size(); ++k)
                        ASSERT_EQ(part[k], untouched);
                }
        }
    });
}

// Lanes of a vector that need more terms of a series, or take another way to its sum, leave their
// neighbours as they are: g goes from thin to rough over these surfaces and heights.
TEST(ModelVectors, SeriesDoNotDependOnTheirNeighbours) {
    for (const char* sigma : {".05", ".5", "1", "2", "20"}) {
        const std::string spec = std::string("he:tau=5,sigma=") + sigma;
        const auto brdf = openModel(spec);
        Directions directions(5);
        const Points points = ordinaryPoints(directions.next(), 500, directions);
        for (const double theta : {.2, 1.5})
            forEveryTarget([&] {
                const Direction wo = directionFromAngles(theta, 1);
                std::vector<double> whole(points.x.size());
                brdf->eval(wo, points.all(), whole.data());
                for (std::size_t k = 0; k < whole.size(); ++k) {
                    double alone;
                    brdf->eval(wo, points.batch(k, 1), &alone);
                    ASSERT_EQ(alone, whole[k]) << spec << " " << points.z[k];
                }
            });
    }
}

}  // namespace
}  // namespace hshfit::brdfs
