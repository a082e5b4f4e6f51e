// Poor results say that they are, and name a command that does better; good ones say nothing.

#include "places.h"
#include "program.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

class Quality : public Cli {
protected:
    /// The JSON answer of a command that ends with 0, and is poor or is not.
    Json answerOf(const std::string& arguments, bool poor) const {
        const Answer answer = run(arguments + " --json");
        EXPECT_EQ(answer.code, 0) << arguments << "\n" << answer.err;
        Json document = Json::parse(answer.out);
        EXPECT_EQ(document.contains("poor"), poor) << arguments;
        const std::size_t said = answer.err.find("poor: ");
        EXPECT_EQ(said != std::string::npos, poor) << answer.err;
        EXPECT_EQ(answer.err.rfind("poor: "), said) << "said once";
        return document;
    }

    /// The command that is said to do better, or that is to try.
    static std::string adviceOf(const Json& document) {
        const std::string better = document["poor"]["better"];
        return better.empty() ? document["poor"].value("to_try", "") : better;
    }
    Json betterThan(const Json& document) const {
        const std::string command = adviceOf(document);
        EXPECT_EQ(command.find("hshfit "), 0u) << command;
        const Answer answer = run(command.substr(7) + " --json");
        EXPECT_EQ(answer.code, 0) << command << "\n" << answer.err;
        return Json::parse(answer.out);
    }
};

TEST_F(Quality, OutgoingDirectionsAreElevationsForIsotropicInput) {
    const std::string to = " --order 2 --force -o " + path("x.json");
    EXPECT_EQ(answerOf("project lambert" + to, false)["outgoing"], "32");
    EXPECT_EQ(answerOf("project lambert --precision half" + to, false)["outgoing"], "32");
    EXPECT_EQ(answerOf("project lambert --outgoing 4x4" + to, false)["outgoing"], "4x4");
    EXPECT_EQ(answerOf("project ward:kd=1,ks=.001,ax=.5,ay=.6" + to, false)["outgoing"], "32x32");
    // Each of several inputs by its own symmetry.
    const Json both = Json::parse(run("project lambert ward:kd=1,ks=.001,ax=.5,ay=.6 --order 2 "
                                      "--json --force -o " +
                                      path("folder"))
                                      .out)["projections"];
    EXPECT_EQ(both[0]["outgoing"], "32");
    EXPECT_EQ(both[1]["outgoing"], "32x32");
}

// Five measurements determine no form of hundreds of functions, and no model of four parameters.
TEST_F(Quality, AdviceForFewMeasurementsIsWhatTheyDetermine) {
    write("five.csv",
          "theta_i,phi_i,theta_o,phi_o,brdf\n0,0,45,0,0.3\n30,0,30,180,2.2\n45,0,45,180,3.1\n"
          "60,0,60,180,9\n30,0,60,90,0.25\n");
    const std::string fitted =
        adviceOf(answerOf("fit " + path("five.csv") + " --model lambert", true));
    EXPECT_TRUE(fitted.starts_with("more measurements, as 5 pairs of directions")) << fitted;
    write("one.csv", "theta_i,phi_i,theta_o,phi_o,brdf\n0,0,45,0,5\n");
    const std::string single =
        adviceOf(answerOf("fit " + path("one.csv") + " --model lambert", true));
    EXPECT_TRUE(single.starts_with("more measurements, as 1 pair of directions does not"))
        << single;
    const std::string call = adviceOf(answerOf(
        "project " + path("five.csv") + " --cosine --order 4 -o " + path("five.json"), true));
    const std::string to = " -o fit.json";
    ASSERT_TRUE(call.starts_with("hshfit fit ") && call.ends_with(to)) << call;
    EXPECT_EQ(run(call.substr(7, call.size() - 7 - to.size())).code, 0) << call;
    const Json report = Json::parse(run("report --json " + path("five.csv")).out);
    EXPECT_TRUE(report["reports"][0]["better"].get<std::string>().starts_with("hshfit fit "));
}

TEST_F(Quality, LittleEnergyCapturedIsCalledPoor) {
    const std::string to = " --order 4 --force -o " + path("x.json");
    const Json narrow = answerOf("project ggx:alpha=.02 --outgoing 4" + to, true);
    EXPECT_LT(narrow["accuracy"], 0.9);
    EXPECT_TRUE(keepsSchema(narrow.dump(), "project"));
    const Json halfway = betterThan(narrow);
    EXPECT_EQ(halfway["representation"]["kind"], "halfway");
    EXPECT_GT(halfway["accuracy"], 0.9);
    // One direction: a higher order.
    for (const std::string job :
         {"phong:exponent=400 --outgoing 30,0", "phong:exponent=400 --cosine --outgoing 30,0",
          "lafortune:exponent=900,Cx=.9,Cy=.9,Cz=.9 --outgoing 30,0"}) {
        const Json few = answerOf("project " + job + to, true);
        const Json more = betterThan(few);
        EXPECT_GT(more["order"], 4);
        EXPECT_EQ(more["outgoing"], few["outgoing"]);
        EXPECT_EQ(more["quantity"], few["quantity"]);
        EXPECT_GT(more["accuracy"], few["accuracy"]);
    }
    const Answer quiet = run("project phong:exponent=400 --outgoing 4 --quiet" + to);
    EXPECT_EQ(quiet.err, "");
}

// An order where one up to 24 suffices, and else the halfway form.
/// Who has the file alone is told what `project` said.
TEST_F(Quality, AFileThatCapturesLittleIsCalledPoorWhereItIsLookedAt) {
    for (const bool poor : {true, false}) {
        const std::string file = path(poor ? "poor.json" : "good.json");
        const double share =
            answerOf("project " + std::string(poor ? "phong:exponent=200" : "lambert") +
                         " --outgoing 8 --order 4 -o " + file,
                     poor)["accuracy"];
        for (const std::string& command :
             {"info " + file, "render --size 16 -o " + path("x.png") + " --force " + file}) {
            const Answer answer = run(command);
            ASSERT_EQ(answer.code, 0) << answer.err;
            const std::string words = "poor: ";
            const std::string all = answer.out + answer.err;
            const std::size_t at = all.find(words);
            ASSERT_EQ(at != std::string::npos, poor) << all;
            if (poor) {
                EXPECT_NEAR(std::stod(all.substr(at + words.size())), 100 * share, 0.05);
            }
        }
    }
}

TEST_F(Quality, AReportNamesTheCallThatCapturesMore) {
    for (const std::string spec : {"phong:exponent=150", "ggx:alpha=.03"}) {
        const Json entry =
            Json::parse(run("report " + spec + " --bases hsh --json").out)["reports"][0];
        EXPECT_LT(entry["curves"][0]["points"].back()["accuracy"], 0.9);
        std::string command = entry["better"];
        command.replace(command.find("OUT.json"), 8, path("better.json"));
        const Answer answer = run(command.substr(7) + " --force --json");
        ASSERT_EQ(answer.code, 0) << command << "\n" << answer.err;
        EXPECT_GT(Json::parse(answer.out)["accuracy"], 0.9) << command;
    }
    // Enough is captured, or higher orders were left out on purpose.
    for (const std::string spec : {"lambert", "phong:exponent=150 --max-order 6"}) {
        const Json entry = Json::parse(run("report " + spec + " --json").out)["reports"][0];
        EXPECT_FALSE(entry.contains("better")) << spec;
    }
}

/// A poor result states its share of the energy, and its suggestion has a larger one.
TEST_F(Quality, EveryBasisHasAVerdictAndASuggestionThatDoesBetter) {
    std::map<std::string, double> accuracies;  // of the suggestions, many of which are alike
    const auto accuracyOf = [&](const std::string& call, const Json& poor) {
        if (!accuracies.contains(call)) accuracies[call] = betterThan(poor)["accuracy"];
        return accuracies[call];
    };
    const Json listed = Json::parse(run("list bases --json").out);
    ASSERT_FALSE(listed["bases"].empty());
    for (const Json& basis : listed["bases"]) {
        const std::string name = basis["name"];
        // As plain coefficients and rounded, whose squares are no energy in every basis.
        for (const std::string form : {"", " --precision half"}) {
            SCOPED_TRACE(name + form);
            const Json poor = answerOf("project phong:exponent=60 --order 3 --outgoing 4 --basis " +
                                           name + form + " --force -o " + path("x.json"),
                                       true);
            EXPECT_TRUE(keepsSchema(poor.dump(), "project"));
            EXPECT_LT(poor["accuracy"], 0.9);
            EXPECT_GT(accuracyOf(adviceOf(poor), poor), poor["accuracy"].get<double>() + 0.05);
        }
    }
}

TEST_F(Quality, EveryFormHasAVerdictAndASuggestionThatDoesBetter) {
    for (const std::string job : {
             "phong:exponent=60 --form basis --order 3",
             "ggx:ax=.1,ay=.2 --order 4 --outgoing 4x4",
             "ggx:alpha=.05 --form basis --order 3",
             "ggx:ax=.1,ay=.3 --form basis --order 3 --cosine",
             "blinn-phong:exponent=500 --form halfway --halfway 3,1,1",
             "blinn-phong:exponent=500 --form halfway --halfway 3,1,1 --precision unorm8",
             "phong:exponent=60,kd=.01 --order 3 --outgoing 8 --split diffuse",
             "phong:exponent=60 --order 3 --outgoing 8 --window lanczos",
             "phong:exponent=60 --order 3 --outgoing 8 --rank 4",
             "phong:exponent=60 --order 3 --outgoing 8 --basis lsosh --keep 30",
             // Without a cosine, the energy does not exist.
             "ward:kd=0,ks=1,ax=.2,ay=.2,variant=1992 --order 3 --outgoing 8",
         }) {
        SCOPED_TRACE(job);
        const Json poor = answerOf("project " + job + " --force -o " + path("x.json"), true);
        EXPECT_TRUE(keepsSchema(poor.dump(), "project"));
        ASSERT_TRUE(poor["accuracy"].is_number());
        EXPECT_GT(betterThan(poor)["accuracy"], poor["accuracy"].get<double>() + 0.05);
    }
    for (const std::string job :
         {"lambert --form basis --order 3", "lambert:kd=.3 --form halfway --halfway 4,2,2",
          "lambert --order 2 --outgoing 8 --split diffuse"})
        answerOf("project " + job + " --force -o " + path("x.json"), false);
}

TEST_F(Quality, AStepThatChangesMuchIsNamed) {
    const std::string job = "project ggx:alpha=.6 --outgoing 8 --force -o " + path("x.json");
    const Json few = answerOf(job + " --keep 9", true);
    EXPECT_NE(few["poor"]["reason"].get<std::string>().find("keep 9"), std::string::npos);
    // The coefficients without that step ring, so that they are no advice.
    EXPECT_TRUE(adviceOf(few).ends_with("--form halfway")) << few["poor"];
    // Smooth ones without it are.
    const Json smooth = answerOf(
        "project oren-nayar:kd=.5,sigma=30 --outgoing 8 --keep 1 --force -o " + path("x.json"),
        true);
    EXPECT_NE(smooth["poor"]["reason"].get<std::string>().find("keep 1"), std::string::npos);
    EXPECT_FALSE(betterThan(smooth).contains("representation"));
    // Ringing of the coefficients themselves is not blamed on their rounding.
    const Json half = answerOf(job + " --precision half", true);
    EXPECT_EQ(half["poor"]["reason"].get<std::string>().find("half"), std::string::npos);
    // Rounded coefficients capture what plain ones do.
    const std::string narrow =
        " phong:exponent=400 --order 4 --outgoing 4 --force -o " + path("x.json");
    const Json plain = answerOf("project" + narrow, true);
    EXPECT_EQ(answerOf("project --precision half" + narrow, true)["poor"], plain["poor"]);
}

TEST_F(Quality, ExportsNameTheLargestCauseOfAPoorError) {
    answerOf("project phong:exponent=400 --order 4 --outgoing 8 --force -o " + path("x.json"),
             true);
    const Json document = answerOf("export " + path("x.json") + " --force -o " + path("out"), true);
    EXPECT_TRUE(keepsSchema(document.dump(), "export"));
    const std::string reason = document["poor"]["reason"];
    EXPECT_NE(reason.find("is truncation"), std::string::npos) << reason;
    // Twice the order is poor as well.
    EXPECT_TRUE(adviceOf(document).ends_with("--form halfway")) << document["poor"];
    answerOf("project lambert --order 2 --outgoing 8 --force -o " + path("x.json"), false);
    answerOf("export " + path("x.json") + " --force -o " + path("out"), false);
}

// The share of a window is the same share that plain coefficients lack.
TEST_F(Quality, AWindowIsNoInterpolation) {
    const auto errorOf = [&](const std::string& options) {
        EXPECT_EQ(run("project phong:exponent=20,kd=.2 --order 6 --outgoing 16 --force -o " +
                      path("x.json") + options)
                      .code,
                  0);
        return Json::parse(
            run("export " + path("x.json") + " --force --json -o " + path("out")).out)["fit_error"];
    };
    const Json plain = errorOf(""), window = errorOf(" --window hann --precision float64");
    EXPECT_EQ(plain["form"], 0);
    EXPECT_NEAR(window["interpolation"], plain["interpolation"].get<double>(), 1e-6);
    EXPECT_NEAR(window["truncation"], plain["truncation"].get<double>(), 1e-12);
    EXPECT_GT(window["form"], 3 * window["interpolation"].get<double>());
}

// Without a cosine the energy of f does not exist, and the share is that of another function.
TEST_F(Quality, TheEnergyOfACapturedShareIsNamedWhereItIsNotThatOfTheCoefficients) {
    const auto saidOf = [&](const std::string& options) {
        return run("project ward:ax=.2,ay=.5 --order 6 --force -o " + path("x.json") + options);
    };
    const Answer many = saidOf(" --outgoing 16x16");
    EXPECT_NE(many.err.find("the energy of f does not exist: "), std::string::npos) << many.err;
    EXPECT_NE(many.out.find(" of the energy of f cos(theta_i) captured"), std::string::npos)
        << many.out;
    EXPECT_NE(saidOf(" --outgoing 4x4").out.find(" of the energy of f cos(theta_i) captured"),
              std::string::npos);
    EXPECT_NE(saidOf(" --outgoing 4x4 --cosine").out.find(" of the energy captured"),
              std::string::npos);
}

// 1 - relative L2^2 of the projected function, whatever was done to the coefficients.
TEST_F(Quality, TheCapturedShareIsThatOfCompare) {
    const std::string file = path("x.json");
    const auto shareOf = [&](const std::string& job) {
        const Answer answer = run("project " + job + " --force --quiet --json -o " + file);
        EXPECT_EQ(answer.code, 0) << job << "\n" << answer.err;
        return Json::parse(answer.out)["accuracy"].get<double>();
    };
    const auto comparedShare = [&](const std::string& spec, bool cosine) {
        const std::string metric = cosine ? "relative-l2-cosine" : "captured-energy";
        const Answer answer = run("compare '" + spec + "' " + file + " --json --metrics " + metric);
        const double value = Json::parse(answer.out)["metrics"][0]["value"];
        return cosine ? 1 - value * value : value;
    };
    const std::string phong = "phong:exponent=22,kd=.01", ggx = "ggx:alpha=.35,F0=.5,kd=.2";
    for (const std::string options :
         {" --window hann", " --window lanczos", " --precision unorm8", " --precision half",
          " --rank 3", " --keep 20", " --basis lsosh --keep 60", " --split lambert:kd=.01",
          " --split lambert:kd=.01 --window hann", " --split diffuse --precision unorm8",
          " --form basis", " --form basis --window hann"}) {
        const bool both = options.find("--form") != options.npos;
        for (const bool cosine : {false, true}) {
            const std::string job = " --order 4" + options + (both ? "" : " --outgoing 12") +
                                    (cosine ? " --cosine" : "");
            const std::string& spec = cosine ? ggx : phong;
            const double share = shareOf(spec + job);
            EXPECT_NEAR(share, comparedShare(spec, cosine), 5e-4) << spec << job;
        }
    }
    // Nothing visible is taken out.
    for (const std::string options : {" --window hann", " --precision unorm8"}) {
        const std::string job = phong + " --order 4 --outgoing 12" + options;
        EXPECT_NEAR(shareOf(job), shareOf(job + " --split lambert:kd=1e-9"), 1e-5) << options;
    }
    // The projection is the best of its order, so that no change captures more.
    for (const std::string& spec : {phong, ggx})
        for (const std::string basis : {"hsh", "sh", "lsosh", "makhotkin-flux"}) {
            const std::string job = spec + " --cosine --order 4 --outgoing 12 --basis " + basis;
            const double best = shareOf(job);
            EXPECT_NEAR(shareOf(job + " --precision float64"), best, 1e-7) << job;
            EXPECT_LT(shareOf(job + " --precision unorm8"), best) << job;
            EXPECT_NEAR(shareOf(job + " --precision unorm8"), best, 0.01) << job;
        }
}

// paper_white is five times brighter from 60 to 85 degrees than the other way round.
TEST_F(Quality, ReciprocalTermsOfAFileThatIsNotReciprocalAreCalledWrong) {
    const std::string paper = test::sharedFolder() + "/data/rgl/paper_white_rgb.bsdf";
    if (!std::filesystem::exists(paper)) GTEST_SKIP() << "no " << paper;
    const std::string to = " --form halfway --halfway 4,3,2 --force -o " + path("x.json");
    const auto speaksOfExchange = [&](const std::string& arguments) {
        const Answer answer = run("project " + arguments + to);
        EXPECT_EQ(answer.code, 0) << answer.err;
        return answer.err.find("with both exchanged; --reciprocal keeps") != std::string::npos;
    };
    EXPECT_TRUE(speaksOfExchange(paper + " --reciprocal"));
    EXPECT_FALSE(speaksOfExchange(paper));
    EXPECT_FALSE(speaksOfExchange("ggx:alpha=.5 --reciprocal"));
}

TEST_F(Quality, AFitThatExplainsLittleIsCalledPoor) {
    const std::string job = "fit ggx:alpha=.2 --samples 500 --starts 4 --model ";
    const Json poor = answerOf(job + "lambert", true);
    EXPECT_TRUE(keepsSchema(poor.dump(), "fit"));
    EXPECT_LT(poor["fit"]["explained"], 0.9);
    EXPECT_NE(poor["poor"]["better"].get<std::string>().find("--model lambert+ggx"),
              std::string::npos);
    // The call was tried, and has the FLIP that the reason says.
    const std::string reason = poor["poor"]["reason"];
    EXPECT_NE(reason.find("lambert+ggx by the loss picture has"), std::string::npos) << reason;
    EXPECT_LT(betterThan(poor)["picture"]["flip"]["mean"], 0.01);
    EXPECT_GT(answerOf(job + "lambert+ggx", false)["fit"]["explained"], 0.999);
    EXPECT_GT(answerOf(job + "ggx", false)["fit"]["explained"], 0.999);
}

// Pictures clip peaks; the pixel that mirrors the light keeps a coat from rising without bound,
// which had f cos(theta_i) wrong by more than itself.
TEST_F(Quality, AFitHasNoPeaksThatItsDataDoNotHave) {
    const std::string data = sharedFolder() + "/data/merl_slices/alum-bronze.slice";
    if (!std::filesystem::exists(data)) GTEST_SKIP() << "no " << data;
    const Answer answer = run("fit " + data + " --model gltf-pbr --quiet --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json fit = Json::parse(answer.out);
    EXPECT_TRUE(keepsSchema(fit.dump(), "fit"));
    EXPECT_GT(fit["fit"]["explained"], 0.9);
    EXPECT_LT(fit["fit"]["relative_error"], 1);
}

TEST_F(Quality, AConversionThatLosesMuchSaysSo) {
    const std::string to = " " + path("x.exr") + " --force --to slices:size=";
    const Json coarse = answerOf("convert ggx:alpha=.05" + to + "6", true);
    EXPECT_TRUE(keepsSchema(coarse.dump(), "convert"));
    EXPECT_GT(coarse["error"], 0.1);
    EXPECT_LT(answerOf("convert lambert" + to + "6", false)["error"], 1e-6);
}

/// Answer of `info --json` about a shared file, null where it is absent.
Json infoOf(const Answer& answer) {
    EXPECT_EQ(answer.code, 0) << answer.err;
    return Json::parse(answer.out);
}

TEST_F(Quality, AnEnvironmentMapIsNotTakenForABrdf) {
    const std::string file = test::sharedFolder() + "/data/env/mitsuba_matpreview_envmap.exr";
    if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
    const Json document = infoOf(run("info --json " + file));
    EXPECT_TRUE(keepsSchema(document.dump(), "info"));
    EXPECT_EQ(document["kind"], "light");
    EXPECT_EQ(document["lights"][0]["layout"], "latlong");
    EXPECT_EQ(infoOf(run("info --json lambert"))["kind"], "brdf");
    EXPECT_FALSE(infoOf(run("info --json lambert")).contains("warnings"));
}

// Values of 1e36 beside ones of 0.1: a relative tolerance and a bound of the evaluations.
TEST_F(Quality, HostileFilesHaveAlbedosWithTheirError) {
    const std::string folder = test::sharedFolder() + "/data/hostile/";
    if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
    for (const char* name : {"flip30.dat", "alta_huge.alta"}) {
        const Json document = infoOf(run("info --json " + folder + name));
        EXPECT_TRUE(keepsSchema(document.dump(), "info"));
        for (const Json& row : document["albedo"]) {
            ASSERT_TRUE(row["values"].is_array()) << name << row;
            EXPECT_TRUE(row["error"].is_number()) << name << row;
        }
        EXPECT_GT(document["health"]["largest_albedo"], 1e3) << name;
    }
}

// Finite values whose squares are not: one line, and no refinement.
TEST_F(Quality, ValuesWhoseSquaresOverflowAreRefused) {
    write("huge.brdf",
          "2\n500 600\n.1 0 .2 0 4e297 .1\n.3 0 .5 1 .1 .1\n.8 0 .9 2 .1 .2\n1.2 0 1 3 .2 .1\n");
    for (const char* how : {" --outgoing 4", " --outgoing 4 --cosine", " --form halfway"}) {
        const Answer answer = run("project " + path("huge.brdf") + " --order 3" + how +
                                  " --force -o " + path("x.json"));
        EXPECT_EQ(answer.code, 4) << how;
        EXPECT_NE(answer.err.find("square"), std::string::npos) << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
    }
}

// Incidences of 15, 30 and 60 degrees, and outgoing directions among which these are, too.
TEST_F(Quality, ContradictionsOfSamplesAreReported) {
    const std::string file = test::sharedFolder() + "/data/alta/retro-gray-tape.dat";
    if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
    const Json document = infoOf(run("info --json " + file));
    EXPECT_TRUE(keepsSchema(document.dump(), "info"));
    const Json& samples = document["health"]["reciprocity"]["samples"];
    EXPECT_GT(samples["pairs"], 0);
    EXPECT_GT(samples["defect"], 1e-3);
    EXPECT_GT(samples["largest_ratio"], 1.5);
    EXPECT_GT(document["health"]["reciprocity"]["defect"], 0);
    EXPECT_FALSE(document["laws"]["reciprocal"]);
}

}  // namespace
}  // namespace hshfit::test
