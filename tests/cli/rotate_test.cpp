// `rotate` and `matrix` as a user meets them.

#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

TEST_F(Cli, MatrixPrintsTheChangeOfBasis) {
    const Answer answer = run("matrix sh hsh --order 2 --from-order 3 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "matrix"));
    const Json json = Json::parse(answer.out);
    ASSERT_EQ(json["matrix"].size(), 4u);
    ASSERT_EQ(json["matrix"][0].size(), 9u);
    EXPECT_NEAR(json["matrix"][0][0].get<double>(), std::sqrt(0.5), 1e-15);
    EXPECT_NEAR(json["matrix"][0][2].get<double>(), std::sqrt(6.0) / 4, 1e-15);
    EXPECT_NEAR(json["matrix"][2][6].get<double>(), std::sqrt(30.0) / 8, 1e-15);
    const std::string text = run("matrix sh hsh --order 1").out;
    EXPECT_EQ(text, "  0.707107\n");
}

TEST_F(Cli, MatrixOfARotation) {
    // +z goes to +x: Y_10 becomes Y_11.
    const Json sh = Json::parse(run("matrix sh sh --order 2 --euler 0,90,0 --json").out)["matrix"];
    EXPECT_NEAR(sh[3][2].get<double>(), 1, 1e-15);
    EXPECT_NEAR(sh[2][3].get<double>(), -1, 1e-15);
    // About z hemispherical functions rotate as the others do.
    const Json hsh =
        Json::parse(run("matrix hsh hsh --order 2 --euler 60,0,30 --json").out)["matrix"];
    EXPECT_NEAR(hsh[1][3].get<double>(), 1, 1e-15);
    EXPECT_NEAR(hsh[3][1].get<double>(), -1, 1e-15);
    // SH that are rotated and then converted: the constant stays what it is.
    const Json mixed =
        Json::parse(run("matrix sh hsh --order 2 --euler 0,90,0 --json").out)["matrix"];
    EXPECT_NEAR(mixed[0][0].get<double>(), std::sqrt(0.5), 1e-15);
    EXPECT_NEAR(mixed[0][2].get<double>(), 0, 1e-15);
}

TEST_F(Cli, MatrixTakesTheSignsAndTheWeightOfThePapers) {
    // The sign (-1)^m of both sides: entries between odd and even m change theirs.
    const std::string job = "matrix sh sh --order 2 --euler 30,90,50 --json";
    const Answer answer = run(job + " --condon-shortley");
    EXPECT_TRUE(keepsSchema(answer.out, "matrix"));
    const Json plain = Json::parse(run(job).out)["matrix"];
    const Json sign = Json::parse(answer.out)["matrix"];
    for (const std::size_t i : {1u, 3u}) {
        EXPECT_EQ(sign[i][2].get<double>(), -plain[i][2].get<double>());
        EXPECT_NE(sign[i][2].get<double>(), 0);
        for (const std::size_t j : {1u, 3u}) EXPECT_EQ(sign[i][j], plain[i][j]);
    }
    EXPECT_EQ(sign[2][2], plain[2][2]);
    // The printed matrix of the HSH paper: twice the integral of H_00 Y_00 cos(theta) = pi over
    // sqrt(2 pi) sqrt(4 pi).
    const Answer cosine = run("matrix sh hsh --order 1 --weight cosine --json");
    EXPECT_TRUE(keepsSchema(cosine.out, "matrix"));
    EXPECT_NEAR(Json::parse(cosine.out)["matrix"][0][0], std::sqrt(1.0 / 8), 1e-15);
    EXPECT_EQ(run("matrix hsh hsh --weight cosine --euler 1,2,3").code, 2);
    EXPECT_EQ(run("matrix hsh hsh --weight flux").code, 2);
}

TEST_F(Cli, RotateMovesTheFunctionAndTellsTheLoss) {
    ASSERT_EQ(
        run("project phong:exponent=8 -o " + path("a.json") + " --order 8 --outgoing 0,0 --quiet")
            .code,
        0);
    const Answer answer =
        run("rotate " + path("a.json") + " -o " + path("b.json") + " --euler 0,30,0 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "rotate"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["method"], "exact");
    EXPECT_GT(json["lost_energy"].get<double>(), 0);
    EXPECT_LT(json["lost_energy"].get<double>(), 0.01);
    EXPECT_LT(json["error"].get<double>(), 0.1);
    // The lobe stood about the normal and stands about 30,0 now.
    const auto valueAt = [&](const std::string& wi) {
        const std::string out =
            run("eval " + path("b.json") + " --wi " + wi + " --wo 0,0 --json").out;
        return Json::parse(out)["values"][0].get<double>();
    };
    EXPECT_GT(valueAt("30,0"), 0.9);
    EXPECT_LT(valueAt("30,180"), 0.1);
    const Json file = Json::parse(read(path("b.json")));
    EXPECT_FALSE(file["symmetry"]["isotropic"].get<bool>());
    EXPECT_TRUE(file["symmetry"]["bilateral"].get<bool>());
}

TEST_F(Cli, RotateHasFourWaysAndOrdersThemByTheirErrors) {
    ASSERT_EQ(run("project ward:ax=.2,ay=.5 --cosine -o " + path("a.json") +
                  " --order 6 --outgoing 45,0 --quiet")
                  .code,
              0);
    const auto errorOf = [&](const std::string& options) {
        const Answer answer = run("rotate " + path("a.json") + " -o " + path("b.json") +
                                  " --force --json --quiet " + options);
        EXPECT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "rotate"));
        return Json::parse(answer.out)["error"].get<double>();
    };
    const double exact = errorOf("--axis 0,1,0,20");
    const double table = errorOf("--axis 0,1,0,20 --method table --tables 8");
    const double detour = errorOf("--axis 0,1,0,20 --method through-sh --tolerance 1e-4");
    const double shift = errorOf("--axis 0,1,0,20 --method paper-shift");
    EXPECT_LT(exact, table);
    EXPECT_LT(exact, shift);
    EXPECT_GT(shift, 0.1);
    EXPECT_NEAR(detour, exact, 1e-3);
    EXPECT_NEAR(errorOf("--up 20,0"), exact, 1e-12);
}

TEST_F(Cli, RotateTurnsLightOnTheWholeSphere) {
    write("light.json", R"({"format":"hshfit-light","version":1,"basis":{"name":"sh","order":2,)"
                        R"("condon_shortley":false,"index":"l*(l+1)+m"},"domain":"sphere",)"
                        R"("channels":["grey"],"coefficients":[[1,0,2,0]],)"
                        R"("energy":{"value":5,"error":0,"finite":true},"error":0,"curves":[],)"
                        R"("source":{"light":"uniform:"},"generator":"test"})");
    const Answer answer =
        run("rotate " + path("light.json") + " -o " + path("turned.json") + " --up 90,90 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "rotate"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["domain"], "sphere");
    EXPECT_EQ(json["lost_energy"], 0);
    const Json c = Json::parse(read(path("turned.json")))["coefficients"][0];
    EXPECT_NEAR(c[0].get<double>(), 1, 1e-15);
    EXPECT_NEAR(c[1].get<double>(), 2, 1e-14);
    EXPECT_NEAR(c[2].get<double>(), 0, 1e-14);
    expectError(
        "rotate " + path("light.json") + " -o " + path("x.json") + " --up 90,90 --method table", 2,
        "exact", 2);
}

TEST_F(Cli, RotateRefusesInOneLine) {
    ASSERT_EQ(
        run("project lambert -o " + path("a.json") + " --order 2 --outgoing 0,0 --quiet").code, 0);
    const std::string from = "rotate " + path("a.json") + " -o " + path("b.json");
    expectError(from, 2, "--euler", 1);
    expectError(from + " --euler 0,1,0 --up 1,2", 2, "--euler and --up exclude one another", 1);
    expectError(from + " --axis 0,0,1,9 --up 1,2", 2, "--axis and --up exclude one another", 1);
    for (const char* euler : {"1,2", "1,2,3,4", "x,1,2", "1,2,nan", "1,2,3,"}) {
        expectError(from + " --euler " + euler, 2, "A,B,C", 1);
    }
    expectError(from + " --axis 0,0,0,30", 2, "0,0,0", 1);
    expectError(from + " --euler 0,1,0 --method shift", 2, "through-sh", 1);
    expectError(from + " --euler 0,120,0 --method paper-shift", 2, "90", 1);
    expectError("rotate absent.json -o " + path("b.json") + " --euler 0,1,0", 3, "absent.json", 1);
    write("broken.json", R"({"format":"hshfit-light","version":1})");
    expectError("rotate " + path("broken.json") + " -o " + path("b.json") + " --euler 0,1,0", 3,
                "broken.json", 2);
    expectError("matrix sh hash", 2, "hash", 2);
    expectError("matrix sh hsh --order 100", 2, "entries", 2);
    expectError("matrix hsh zernike --euler 0,1,0", 2, "sh", 2);
}

}  // namespace
