// Every real file of the shared data from the command line: info, report, and there and back in a
// format that holds it.

#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <ostream>
#include <string>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;
namespace fs = std::filesystem;

struct RealFile {
    const char* path;       ///< below ../shared/data
    const char* options;    ///< of the conversion
    const char* extension;  ///< converted to; the same format where there is a writer for it
    /// Largest relative L2 difference (with the cosine) after the round trip, at theta_o = 30: what
    /// the target's own sampling costs.
    double loss;
};

std::ostream& operator<<(std::ostream& out, const RealFile& file) {
    return out << file.path;
}

class RealFiles : public Cli, public testing::WithParamInterface<RealFile> {
protected:
    void SetUp() override {
        Cli::SetUp();
        source_ = hshfit::test::sharedFolder() + "/data/" + GetParam().path;
        if (!fs::exists(source_)) GTEST_SKIP() << source_ << " is not there";
    }
    std::string source_;
};

TEST_P(RealFiles, hasAHealthReport) {
    const Answer answer = run("info --json " + source_);
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "info"));
    const Json info = Json::parse(answer.out);
    const Json& health = info["health"];
    EXPECT_EQ(health["not_finite"], 0);
    EXPECT_GT(health["coverage"], 0.0);
    EXPECT_LE(health["coverage"], 1.0);
    EXPECT_GT(health["largest_albedo"], 0.01);
    EXPECT_LT(health["largest_albedo"], 3.0);
    if (info["laws"]["non_negative"]) {
        EXPECT_EQ(health["negative"], 0);
    }
    if (info["laws"]["reciprocal"]) {
        EXPECT_LT(health["reciprocity"]["defect"], 1e-9);
    }
    if (!info.contains("census")) return;  // an analytic fit stores no samples
    const Json& census = info["census"];
    EXPECT_GT(census["values"], 0);
    EXPECT_EQ(census["nan"], 0);
    EXPECT_EQ(census["infinite"], 0);
    EXPECT_GT(census["greatest"], 0.0);
    EXPECT_FALSE(info["axes"].empty());
    for (const Json& axis : info["axes"]) {
        EXPECT_GT(axis["count"], 0) << axis;
        EXPECT_LE(axis["first"], axis["last"]) << axis;
    }
}

TEST_P(RealFiles, hasAReport) {
    const Answer answer = run("report --json --cosine --outgoing 30,0 --max-order 4 " + source_);
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "report"));
    for (const Json all = Json::parse(answer.out);
         const Json& curve : all["reports"][0]["curves"]) {
        double before = 0;
        for (const Json& point : curve["points"]) {
            EXPECT_GE(point["accuracy"], before - 1e-9) << curve["basis"];
            EXPECT_LE(point["accuracy"], 1 + 1e-2) << curve["basis"];
            before = point["accuracy"];
        }
        EXPECT_GT(before, 0) << curve["basis"];
    }
}

TEST_P(RealFiles, survivesTheRoundTrip) {
    const RealFile& file = GetParam();
    const std::string out = path(std::string("there") + file.extension);
    const Answer answer = run("convert --json --report-loss --outgoing 30,0 " +
                              std::string(file.options) + " " + source_ + " " + out);
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "convert"));
    for (const Json all = Json::parse(answer.out); const Json& metric : all["loss"]["metrics"]) {
        if (metric["name"] != "relative-l2-cosine") continue;
        ASSERT_TRUE(metric["value"].is_number()) << metric;
        EXPECT_LE(metric["value"], file.loss);
        std::printf("%s to %s: relative L2 %.3g\n", file.path, file.extension,
                    metric["value"].get<double>());
    }
}

const RealFile files[] = {
    {"alta/data-example-01.exr", "", ".exr", 1e-3},
    {"alta/nonlinear-example-01.brdf", "", ".binary", 1e-3},
    {"alta/pink-felt-1d.alta", "", ".binary", 1e-2},
    {"alta/retro-gray-tape.dat", "", ".alta", 1e-6},
    {"bsdf_xml/2011-SA1.xml", "", ".xml", 1e-5},
    {"bsdf_xml/klems_aniso_high.xml", "", ".xml", 1e-5},
    {"bsdf_xml/blinds_20deg_t45.xml", "--to bsdf-tree", ".xml", 1e-5},
    {"cornell/cayman.brdf", "--rgb --repair negative", ".binary", 0.02},
    {"cornell/garnet_red.brdf", "--rgb --repair negative", ".binary", 0.01},
    {"cornell/mystique.brdf", "", ".bsdf", 0.2},
    {"merl_slices/alum-bronze.slice", "", ".binary", 1e-5},
    {"merl_slices/pink-fabric.slice", "", ".exr", 1e-2},
    {"nist_ptfe/PTFE.coeff.csv", "", ".bsdf", 1e-2},
    {"nist_ptfe/PTFE.data.csv", "", ".bsdf", 1e-2},
    {"rgl/cc_ibiza_sunset_rgb.bsdf", "", ".bsdf", 1e-6},
    {"rgl/cg_sunflower_rgb.bsdf", "", ".bsdf", 1e-6},
    {"rgl/paper_white_rgb.bsdf", "", ".bsdf", 1e-6},
    {"rgl/satin_rosaline_rgb.bsdf", "", ".bsdf", 1e-6},
    {"rgl/spectralon_lowres.pbsdf", "", ".bsdf", 0.02},
};

INSTANTIATE_TEST_SUITE_P(Shared, RealFiles, testing::ValuesIn(files), [](const auto& each) {
    std::string name = each.param.path;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
});

}  // namespace
