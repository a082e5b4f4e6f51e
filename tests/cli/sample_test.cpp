// `sample` as a user meets it.

#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

TEST_F(Cli, SampleStatesTheAlbedoOfAWhiteFurnace) {
    const Answer answer =
        run("sample 'lambert:kd=.3 + ggx:alpha=.3,F0=.5' --outgoing 60,30 --count 5 --elevations 4 "
            "--trials 5000 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "sample"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["samples"].size(), 5u);
    EXPECT_EQ(json["parts"], Json::parse(R"(["cosine","GGX normals"])"));
    ASSERT_EQ(json["elevations"].size(), 4u);
    for (const Json& row : json["elevations"]) {
        const double by = row["albedo"][0], estimate = row["estimate"][0];
        EXPECT_NEAR(estimate, by, 5 * row["estimate_error"][0].get<double>() + 1e-4) << row;
        EXPECT_EQ(row["wasted"], 0);
    }
}

/// The rows of the file give the albedo once more.
TEST_F(Cli, SampleWritesDirectionsWithWeights) {
    const Answer answer = run("sample lambert:kd=.8/.4/.2 --outgoing 20,0 --count 50 --force -o " +
                              path("s.csv") + " --elevations 0 --trials 10");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_NE(answer.out.find("\n    20.0 "), std::string::npos) << answer.out;
    EXPECT_NE(answer.out.find("s.csv: 50 directions"), std::string::npos) << answer.out;
    std::istringstream rows(read(path("s.csv")));
    std::string line;
    std::getline(rows, line);
    EXPECT_EQ(line, "wi_x,wi_y,wi_z,pdf,weight_R,weight_G,weight_B");
    int count = 0;
    while (std::getline(rows, line)) {
        double v[7];
        std::istringstream cells(line);
        for (double& value : v) {
            std::string cell;
            std::getline(cells, cell, ',');
            value = std::stod(cell);
        }
        EXPECT_NEAR(v[0] * v[0] + v[1] * v[1] + v[2] * v[2], 1, 1e-12);
        EXPECT_NEAR(v[3], v[2] / M_PI, 1e-12);
        EXPECT_NEAR(v[4], .8, 1e-12);
        EXPECT_NEAR(v[6], .2, 1e-12);
        ++count;
    }
    EXPECT_EQ(count, 50);
}

TEST_F(Cli, SampleIsTheSameForAnyNumberOfThreads) {
    const std::string command =
        "sample he:sigma=.15,tau=3 --count 20 --elevations 3 --trials 100 -o ";
    ASSERT_EQ(run(command + path("a.csv") + " --threads 1").code, 0);
    ASSERT_EQ(run(command + path("b.csv") + " --threads 2").code, 0);
    ASSERT_FALSE(read(path("a.csv")).empty());
    EXPECT_EQ(read(path("a.csv")), read(path("b.csv")));
}

/// The shares of parts that are left out go to the others, which stay at most 1.
TEST_F(Cli, SampleStatesSharesOfAtMostOne) {
    for (const std::string spec : {"phong:exponent=1,kd=.5,ks=.001", "eon:roughness=.5"}) {
        const Answer answer =
            run("sample " + spec + " --count 0 --trials 1 --elevations 12 --json");
        ASSERT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "sample")) << spec;
    }
}

TEST_F(Cli, SampleSaysWhereNothingIsReflected) {
    const Answer answer = run("sample lambert:kd=0 --count 1 --elevations 1 --trials 10 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "sample"));
    EXPECT_EQ(Json::parse(answer.out)["reflects"], false);
    EXPECT_NE(answer.err.find("f is 0"), std::string::npos);
}

/// An export with shaders keeps a proposal, from which `stored` draws; others keep one on request.
TEST_F(Cli, SampleDrawsFromTheProposalOfAnExport) {
    ASSERT_EQ(run("project ggx:alpha=.3,F0=.8 --form halfway --halfway 6,3,2 --force -o " +
                  path("g.json"))
                  .code,
              0);
    const std::string job = "export " + path("g.json") + " --json --no-error -o ";
    const Answer with = run(job + path("with") + " --target bin,glsl");
    ASSERT_EQ(with.code, 0) << with.err;
    EXPECT_TRUE(keepsSchema(with.out, "export"));
    EXPECT_EQ(Json::parse(with.out)["proposal"]["bytes"], 128);
    EXPECT_TRUE(keepsSchema(read(path("with/g.hsh.json")), "gpu_form"));
    EXPECT_NE(read(path("with/g_hsh.glsl")).find("vec3 hsh_sample("), std::string::npos);
    for (const Json all = Json::parse(with.out); const Json& row : all["proposal"]["efficiency"]) {
        EXPECT_LT(row["variance"], 0.5) << row;
        EXPECT_EQ(row["wasted"], 0) << row;
    }
    const std::string few = " --count 3 --elevations 2 --trials 2000 --json";
    const Answer stored = run("sample " + path("with/g.hsh.json") + " --method stored" + few);
    ASSERT_EQ(stored.code, 0) << stored.err;
    EXPECT_TRUE(keepsSchema(stored.out, "sample"));
    EXPECT_EQ(Json::parse(stored.out)["parts"], Json::parse(R"(["proposal"])"));
    EXPECT_EQ(Json::parse(stored.out)["stored"], true);
    EXPECT_EQ(Json::parse(run("sample " + path("g.json") + few).out)["stored"], false);
    const Answer again =
        run("import " + path("with/g.hsh.json") + " --force -o " + path("h.json") + " --json");
    EXPECT_TRUE(keepsSchema(again.out, "import"));
    EXPECT_EQ(Json::parse(again.out)["proposal"]["rows"], 16);

    ASSERT_EQ(run(job + path("bare") + " --target bin").code, 0);
    ASSERT_EQ(run(job + path("none") + " --target bin,glsl --no-sampling").code, 0);
    for (const char* folder : {"bare", "none"}) {
        const std::string sidecar = path(std::string(folder) + "/g.hsh.json");
        const Answer refused = run("sample " + sidecar + " --method stored");
        EXPECT_EQ(refused.code, 2);
        EXPECT_NE(refused.err.find("keeps no proposal"), std::string::npos) << refused.err;
    }
    ASSERT_EQ(run(job + path("asked") + " --target bin --sampling").code, 0);
    EXPECT_EQ(run("sample " + path("asked/g.hsh.json") + " --method stored" + few).code, 0);
}

TEST_F(Cli, SampleRefusesWhatItCannotDo) {
    expectError("sample lambert --outgoing 90,0", 2, "horizon", 0);
    expectError("sample lambert --method magic", 2, "proposal", 0);
    expectError("sample absent.binary", 3, "absent.binary", 0);
}

}  // namespace
