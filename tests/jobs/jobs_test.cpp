// Jobs write the files that the program writes, byte for byte, and tell a listener what they do.

#include "job_fixture.h"

#include <hshfit/error.h>
#include <hshfit/pages/report.h>

#include <jobs/common/inputs.h>
#include <jobs/exports/export.h>
#include <jobs/fits/fit.h>
#include <jobs/source/quality.h>
#include <jobs/source/source.h>
#include <jobs/studies/project.h>
#include <jobs/studies/report.h>

#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <set>
#include <thread>

namespace {

using namespace hshfit;

class Jobs : public test::JobFiles {};

/// By hand: a call for each kind of fault, and none that is not better by its measure.
TEST(JudgeFit, NamesWhatIsBetterByTheMeasureThatIsPoor) {
    const auto lookedAt = [](double flip) {
        PictureError picture{.channels = {"grey"}, .albedo = {0}, .lastAlbedo = {0}};
        picture.flip.mean = flip;
        return picture;
    };
    jobs::FitCall call{.data = "d.binary",
                       .model = "ggx",
                       .explained = 0.8,
                       .relativeError = 0.1,
                       .loss = "picture"};
    std::vector<jobs::TriedFit> fits{
        {.model = "ggx+eon", .explained = 0.99, .flip = 0.15},
        {.model = "ggx", .loss = "log", .explained = 0.999, .flip = 0.12, .factor = 1.5}};
    const auto has = [](const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    };
    std::size_t tried = 0;
    const auto betterOf = [&](double flip) {
        const auto poor = judgeFit(lookedAt(flip), call, [&] {
            ++tried;
            return fits;
        });
        if (!poor) return std::string();
        // A fit that was not made is only to try.
        EXPECT_EQ(poor->toTry.empty(),
                  has(poor->reason, " in place of ") || has(poor->reason, " explains "))
            << poor->reason;
        return poor->reason + "|" + poor->better + poor->toTry;
    };
    EXPECT_EQ(betterOf(0.05), "");
    EXPECT_EQ(tried, 0U);
    // The least FLIP, of another loss; not where it is lower by less than a tenth.
    EXPECT_TRUE(has(betterOf(0.3), "ggx by the loss log has FLIP 0.12 in place of 0.3"));
    EXPECT_TRUE(has(betterOf(0.3), "FitOptions::loss = log"));
    EXPECT_TRUE(has(betterOf(0.13), "halfway.json")) << betterOf(0.13);
    call.otherwise = "more measurements";
    EXPECT_TRUE(has(betterOf(0.13), "|more measurements")) << betterOf(0.13);
    // Pictures are good and the energy is not: the loss of energy, or a model that explains more.
    call.relativeError = 1.5;
    EXPECT_TRUE(has(betterOf(0.05), "FitOptions::loss = cosine"));
    call.relativeError = 0.5;
    EXPECT_TRUE(has(betterOf(0.05), "ggx+eon 99 %")) << betterOf(0.05);
    // Samples of many decades.
    call.factor = 30;
    EXPECT_TRUE(has(betterOf(0.05), "a factor of 1.5 in place of 30")) << betterOf(0.05);
    // A model that is 0 at half of the samples, too, is no better.
    call.factor = std::numeric_limits<double>::infinity();
    fits[1].factor = call.factor;
    call.otherwise = "more measurements";
    EXPECT_TRUE(has(betterOf(0.05), "|more measurements")) << betterOf(0.05);
}

TEST_F(Jobs, ProjectWritesTheFileOfTheProgram) {
    const std::string spec = "ward:ax=.2,ay=.5";
    for (const std::string extension : {".json", ".exr"}) {
        const jobs::Projected projected =
            jobs::project(spec, path("job" + extension),
                          {.basis = "zernike", .order = 5, .outgoing = "6x6", .cosine = true});
        EXPECT_EQ(projected.projection.coefficients.outgoing.spec(), "6x6");
        runProgram("project " + spec + " --basis zernike --order 5 --outgoing 6x6 --cosine -o " +
                   path("program" + extension));
        EXPECT_FALSE(read(path("job" + extension)).empty());
        EXPECT_EQ(read(path("job" + extension)), read(path("program" + extension)));
    }
}

TEST_F(Jobs, ProjectKeepsTheFormOfTheProgram) {
    const jobs::Projected projected = jobs::project(
        "ggx:alpha=.4", path("job.json"),
        {.order = 4, .outgoing = "8", .form = {.rank = 2, .precision = Precision::half}});
    ASSERT_TRUE(projected.kept);
    EXPECT_FALSE(projected.kept->steps.empty());
    runProgram("project ggx:alpha=.4 --order 4 --outgoing 8 --rank 2 --precision half -o " +
               path("program.json"));
    EXPECT_EQ(read(path("job.json")), read(path("program.json")));
}

TEST_F(Jobs, ErrorsNameTheFileThatAPresetIsIn) {
    write("p.json", R"({"format": "hshfit-preset", "version": 1, "model": "ward",)"
                    R"( "parameters": {"ax": 0.2, "ay": 0.5}, "source": "none"})");
    try {
        jobs::project(path("p.json"), path("c.json"), {.order = 2, .outgoing = "2"});
        FAIL() << "elevations of an anisotropic BRDF";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::usage);
        EXPECT_NE(std::string(error.what()).find(path("p.json") + ": ward"), std::string::npos)
            << error.what();
    }
}

TEST_F(Jobs, SeveralInputsAreProjectedAndFailuresAreValues) {
    const std::vector<std::string> specs = {"lambert", "no_such_model", "phong:exponent=9"};
    const jobs::ManyProjected many =
        jobs::projectMany(specs, path("job"), ".json", {.order = 3, .outgoing = "4"});
    EXPECT_EQ(many.specs, specs);
    ASSERT_EQ(many.failures.size(), 1u);
    EXPECT_EQ(many.failures[0].spec, "no_such_model");
    EXPECT_EQ(jobs::codeOf(many.failures), ExitCode::input);
    EXPECT_FALSE(many.results[1]);
    runProgram("project lambert phong:exponent=9 --order 3 --outgoing 4 -o " + path("program"));
    EXPECT_EQ(filesIn("job").size(), 2u);
    EXPECT_EQ(filesIn("job"), filesIn("program"));
}

TEST_F(Jobs, ReportIsTheDocumentOfTheProgram) {
    const jobs::Reported reported =
        jobs::report({"phong:exponent=9", "lambert"},
                     {.bases = "hsh,zernike", .maxOrder = 4, .outgoing = "4", .cosine = true});
    EXPECT_TRUE(reported.failures.empty());
    const test::Answer answer = run(
        "report phong:exponent=9 lambert --bases hsh,zernike --max-order 4 --outgoing 4 --cosine "
        "--json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(reportJson(reported.report), answer.out);
}

TEST_F(Jobs, ExportWritesTheFilesOfTheProgram) {
    jobs::project("ggx:alpha=.4", path("ggx.json"), {.order = 4, .outgoing = "8"});
    std::set<std::string> parts;
    const jobs::Listener listener{.begin = [&](const std::string& part) {
        parts.insert(part);
        return jobs::ProgressCall();
    }};
    const jobs::Exported exported = jobs::exportCoefficients(
        path("ggx.json"), path("job"),
        {.targets = "bin,ktx2,glsl,viewer", .shader = {.environmentOrder = 3}}, listener);
    EXPECT_EQ(exported.name, "ggx");
    EXPECT_EQ(exported.texts.size(), 2u);
    ASSERT_TRUE(exported.error.split) << exported.error.reason;
    EXPECT_EQ(parts, (std::set<std::string>{"error", "project", "viewer"}));
    runProgram("export " + path("ggx.json") + " --target bin,ktx2,glsl,viewer " +
               "--environment-order 3 -o " + path("program"));
    EXPECT_GE(filesIn("job").size(), 6u);
    EXPECT_EQ(filesIn("job"), filesIn("program"));
    EXPECT_THROW(jobs::exportCoefficients(path("ggx.json"), path("job"), {}), OutputError);
}

TEST_F(Jobs, FilesOfAnExportOpenAsSources) {
    jobs::project("ggx:alpha=.4", path("ggx.json"), {.order = 4, .outgoing = "8"});
    const jobs::Exported exported = jobs::exportCoefficients(
        path("ggx.json"), path("job"),
        {.targets = "bin", .pack = {.number = gpu::Number::float32}, .measureError = false});
    const Direction wi = directionFromAngles(0.4, 0.1), wo = directionFromAngles(0.7, 2);
    const auto stored = jobs::openSource(path("ggx.json"));
    const auto opened = jobs::openSource(path("job/" + exported.sidecar));
    EXPECT_NEAR(evaluate(*opened, wi, wo)[0], evaluate(*stored, wi, wo)[0], 1e-6);
}

TEST_F(Jobs, FitWritesThePresetOfTheProgram) {
    const std::string data = "ggx:alpha=.3,F0=.4";
    const jobs::Fitted fitted =
        jobs::fit(data, path("job.json"), {.model = "ward", .starts = 4, .seed = 7});
    EXPECT_TRUE(fitted.result.converged);
    runProgram("fit " + data + " --model ward --starts 4 --seed 7 -o " + path("program.json"));
    EXPECT_EQ(read(path("job.json")), read(path("program.json")));
}

TEST_F(Jobs, WaveletsOfALambertianAreFourTermsWhateverTheView) {
    const jobs::Reported reported =
        jobs::report({"lambert", "ward:ax=.2,ay=.5"},
                     {.bases = "hsh", .maxOrder = 3, .outgoing = "4x4", .wavelets = true});
    ASSERT_EQ(reported.report.reports.size(), 2u);
    const ReportCurve& flat = reported.report.reports[0].curves.back();
    ASSERT_TRUE(flat.bestTerms);
    ASSERT_EQ(flat.points.size(), 3u);
    EXPECT_NEAR(*flat.points[0].accuracy, 0.25, 1e-6);
    EXPECT_NEAR(*flat.points[1].accuracy, 1, 1e-6);
    EXPECT_NEAR(*flat.points[2].accuracy, 1, 1e-6);
    // Raw Ward has no energy.
    EXPECT_FALSE(reported.report.reports[1].curves.back().points[0].accuracy);
}

// A full disk for one input, while another one is within a parallel loop of its own.
TEST(Batch, AnInputThatCannotBeWrittenLetsTheLoopsOfOthersEnd) {
    constexpr int count = 2000;
    std::atomic<bool> started = false;
    std::atomic<int> done = 0;
    std::atomic<bool> returned = false;
    const auto soon = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    const auto work = [&](std::size_t i, const jobs::ProgressCall&) {
        if (i == 0) {
            while (!started && std::chrono::steady_clock::now() < soon) std::this_thread::yield();
            throw OutputError("full");
        }
        tbb::parallel_for(0, count, [&](int) {
            started = true;
            std::this_thread::sleep_for(std::chrono::microseconds(50));
            ++done;
        });
        returned = true;
    };
    EXPECT_THROW(jobs::forEachInput({"a", "b"}, {}, "test", work), OutputError);
    if (!started) GTEST_SKIP() << "one thread: the second input never began";
    EXPECT_TRUE(returned);
    EXPECT_EQ(done, count);
}

}  // namespace
