// The rows of the table say which parameters f is linear in: those are, and no others.

#include <brdfs/fit/parametric_sum.h>
#include <hshfit/error.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

using Values = std::vector<double>;

constexpr std::size_t channels = 3;

struct Pair {
    Direction wi, wo;
};

/// Near the mirror direction, in retroreflection, at grazing angles and anywhere else.
std::vector<Pair> pairsOf() {
    std::vector<Pair> pairs;
    std::mt19937_64 random(5);
    const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    for (const double theta : {0.1, 0.6, 1.3}) {
        const Direction wo = directionFromAngles(theta, 0.3);
        for (const auto& [more, turn] : {std::pair{0.0, pi}, {0.05, pi - 0.2}, {0.0, 0.0}})
            pairs.push_back({directionFromAngles(theta + more, 0.3 + turn), wo});
        for (int k = 0; k < 4; ++k)
            pairs.push_back({directionFromAngles(1.5 * share(), 2 * pi * share()), wo});
    }
    return pairs;
}

/// [pair * channels + channel] of the specification that the sum writes.
Values valuesOf(const ParametricSum& sum, const Values& shapes, const Values& linear) {
    static const std::vector<Pair> pairs = pairsOf();
    const auto brdf = open(sum.filledIn({shapes}, linear, channels));
    Values all;
    for (const Pair& pair : pairs) {
        const Values f = evaluate(*brdf, pair.wi, pair.wo);
        for (std::size_t c = 0; c < channels; ++c) all.push_back(f[f.size() == 1 ? 0 : c]);
    }
    return all;
}

Values shapesAt(const ParametricSum& sum, double share) {
    Values shapes;
    for (const ShapeParameter& shape : sum.shapes()) {
        const double low = shape.toScale(shape.free.startLow);
        shapes.push_back(shape.toValue(low + share * (shape.toScale(shape.free.startHigh) - low)));
    }
    return shapes;
}

/// Whether a - b - c + d is 0 to rounding for all pairs and channels.
bool cancel(const Values& a, const Values& b, const Values& c, const Values& d) {
    for (std::size_t k = 0; k < a.size(); ++k) {
        const double size = std::abs(a[k]) + std::abs(b[k]) + std::abs(c[k]) + std::abs(d[k]);
        if (std::abs(a[k] - b[k] - c[k] + d[k]) > 1e-11 * size) return false;
    }
    return true;
}

/// Values of the linear parameters: colours that no two parameters share.
Values colours(const ParametricSum& sum) {
    Values linear;
    for (std::size_t k = 0; k < sum.linears().size(); ++k)
        for (const double share : {0.2, 0.45, 0.3}) linear.push_back(share / double(k + 1));
    return linear;
}

void expectLinear(const ParametricSum& sum, const Values& shapes) {
    const Values all = colours(sum), none(all.size(), 0.0);
    const Values base = valuesOf(sum, shapes, none), whole = valuesOf(sum, shapes, all);
    Values doubled = all;
    for (double& value : doubled) value *= 2;
    EXPECT_TRUE(cancel(valuesOf(sum, shapes, doubled), whole, whole, base)) << sum.spec();
    Values before = none, partial = base;
    for (std::size_t at = 0; at < all.size(); ++at) {
        // One parameter in one channel after the other: what each adds does not depend on the rest.
        Values alone = none, next = before;
        alone[at] = next[at] = all[at];
        const Values own = valuesOf(sum, shapes, alone), joined = valuesOf(sum, shapes, next);
        EXPECT_TRUE(cancel(joined, partial, own, base)) << sum.linears()[at / channels].name;
        for (std::size_t k = 0; k < own.size(); ++k) {
            if (k % channels != at % channels) {
                EXPECT_EQ(own[k], base[k]) << sum.linears()[at / channels].name;
            }
        }
        before = next;
        partial = joined;
    }
}

/// Whether f is linear in shape j as well, jointly with the linear parameters.
bool linearBesides(const ParametricSum& sum, Values shapes, std::size_t j) {
    const double unit = std::min(1.0, sum.shapes()[j].free.max);
    const auto at = [&](double share, const Values& linear) {
        shapes[j] = share * unit;
        return valuesOf(sum, shapes, linear);
    };
    const Values all = colours(sum), none(all.size(), 0.0);
    const Values high = at(1, all), middle = at(0.5, all), low = at(0, all);
    return high != low && cancel(high, middle, middle, low) &&
           cancel(high, low, at(1, none), at(0, none));
}

/// Every combination of choices, with no colour stated or one. Disney's tints are left out: with
/// one, f is linear in a grey baseColor and not in a coloured one, and its row states the latter.
std::vector<std::string> specsOf(const Model& model) {
    std::vector<std::string> specs{""};
    for (const Parameter& parameter : model.parameters) {
        if (parameter.kind != Parameter::Kind::choice) continue;
        std::vector<std::string> longer;
        for (const std::string& spec : specs)
            for (const std::string_view word : parameter.choices)
                longer.push_back(fmt::format("{},{}={}", spec, parameter.name, word));
        specs = longer;
    }
    const std::size_t choices = specs.size();
    for (const Parameter& parameter : model.parameters)
        for (std::size_t k = 0; parameter.kind == Parameter::Kind::colour && k < choices; ++k)
            specs.push_back(fmt::format("{},{}=0.4", specs[k], parameter.name));
    for (std::string& spec : specs) spec = spec.empty() ? "" : ":" + spec.substr(1);
    return specs;
}

TEST(LinearParameters, AreThoseThatTheTableStates) {
    for (const Model& model : models()) {
        std::size_t found = 0;
        for (const std::string& options : specsOf(model)) {
            const std::string spec = std::string(model.name) + options;
            SCOPED_TRACE(spec);
            for (const bool isotropic : {true, false}) {
                std::unique_ptr<ParametricSum> sum;
                try {
                    sum = std::make_unique<ParametricSum>(spec, isotropic);
                } catch (const UsageError&) {
                    continue;  // choices and values that exclude each other
                }
                for (const double share : {0.3, 0.7}) {
                    const Values shapes = shapesAt(*sum, share);
                    expectLinear(*sum, shapes);
                }
                for (std::size_t j = 0; j < sum->shapes().size(); ++j) {
                    const FreeParameter& free = sum->shapes()[j].free;
                    if (!free.colour || free.keys.size() > 1 || free.min != 0) continue;
                    // By its largest component it darkens what lies below: f is linear in a grey
                    // one beside a stated base colour, and not in a coloured one.
                    if (free.keys.front() == "sheenColorFactor") continue;
                    // Linear as long as no pair is cut at 0.
                    if (model.name == "ross-li") continue;
                    EXPECT_FALSE(linearBesides(*sum, shapesAt(*sum, 0.3), j) &&
                                 linearBesides(*sum, shapesAt(*sum, 0.7), j))
                        << free.keys.front() << " is linear, and its row does not say so";
                }
                ++found;
                if (options.find(',') != std::string::npos) break;
            }
        }
        EXPECT_GT(found, 0u) << model.name;
    }
}

TEST(LinearParameters, MayBeNegativeNowhere) {
    for (const Model& model : models()) {
        for (const Parameter& parameter : model.parameters) {
            if (!parameter.linear) continue;
            EXPECT_EQ(parameter.kind, Parameter::Kind::colour) << model.name;
            EXPECT_EQ(parameter.min, 0) << model.name << " " << parameter.name;
        }
    }
}

}  // namespace
}  // namespace hshfit::brdfs
