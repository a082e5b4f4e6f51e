// Commands that state the error of one form agree with each other, with independent samples, and
// with quadratures that know nothing of the pairs, within the errors that they state.

#include "json_answers.h"
#include "places.h"

#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <brdfs/catalog.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

/// Standard errors of eight replicates: Student's t of 99.9 % with 7 degrees of freedom.
constexpr double sigmas = 5.4;

/// Models and, where shared data is, measured materials: a diffuse one, a rough metal, a cloth; the
/// last test has a plastic and a satin.
std::vector<std::string> materials() {
    std::vector<std::string> all{"ggx:alpha=.2,kd=.1", "eon:roughness=.6",
                                 "ward:kd=.2,ks=.3,ax=.15,ay=.15", "blinn-phong:exponent=60,kd=.2"};
    const std::string data = test::sharedFolder() + "/data/";
    for (const char* file : {"rgl/paper_white_rgb.bsdf", "merl_slices/alum-bronze.slice",
                             "merl_slices/pink-fabric.slice"}) {
        if (fs::exists(data + file)) all.push_back(data + file);
    }
    return all;
}

class Agreement : public JsonAnswers {
protected:
    std::unique_ptr<RepresentedBrdf> made(const std::string& file) const {
        return reconstruct(readRepresentation(file),
                           [](const std::string& spec) { return brdfs::open(spec); });
    }
};

double metricOf(const Json& compared, const std::string& name, const char* key = "value") {
    for (const Json& row : compared["metrics"]) {
        if (row["name"] == name) return row[key];
    }
    ADD_FAILURE() << "no metric " << name;
    return 0;
}

void expectAgreement(const Json& a, const Json& b, double error, const std::string& what) {
    const double both = std::hypot(a["error"].get<double>(), error);
    EXPECT_NEAR(a["value"], b.is_number() ? b.get<double>() : b["value"].get<double>(),
                sigmas * both)
        << what;
}

TEST_F(Agreement, OfTheHalfwayFormInEveryCommand) {
    const std::string file = path("form.json");
    for (const std::string& spec : materials()) {
        const std::string precision = spec.starts_with("ggx") ? "unorm8" : "half";
        SCOPED_TRACE(spec + " " + precision);
        const Json own = answerOf("project " + spec +
                                  " --form halfway --halfway 6,3,2 --reciprocal --precision " +
                                  precision + " -o " + file)["pairs"];
        const Json compared = answerOf("compare " + spec + " " + file + " --outgoing 24");
        EXPECT_EQ(compared["pairs"], own);
        const std::string sweep = "tradeoff " + spec +
                                  " --forms halfway --halfway 6,3,2 --split none --no-timing "
                                  "--precisions " +
                                  precision;
        const auto pairsOf = [](const Json& trade) {
            Json found;
            for (const Json& each : trade["tradeoffs"][0]["forms"]) {
                const bool reciprocal =
                    each["options"].get<std::string>().find("reciprocal") != std::string::npos;
                if (found.is_null() || reciprocal) found = each["pairs"];
            }
            return found;
        };
        // A sample of other directions for wi: the means move within their errors.
        const Json same = pairsOf(answerOf(sweep)),
                   other = pairsOf(answerOf(sweep + " --pair-count 20000"));
        EXPECT_NEAR(same["mean_log"]["value"], own["mean_log"]["value"], 1e-12);
        EXPECT_NEAR(same["maximum"]["value"], own["maximum"]["value"], 1e-9);
        EXPECT_NE(other["count"], own["count"]);
        for (const char* key : {"mean_log", "relative_l2", "energy_left", "horizon", "mirror"}) {
            expectAgreement(own[key], other[key], other[key]["error"], key);
        }
        // A quadrature over 24 elevations down to 1 degree above the horizon.
        expectAgreement(own["mean_log"], metricOf(compared, "nbrdf"),
                        metricOf(compared, "nbrdf", "error") + 0.02 * metricOf(compared, "nbrdf"),
                        "nbrdf");
    }
}

/// The albedo that is off by most, integrated at elevations of the stratum that it is said to be
/// in, and the maximum, evaluated at the pair where it is said to be.
TEST_F(Agreement, OfAlbedoAndMaximumWithWhatTheyAreSaidToBe) {
    const std::string file = path("form.json");
    // Every third: two models, a measured material if there is one.
    const std::vector<std::string> all = materials();
    for (std::size_t k = 0; k < all.size(); k += 3) {
        const std::string& spec = all[k];
        SCOPED_TRACE(spec);
        const Json own = answerOf(
            "project " + spec +
            " --form halfway --halfway 6,3,2 --reciprocal --precision half -o " + file)["pairs"];
        const auto brdf = brdfs::open(spec);
        const auto form = made(file);
        const auto place = [&](const char* key) {
            const Json& d = own["maximum"][key];
            return directionFromAngles(radians(d["theta"]), radians(d["phi"]));
        };
        const Direction wi = place("wi"), wo = place("wo");
        const auto f = evaluate(*brdf, wi, wo), g = evaluate(*form, wi, wo);
        double largest = 0;
        for (std::size_t c = 0; c < f.size(); ++c)
            largest = std::max(largest, std::abs(g[c] - f[c]) * wi.z);
        EXPECT_NEAR(largest, own["maximum"]["value"], 1e-2 * largest);

        const double from = std::cos(radians(own["albedo"]["theta_o"][0])),
                     to = std::cos(radians(own["albedo"]["theta_o"][1]));
        constexpr int elevations = 8;
        std::vector<double> off(f.size());
        for (int e = 0; e < elevations; ++e) {
            const double mu = to + (from - to) * (e + 0.5) / elevations;
            const Direction o = directionFromAngles(std::acos(mu), 0);
            const AlbedoOptions options{.tolerance = 1e-3, .maxEvaluations = 1 << 18};
            const auto a = estimateAlbedo(*brdf, o, options), b = estimateAlbedo(*form, o, options);
            for (std::size_t c = 0; c < off.size(); ++c)
                off[c] += (b.values[c] - a.values[c]) / elevations;
        }
        double most = 0;
        for (const double value : off) most = std::max(most, std::abs(value));
        expectAgreement(own["albedo"], most, 0.01 * own["albedo"]["of"].get<double>(), "albedo");
    }
}

/// The file of a plan, as `compare` finds it.
TEST_F(Agreement, OfAPlanWithTheFileThatItWrites) {
    write("scene.json", R"({"format": "hshfit-scene", "version": 1,
        "materials": [{"name": "metal", "brdf": "ggx:alpha=.15"}],
        "lights": [{"kind": "disc", "theta": 30, "angular_diameter": 10, "irradiance": 3}],
        "budget": {"metric": "relative_l2", "error": 0.1}})");
    const Json plan = answerOf("plan " + path("scene.json") + " -o " + path("plan"));
    const Json choice = plan["materials"][0]["choice"];
    EXPECT_NE(choice["command"].get<std::string>().find("halfway"), std::string::npos);
    EXPECT_EQ(answerOf("compare ggx:alpha=.15 " +
                       path("plan/" + choice["file"].get<std::string>()))["pairs"],
              choice["pairs"]);
}

/// The options of a choice of `plan` as options of `tradeoff`, which are lists.
std::string asSweep(const std::string& options) {
    std::string sweep = " ";
    std::istringstream words(options);
    bool isForm = false;
    for (std::string word; words >> word;) {
        if (word == "--reciprocal") continue;
        for (const auto& [one, many] : {std::pair{"--basis", "--bases"},
                                        {"--order", "--orders"},
                                        {"--rank", "--ranks"},
                                        {"--form", "--forms"},
                                        {"--precision", "--precisions"}})
            if (word == one) word = many;
        isForm |= word == "--forms";
        sweep += word + " ";
    }
    return sweep + (isForm ? "" : "--forms outgoing ") + "--no-timing";
}

/// Measured materials from a scene to every command that states the errors of their forms: the
/// command of the plan is run, its file compared, and its options swept with pairs of its own.
TEST_F(Agreement, OfPlanProjectCompareAndTradeoffOnMeasuredMaterials) {
    const std::string data = test::sharedFolder() + "/data/";
    if (!fs::exists(data + "rgl")) GTEST_SKIP() << data << " is absent";
    Json materials = Json::array();
    for (const char* file : {"rgl/paper_white_rgb.bsdf", "rgl/satin_rosaline_rgb.bsdf",
                             "merl_slices/red-plastic.slice"})
        materials.push_back({{"name", fs::path(file).stem().string()}, {"brdf", data + file}});
    const Json scene = {
        {"format", "hshfit-scene"},
        {"version", 1},
        {"materials", materials},
        {"lights",
         {{{"kind", "disc"}, {"theta", 30}, {"angular_diameter", 10}, {"irradiance", 3}}}},
        {"budget", {{"metric", "log"}, {"error", 0.05}}}};
    write("scene.json", scene.dump());
    const Json plan = answerOf("plan " + path("scene.json") + " -o " + path("plan"));
    ASSERT_EQ(plan["materials"].size(), 3U);
    for (const Json& material : plan["materials"]) {
        const Json& choice = material["choice"];
        const std::string spec = choice["brdf"], options = choice["options"];
        SCOPED_TRACE(spec + " " + options);
        const Json planned = choice["pairs"];
        EXPECT_EQ(answerOf("compare " + spec + " " +
                           path("plan/" + choice["file"].get<std::string>()))["pairs"],
                  planned);
        const std::string command = choice["command"], file = path("again.json");
        const std::size_t from = std::string("hshfit ").size(), to = command.find(" -o ");
        const Json projected = answerOf(command.substr(from, to - from) + " -o " + file);
        if (projected.contains("pairs")) {
            EXPECT_EQ(projected["pairs"], planned);
        }
        EXPECT_EQ(answerOf("compare " + spec + " " + file)["pairs"], planned);
        const Json swept = answerOf("tradeoff " + spec + asSweep(options) +
                                    " --pair-count 20000")["tradeoffs"][0]["forms"];
        const auto same = std::ranges::find_if(
            swept, [&](const Json& form) { return form["bytes"] == choice["bytes"]; });
        ASSERT_NE(same, swept.end()) << swept;
        const Json other = (*same)["pairs"];
        EXPECT_NE(other["count"], planned["count"]);
        for (const char* key : {"mean_log", "relative_l2", "energy_left", "horizon", "mirror"})
            expectAgreement(planned[key], other[key], other[key]["error"], key);
    }
}

}  // namespace
}  // namespace hshfit::test
