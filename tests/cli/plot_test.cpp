// `plot`: the functions of a basis as a figure.

#include "places.h"

#include <hshfit/pages/gnuplot.h>

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <regex>
#include <set>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

TEST_F(Cli, PlotRefusesInOneLine) {
    expectError("plot hsh", 2, "--output", 0);
    expectError("plot hsh -o " + path("a.jpg"), 2, ".svg", 0);
    expectError("plot hhs -o " + path("a.png"), 2, "hsh", 0);
    expectError("plot hsh --order 9 -o " + path("a.png"), 2, "--order", 0);
    expectError("plot zernike --sphere -o " + path("a.png"), 2, "hemisphere", 0);
    expectError("plot hsh -o " + path("absent/a.png"), 5, "absent", 0);
}

TEST_F(Cli, PlotDrawsWholeFiguresInEachFormat) {
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    for (const char* name : {"hsh.png", "hsh.svg", "hsh.pdf"}) {
        const Answer answer = run("plot hsh --order 2 --json --force -o " + path(name));
        ASSERT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "plot"));
        EXPECT_EQ(Json::parse(answer.out)["functions"], 4);
        EXPECT_TRUE(hshfit::figureIsComplete(path(name))) << name;
    }
    EXPECT_EQ(Json::parse(run("plot esh --json --force -o " + path("esh.svg")).out)["functions"],
              10);
}

/// Both signs are drawn exactly where a function has both: Y_0^0 > 0, Y_1^m changes its sign.
TEST_F(Cli, PlotColoursSignsApart) {
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    const auto hues = [&](const std::string& arguments) {
        EXPECT_EQ(run("plot " + arguments + " --force -o " + path("a.svg")).code, 0);
        const std::string svg = read(path("a.svg"));
        std::set<bool> warm;
        const std::regex colour("rgb\\( *([0-9]+), *([0-9]+), *([0-9]+)\\)");
        for (std::sregex_iterator at(svg.begin(), svg.end(), colour), end; at != end; ++at) {
            const int red = std::stoi((*at)[1]), blue = std::stoi((*at)[3]);
            if (std::abs(red - blue) > 40) warm.insert(red > blue);
        }
        return warm;
    };
    EXPECT_EQ(hues("sh --order 1 --sphere"), std::set<bool>{true});
    EXPECT_EQ(hues("sh --order 2 --sphere"), (std::set<bool>{false, true}));
}

}  // namespace
