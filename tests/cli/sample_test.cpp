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
    const Answer answer = run("sample lambert:kd=.8/.4/.2 --outgoing 20,0 --count 50 -o " +
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

TEST_F(Cli, SampleSaysWhereNothingIsReflected) {
    const Answer answer = run("sample lambert:kd=0 --count 1 --elevations 1 --trials 10 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "sample"));
    EXPECT_EQ(Json::parse(answer.out)["reflects"], false);
    EXPECT_NE(answer.err.find("f is 0"), std::string::npos);
}

TEST_F(Cli, SampleRefusesWhatItCannotDo) {
    expectError("sample lambert --outgoing 90,0", 2, "horizon", 0);
    expectError("sample lambert --method magic", 2, "proposal", 0);
    expectError("sample absent.binary", 3, "absent.binary", 0);
}

}  // namespace
