// The halfway form on models and on measured materials, beside the published networks.
#include "places.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/halfway_rounding.h>

#include <brdfs/catalog.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>

namespace hshfit {
namespace {

const std::string data = test::sharedFolder() + "/data";

/// A network of Sztrajman et al. 2021 ("Neural BRDF Representation and Importance Sampling"):
/// 6-21-21-3, ReLU, h and d as Cartesian vectors in (h in the plane phi_h = 0), f = exp(y) - 1.
class Network {
public:
    static std::optional<Network> read(const std::string& set, const std::string& material) {
        std::ifstream names(data + "/nbrdf/" + set + "_nbrdf_names.txt");
        std::ifstream weights(data + "/nbrdf/" + set + "_nbrdf_weights.f32", std::ios::binary);
        std::string name;
        Network network;
        while (names >> name) {
            if (!weights.read(reinterpret_cast<char*>(network.w_.data()), sizeof(network.w_)))
                break;
            if (name == material) return network;
        }
        return std::nullopt;
    }

    std::array<double, 3> operator()(const Direction& wi, const Direction& wo) const {
        Direction h{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
        const double length = std::sqrt(dot(h, h));
        h = {h.x / length, h.y / length, h.z / length};
        const double theta = polarAngle(h);
        const Direction t = rotateAboutZ(wi, -azimuth(h));
        const double s = std::sin(theta), c = std::cos(theta);
        const std::array<double, 6> in{s, 0, c, c * t.x - s * t.z, t.y, s * t.x + c * t.z};
        const auto a = layer<6, 21>(in, 0, true);
        const auto b = layer<21, 21>(a, 147, true);
        auto y = layer<21, 3>(b, 609, false);
        for (double& value : y) value = std::max(std::exp(value) - 1, 0.0);
        return y;
    }

private:
    template <std::size_t In, std::size_t Out>
    std::array<double, Out> layer(const std::array<double, In>& in, std::size_t first,
                                  bool rectified) const {
        std::array<double, Out> out;
        for (std::size_t o = 0; o < Out; ++o) {
            double sum = w_[first + In * Out + o];
            for (std::size_t i = 0; i < In; ++i) sum += in[i] * w_[first + i * Out + o];
            out[o] = rectified ? std::max(sum, 0.0) : sum;
        }
        return out;
    }

    std::array<float, 675> w_{};
};

/// Pairs with their weights, f at each, and the values of an approximation: [channel][pair].
struct Comparison {
    std::vector<DirectionPair> pairs;
    std::vector<double> cosines, weights, f;

    void add(const DirectionPair& pair, double weight) {
        pairs.push_back(pair);
        cosines.push_back(pair.wi.z);
        weights.push_back(weight);
    }
    template <typename At>
    std::vector<double> values(const At& at) const {
        std::vector<double> out(3 * pairs.size());
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            const auto value = at(pairs[k].wi, pairs[k].wo);
            for (std::size_t c = 0; c < 3; ++c) out[c * pairs.size() + k] = value[c];
        }
        return out;
    }
    /// Every metric of the table; prints them as a row of docs/explanation/halfway.md.
    double print(const std::string& name, const std::string& what, std::size_t bytes,
                 const std::vector<double>& g) const {
        double result = 0;
        std::printf("| %s | %s | %zu |", name.c_str(), what.c_str(), bytes);
        for (const MetricValue& m : compareSamples(f, g, cosines, weights)) {
            if (!m.value) continue;
            if (m.metric->name == "nbrdf") result = *m.value;
            for (const char* shown : {"nbrdf", "log", "relative-l2-cosine", "ngan"}) {
                if (m.metric->name == shown) std::printf(" %s %.4g |", shown, *m.value);
            }
        }
        std::printf("\n");
        return result;
    }
    std::vector<double> of(const Representation& r) const {
        const HalfwayExpansion expansion(r);
        return values([&](const Direction& wi, const Direction& wo) {
            std::array<double, 3> out{};
            expansion.evaluate(wo, {&wi.x, &wi.y, &wi.z, 1}, out.data());
            return out;
        });
    }
};

std::string text(const HalfwayOrders& o) {
    return std::to_string(o.half) + "," + std::to_string(o.difference) + "," +
           std::to_string(o.azimuth);
}

/// As files store it: rounding that makes up for itself.
Representation stored(Representation r, Precision precision, const Brdf& brdf) {
    quantiseHalfway(r, precision, brdf);
    return r;
}

TEST(HalfwayMaterials, MeasuredOnesAreCloserThanPublishedNetworksInFewerBytes) {
    if (!std::filesystem::exists(data + "/nbrdf")) GTEST_SKIP() << data << "/nbrdf is absent";
    Comparison comparison;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto uniform = [&] {
        const double z = 1 - unit(random), turn = 2 * pi * unit(random), r = std::sqrt(1 - z * z);
        return Direction{r * std::cos(turn), r * std::sin(turn), z};
    };
    for (int k = 0; k < 20000; ++k) {
        const Direction wi = uniform();
        comparison.add({wi, uniform()}, 1);
    }
    for (const std::string name :
         {"cc_ibiza_sunset_rgb", "cg_sunflower_rgb", "paper_white_rgb", "satin_rosaline_rgb"}) {
        const auto brdf = brdfs::open(data + "/rgl/" + name + ".bsdf");
        const auto network = Network::read("rgl-isotropic", name);
        ASSERT_TRUE(network) << name;
        comparison.f = comparison.values(
            [&](const Direction& wi, const Direction& wo) { return evaluate(*brdf, wi, wo); });
        const double theirs = comparison.print(name, "network", 2700, comparison.values(*network));
        const Representation r = projectHalfway(*brdf, {});
        for (const Precision p :
             {Precision::float32, Precision::half, Precision::unorm16, Precision::unorm8}) {
            const Representation q = stored(r, p, *brdf);
            const double ours =
                comparison.print(name, text(r.halfway) + " " + std::string(precisionName(p)),
                                 q.bytes(), comparison.of(q));
            if (p == Precision::half || p == Precision::unorm8) {
                EXPECT_LE(q.bytes(), 1024U);
            }
            EXPECT_LT(ours, 0.8 * theirs) << name << " " << precisionName(p);
        }
    }
}

TEST(HalfwayMaterials, PlanesOfMerlBesideNetworks) {
    if (!std::filesystem::exists(data + "/merl_slices")) GTEST_SKIP() << data << " is absent";
    // The nodes of the table; the measure d wi d wo is 4 cos(theta_d) d h d d.
    Comparison comparison;
    for (int d = 0; d < 90; ++d) {
        for (int h = 1; h < 90; ++h) {
            const double th = radians(90.0 * h * h / 8100), td = radians(d);
            comparison.add(fromHalfDifference(th, 0, td, pi / 2),
                           h * std::sin(th) * std::sin(td) * std::cos(td));
        }
    }
    int closer = 0;
    for (const std::string name :
         {"alum-bronze", "chrome-steel", "gold-metallic-paint3", "black-obsidian", "red-phenolic",
          "white-acrylic", "pearl-paint", "fruitwood-241", "green-latex", "pink-fabric"}) {
        const auto brdf = brdfs::open(data + "/merl_slices/" + name + ".slice");
        const auto network = Network::read("merl", name);
        ASSERT_TRUE(network) << name;
        comparison.f = comparison.values(
            [&](const Direction& wi, const Direction& wo) { return evaluate(*brdf, wi, wo); });
        const double theirs = comparison.print(name, "network", 2700, comparison.values(*network));
        const Representation q =
            stored(projectHalfway(*brdf, {}, {}, true), Precision::half, *brdf);
        const double ours =
            comparison.print(name, text(q.halfway) + " half", q.bytes(), comparison.of(q));
        EXPECT_LE(q.bytes(), 1024U);
        if (ours < theirs) ++closer;
    }
    EXPECT_GE(closer, 9);
}

TEST(HalfwayMaterials, LobesConvergeWithOrder) {
    for (const std::string spec :
         {"ggx:alpha=0.03", "ggx:alpha=0.1", "ggx:alpha=0.4", "ward:ax=0.05,ay=0.05",
          "ward:ax=0.3,ay=0.3", "ward:ax=0.1,ay=0.3", "blinn-phong:exponent=20",
          "blinn-phong:exponent=500"}) {
        const auto brdf = brdfs::open(spec);
        const ProjectionOptions options{.maxEvaluations = 1 << 14};
        double before = 1;
        std::printf("%s:", spec.c_str());
        for (const HalfwayOrders& orders :
             {HalfwayOrders{2, 1, 1}, HalfwayOrders{5, 4, 3}, HalfwayOrders{7, 6, 5}}) {
            const double error = projectHalfway(*brdf, orders, options).steps[0].change;
            std::printf(" %.5f", error);
            // With one term masking halves the loss of GGX, which is then exact; with more it does
            // not, and the form goes without.
            EXPECT_LT(error, std::max(before, 5e-4)) << spec;
            before = error;
        }
        std::printf("\n");
    }
}

}  // namespace
}  // namespace hshfit
