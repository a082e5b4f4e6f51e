// Jobs that examine, compare, fit and draw give the numbers and the files of the program.

#include "job_fixture.h"

#include <hshfit/error.h>
#include <hshfit/pages/comparison.h>
#include <hshfit/plan/plan_files.h>
#include <hshfit/tradeoff/tradeoff_files.h>
#include <hshfit/wording.h>

#include <cli/wording.h>
#include <jobs/exports/export.h>
#include <jobs/exports/sample.h>
#include <jobs/fits/gaussians.h>
#include <jobs/fits/ltc.h>
#include <jobs/lighting/rotate.h>
#include <jobs/scenes/plan.h>
#include <jobs/scenes/render.h>
#include <jobs/scenes/spheres.h>
#include <jobs/studies/compare.h>
#include <jobs/studies/eval.h>
#include <jobs/studies/import.h>
#include <jobs/studies/info.h>
#include <jobs/studies/plot.h>
#include <jobs/studies/project.h>
#include <jobs/studies/stress.h>
#include <jobs/studies/tradeoff.h>

#include <nlohmann/json.hpp>

#include <set>
#include <vector>

namespace {

using namespace hshfit;
using nlohmann::json;

class Studies : public test::JobFiles {
protected:
    /// The files name calls of the library as the program words them.
    static void SetUpTestSuite() { setWording(cli::optionWording()); }
};

TEST_F(Studies, EvalWritesTheTableOfTheProgram) {
    write("pairs.csv",
          "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,name\n0,0,1,0.6,0,0.8,a\n0.6,0,0.8,0,0.6,.8,b\n");
    const std::string spec = "ward:kd=.1/.2/.3,ks=.2,ax=.2,ay=.5";
    const jobs::EvaluatedPairs all =
        jobs::evaluatePairs(spec, path("job.csv"), {.cosine = true, .pairs = path("pairs.csv")});
    const std::string& csv = all.csv;
    EXPECT_EQ(all.count, 2u);
    EXPECT_EQ(all.facts.values.size(), 6u);
    EXPECT_EQ(csv, runProgram("eval " + spec + " --cosine --pairs " + path("pairs.csv")));
    EXPECT_EQ(read(path("job.csv")), csv);
    const jobs::EvalOptions pair{.wi = jobs::Angles{0, 0}, .wo = jobs::Angles{20, 10}};
    const jobs::Evaluated one = jobs::evaluatePair(spec, pair);
    EXPECT_EQ(one.channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(one.values.size(), 3u);
    EXPECT_THROW(jobs::evaluatePair(spec, {.wi = jobs::Angles{0, 0}}), UsageError);
    EXPECT_THROW(jobs::evaluatePair(spec, {.wi = pair.wi, .wo = jobs::Angles{100, 0}}), UsageError);
    write("angles.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,1,45,0,0\n");
    EXPECT_THROW(jobs::evaluatePairs(spec, "", {.pairs = path("angles.csv")}), InputError);
}

TEST_F(Studies, InfoHasTheFactsOfTheProgram) {
    const jobs::BrdfInfo info = jobs::describeSource("ggx:alpha=.4");
    const json answer = json::parse(runProgram("info ggx:alpha=.4 --json"));
    EXPECT_EQ(answer["name"], info.brdf->name());
    EXPECT_EQ(answer["range"]["min"], info.least);
    EXPECT_EQ(answer["range"]["max"], info.greatest);
    ASSERT_TRUE(info.health);
    EXPECT_EQ(answer["health"]["largest_albedo"], info.health->largestAlbedo());
    EXPECT_EQ(answer["albedo"].size(), info.health->albedos.size());
    EXPECT_FALSE(info.coefficients);

    jobs::project("ggx:alpha=.4", path("c.json"), {.order = 3, .outgoing = "4"});
    const jobs::BrdfInfo stored = jobs::describeSource(path("c.json"));
    ASSERT_TRUE(stored.coefficients);
    EXPECT_EQ(stored.coefficients->order, 3);
    EXPECT_FALSE(stored.exported);
}

TEST_F(Studies, InfoOfLightHasTheHealthOfTheProgram) {
    const std::string spec = "sky:type=12,elevation=40";
    const jobs::LightInfo info = jobs::describeLight(spec);
    const json answer = json::parse(runProgram("info " + spec + " --json"));
    EXPECT_EQ(answer["lights"].size(), info.lights.size());
    EXPECT_EQ(answer["light_health"]["mean"], json(info.health.mean));
    EXPECT_EQ(answer["light_health"]["brightest_share"], info.health.brightestShare);
}

TEST_F(Studies, CompareWritesThePageOfTheProgram) {
    const jobs::Compared compared =
        jobs::compare("lambert:kd=.5", "lambert:kd=.4", path("job"), {.outgoing = "2"});
    const json answer = json::parse(runProgram(
        "compare lambert:kd=.5 lambert:kd=.4 --outgoing 2 --json -o " + path("program")));
    EXPECT_EQ(filesIn("job"), filesIn("program"));
    EXPECT_EQ(compared.files.size(), filesIn("job").size());
    ASSERT_EQ(answer["metrics"].size(), compared.metrics.size());
    for (std::size_t k = 0; k < compared.metrics.size(); ++k) {
        const auto& value = compared.metrics[k].value;
        EXPECT_EQ(answer["metrics"][k]["value"], value ? json(*value) : json());
    }
    ASSERT_TRUE(compared.pairs);
    EXPECT_EQ(answer["outgoing"], compared.outgoing.spec());
}

TEST_F(Studies, LtcWritesTheTableOfTheProgram) {
    const jobs::FittedLtc fitted = jobs::fitLtc("ggx", {path("job.json")}, {.size = 2});
    EXPECT_EQ(fitted.files, std::vector<std::string>{path("job.json")});
    runProgram("ltc ggx --size 2 -o " + path("program.json"));
    EXPECT_FALSE(read(path("job.json")).empty());
    EXPECT_EQ(read(path("job.json")), read(path("program.json")));
}

TEST_F(Studies, GaussiansWritesTheMixtureOfTheProgram) {
    const jobs::FittedGaussians fitted =
        jobs::fitGaussians("ggx:alpha=.5", path("job.json"),
                           {.fit = {.lobes = 1}, .outgoing = "2", .metrics = "relative-l2"});
    const json answer = json::parse(runProgram(
        "gaussians ggx:alpha=.5 --lobes 1 --outgoing 2 --metrics relative-l2 --json -o " +
        path("program.json")));
    EXPECT_EQ(read(path("job.json")), read(path("program.json")));
    EXPECT_EQ(answer["mean_error"], fitted.meanError);
    ASSERT_EQ(fitted.metrics.size(), 1u);
    EXPECT_EQ(answer["metrics"][0]["value"], *fitted.metrics[0].value);
}

TEST_F(Studies, TradeoffWritesTheFilesOfTheProgram) {
    jobs::TradeoffOptions options{.pairCount = 512, .writePairs = path("job.csv")};
    options.measurement.timing = false;
    options.sweep.forms = {"outgoing"};
    options.sweep.bases = {"hsh"};
    options.sweep.orders = {2, 3};
    options.sweep.outgoing = {"4"};
    options.sweep.ranks = {0};
    const std::string spec = "ggx:alpha=.4";
    const jobs::MeasuredTradeoffs measured = jobs::measureTradeoffs({spec}, path("job"), options);
    ASSERT_EQ(measured.trades.size(), 1u);
    const std::string out =
        runProgram("tradeoff " + spec +
                   " --no-timing --forms outgoing --bases hsh --orders 2,3 --outgoing 4 --ranks 0 "
                   "--pair-count 512 --json -o " +
                   path("program") + " --write-pairs " + path("program.csv"));
    EXPECT_EQ(tradeoff::tradeoffJson(measured.trades, true), out);
    EXPECT_FALSE(filesIn("job").empty());
    EXPECT_EQ(filesIn("job"), filesIn("program"));
    EXPECT_EQ(read(path("job.csv")), read(path("program.csv")));
    EXPECT_THROW(jobs::measureTradeoffs({spec, "lambert"}, path("two"), options), UsageError);
}

TEST_F(Studies, PlanWritesTheFilesOfTheProgram) {
    write("scene.json", R"({"format": "hshfit-scene", "version": 1,
        "materials": [{"name": "wall", "brdf": "lambert:kd=0.5", "orientations": [{"theta": 0}]}],
        "lights": [{"kind": "sky", "model": "uniform", "radiance": 1}],
        "views": {"theta": [0, 60]}, "budget": {"metric": "relative_l2", "error": 0.05}})");
    std::vector<std::string> remarks;
    const jobs::Listener listener{
        .note = [&](const std::string& said) { remarks.push_back(said); }};
    const plan::Plan made = jobs::planScene(path("scene.json"), path("job"),
                                            {.bases = {"hsh"}, .maxOrder = 3}, listener);
    const std::string out = runProgram("plan " + path("scene.json") +
                                       " --bases hsh --max-order 3 --json -o " + path("program"));
    EXPECT_EQ(plan::planJson(made), out);
    EXPECT_EQ(filesIn("job").count("wall.json"), 1u);
    EXPECT_EQ(filesIn("job"), filesIn("program"));
    ASSERT_EQ(remarks.size(), 1u);
    EXPECT_TRUE(remarks[0].starts_with("wall: so far ")) << remarks[0];
}

TEST_F(Studies, StressWritesTheTablesOfTheProgram) {
    const stability::StressReport report =
        jobs::stress(path("job"), {.lobes = {"lambert"}, .bases = "hsh", .maxOrder = 3});
    EXPECT_EQ(report.projection.front().brdf, "lambert");
    EXPECT_TRUE(report.statedErrors.empty());
    runProgram("stress lambert --bases hsh --max-order 3 -o " + path("program"));
    EXPECT_EQ(filesIn("job").size(), 3u);
    EXPECT_EQ(filesIn("job"), filesIn("program"));
}

TEST_F(Studies, SampleWritesTheDirectionsOfTheProgram) {
    jobs::sample("ggx:alpha=.3", path("job.csv"),
                 {.outgoing = directionFromAngles(radians(40), radians(30)),
                  .count = 20,
                  .elevations = 0,
                  .trials = 10});
    runProgram("sample ggx:alpha=.3 --outgoing 40,30 --count 20 --elevations 0 --trials 10 -o " +
               path("program.csv"));
    EXPECT_EQ(read(path("job.csv")), read(path("program.csv")));
}

TEST_F(Studies, ImportWritesTheCoefficientsOfTheProgram) {
    jobs::project("ggx:alpha=.4", path("ggx.json"), {.order = 3, .outgoing = "4"});
    const jobs::Exported exported = jobs::exportCoefficients(
        path("ggx.json"), path("exported"), {.targets = "ktx2", .measureError = false});
    const std::string sidecar = path("exported/" + exported.sidecar);
    const jobs::Imported imported = jobs::importCoefficients(sidecar, path("job.json"), {});
    EXPECT_EQ(imported.bytes, read(path("job.json")).size());
    runProgram("import " + sidecar + " -o " + path("program.json"));
    EXPECT_EQ(read(path("job.json")), read(path("program.json")));
    EXPECT_THROW(jobs::importCoefficients(sidecar, path("job.json"), {}), OutputError);
    jobs::importCoefficients(sidecar, path("job.json"), {.force = true});
}

TEST_F(Studies, MatrixHasTheNumbersOfTheProgram) {
    const auto rows = jobs::matrix({.from = "sh", .to = "hsh", .order = 2, .fromOrder = 3});
    const json answer = json::parse(runProgram("matrix sh hsh --order 2 --from-order 3 --json"));
    EXPECT_EQ(rows.size(), 4u);
    EXPECT_EQ(answer["matrix"], json(rows));
}

TEST_F(Studies, PlotDrawsTheFigureOfTheProgram) {
    const jobs::Plotted plotted = jobs::plot("hsh", path("job.svg"), {.order = 2});
    EXPECT_EQ(plotted.functions, 4);
    runProgram("plot hsh --order 2 -o " + path("program.svg"));
    EXPECT_FALSE(read(path("job.svg")).empty());
    EXPECT_EQ(read(path("job.svg")), read(path("program.svg")));
}

TEST_F(Studies, SpheresAreThePictureOfTheProgram) {
    std::set<std::string> parts;
    const jobs::Listener listener{.begin = [&](const std::string& part) {
        parts.insert(part);
        return jobs::ProgressCall();
    }};
    for (const std::string extension : {".png", ".exr"}) {
        const jobs::SphereSheet sheet =
            jobs::render({"lambert:kd=.5", "ggx:alpha=.4"}, path("job" + extension),
                         jobs::SphereSheetOptions{.size = 16}, listener);
        ASSERT_EQ(sheet.spheres.size(), 2u);
        EXPECT_EQ(sheet.spheres[1].column, 16u);
        EXPECT_EQ(parts.count(sheet.spheres[0].brdf), 1u);
        runProgram("render lambert:kd=.5 ggx:alpha=.4 --size 16 -o " + path("program" + extension));
        EXPECT_FALSE(read(path("job" + extension)).empty());
        EXPECT_EQ(read(path("job" + extension)), read(path("program" + extension)));
    }
}

TEST_F(Studies, SlowIntegrationNamesTheOptionsThatEndItSooner) {
    jobs::RenderOptions options;
    options.tolerance = 0.01;
    // A tenth of the steps in 12 s: nine tenths are left, 108 s.
    const std::string remark = jobs::slowRemark("lambert", 12, 10, 100, options);
    EXPECT_NE(remark.find("lambert: integration has taken 12 s"), std::string::npos) << remark;
    for (const char* part : {"108 s more", "--tolerance above 0.01", "--seconds"})
        EXPECT_NE(remark.find(part), std::string::npos) << remark;
    EXPECT_EQ(jobs::slowRemark("lambert", 12, 90, 100, options), "");  // 1.3 s left
    options.seconds = 60;
    EXPECT_EQ(jobs::slowRemark("lambert", 12, 10, 100, options), "");
}

}  // namespace
