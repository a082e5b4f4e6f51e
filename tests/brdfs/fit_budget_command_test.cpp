// `hshfit fit` with uncertainties common to all samples, as a laboratory meets it.
#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

/// A rough diffuse surface with noise of 0.5 %.
std::string table() {
    std::string text = "VARS theta_i,phi_i,theta_s,phi_s,BRDF,sigma\n";
    std::mt19937 random(6);
    for (int k = 0; k < 60; ++k) {
        const double noise = static_cast<double>(random()) / 0x1p32 - 0.5;
        text += std::to_string(0.1 * (k % 10)) + ",0," + std::to_string(0.2 * (k / 10)) + ",3.0," +
                std::to_string(0.2 * (1 + 0.017 * noise)) + ",0.001\n";
    }
    return text;
}

class BudgetCommand : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        write("data.astm", table());
    }
    Json answer(const std::string& arguments) {
        const Answer got = run("fit --json " + data() + arguments);
        EXPECT_EQ(got.code, 0) << arguments << "\n" << got.err;
        if (got.code != 0) return {};
        EXPECT_TRUE(keepsSchema(got.out, "fit"));
        return Json::parse(got.out)["fit"];
    }
    std::string data() const { return path("data.astm") + " --model lambert --sigma column "; }
};

TEST_F(BudgetCommand, JsonAndCsvStateTheSame) {
    write("b.csv",
          "name, on, distribution, half_width, standard_uncertainty, degrees_of_freedom, type\n"
          "standard, scale, normal, , 0.6%, 8, A\n"
          "area, scale, rectangular, 0.003, , ,\n"
          "zero, detector, u-shaped, 0.05, , inf, B\n");
    write("b.json", R"({"format": "hshfit-budget", "version": 1, "contributions": [
        {"name": "standard", "on": "scale", "standard_uncertainty": 0.006, "type": "A",
         "degrees_of_freedom": 8},
        {"name": "area", "on": "scale", "half_width": "0.3%", "distribution": "rectangular"},
        {"name": "zero", "on": "detector", "half_width": 0.05, "distribution": "u-shaped"}]})");
    const Json csv = answer("--budget " + path("b.csv")),
               json = answer("--budget " + path("b.json"));
    EXPECT_EQ(csv["budget"], json["budget"]);
    const Json& own = csv["budget"]["parameters"][0];
    const Json& rows = own["contributions"];
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[0]["name"], "samples");
    EXPECT_FALSE(rows[0].contains("unit"));
    EXPECT_EQ(rows[1]["type"], "A");
    EXPECT_EQ(rows[1]["degrees_of_freedom"], 8.0);
    EXPECT_NEAR(rows[2]["standard_uncertainty"].get<double>(), 0.003 / std::sqrt(3), 1e-15);
    EXPECT_NEAR(rows[3]["standard_uncertainty"].get<double>(), 0.05 / std::sqrt(2), 1e-15);
    EXPECT_TRUE(rows[3]["degrees_of_freedom"].is_null());
    EXPECT_EQ(own["combined_standard_uncertainty"], csv["parameters"][0]["standard_error"]);
    EXPECT_GT(csv["parameters"][0]["standard_error"].get<double>(),
              3 * csv["uncertainty"]["parameters"][0]["sandwich"].get<double>());
}

TEST_F(BudgetCommand, ACalibrationIsALineOfTheText) {
    const Answer text = run("fit " + data() + "--calibration 0.8%");
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_NE(text.out.find("for 95.45 %"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("calibration            B    normal"), std::string::npos) << text.out;
    const Json fit = answer("--calibration 0.8%");
    const Json& own = fit["budget"]["parameters"][0];
    EXPECT_NEAR(own["contributions"][1]["contribution"].get<double>(),
                0.008 * own["value"].get<double>(), 1e-9);
}

TEST_F(BudgetCommand, IsATableForLatex) {
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    write("b.csv", "name,on,half_width,distribution\nzero of a_b,detector,0.05,rectangular\n");
    const Json fit = answer("--budget " + path("b.csv") + " --figures " + path("figures"));
    const Json& row = fit["budget"]["parameters"][0]["contributions"][1];
    const std::string table = read(path("figures/budget.tex")),
                      line = table.substr(table.find("zero of a\\_b"));
    EXPECT_EQ(line.find(" & B & rectangular & $0.0289$$^\\circ$ & "), 12u) << table;
    EXPECT_NEAR(std::stod(line.substr(line.find("& $", 40) + 3)), row["sensitivity"].get<double>(),
                1e-3 * std::abs(row["sensitivity"].get<double>()))
        << line;
    EXPECT_NE(line.find("\\infty"), std::string::npos);
}

TEST_F(BudgetCommand, AnEntryThatDoesNotFitIsOneLineAndLeavesNothing) {
    const auto refused = [&](const std::string& arguments, int code, const std::string& part) {
        expectError("fit " + data() + arguments + " -o " + path("f.json"), code, part, 1);
    };
    refused("--calibration 0", 2, "such as 0.8%");
    refused("--calibration 120%", 2, "below 100 %");
    refused("--calibration 1%x", 2, "1%x");
    refused("--calibration 1% --loss l2 --robust huber", 2, "robust");
    refused("--budget " + path("none.csv"), 3, "none.csv");
    const std::pair<const char*, const char*> files[] = {
        {"", "is empty"},
        {"name,on,standard_uncertainty\n", "has no contribution"},
        {"name,on,width\n", "unknown field 'width'"},
        {"name,on,standard_uncertainty\na,scale\n", "line 2: 2 cells"},
        {"name,on,standard_uncertainty\na,scales,1%\n", "unknown on 'scales' (did you mean"},
        {"name,on,standard_uncertainty\n,scale,1%\n", "line 2: name is missing"},
        {"name,on,standard_uncertainty\na,,1%\n", "on is missing"},
        {"name,on,standard_uncertainty\na,scale,\n", "expected one of the two"},
        {"name,on,standard_uncertainty\na,scale,-1\n", "expected a number above 0"},
        {"name,on,standard_uncertainty\na,detector,1%\n", "expected a number above 0"},
        {"name,on,half_width\na,scale,1%\n", "normal distribution"},
        {"name,on,half_width,distribution\na,scale,1%,flat\n", "unknown distribution 'flat'"},
        {"name,on,standard_uncertainty,type\na,scale,1%,C\n", "expected A or B"},
        {"name,on,standard_uncertainty,degrees_of_freedom\na,scale,1%,0\n",
         "degrees_of_freedom is '0'"},
        {R"({"format":"hshfit-budget","version":2,"contributions":[]})", "version"},
        {R"({"format":"budget","version":1,"contributions":[]})", "hshfit-budget"},
        {R"({"format":"hshfit-budget","version":1,"contributions":[{"name":true}]})",
         "contribution 1: name has to be"},
    };
    for (const auto& [content, part] : files) {
        write("b", content);
        expectError("fit " + data() + "--budget " + path("b") + " -o " + path("f.json"), 3, part,
                    2);
    }
}

TEST_F(BudgetCommand, IsForOneModelOfSamples) {
    write("b.csv", "name,on,standard_uncertainty\na,scale,1%\n");
    expectError("fit " + path("data.astm") + " --compare-models lambert minnaert --calibration 1%",
                2, "--calibration", 2);
    expectError("fit lambert --model lambert --loss picture --budget " + path("b.csv"), 2,
                "--budget", 2);
}

TEST_F(BudgetCommand, ZerosOfAnglesAreParameters) {
    const Json fit = answer("--scans 20 --incidence-zero 0.05 --detector-zero 0.1:scan");
    const Json& instrument = fit["instrument"];
    EXPECT_EQ(instrument["incidence_zero"]["of"], "campaign");
    EXPECT_EQ(instrument["incidence_zero"]["width"], 0.05);
    EXPECT_EQ(instrument["detector_zero"]["of"], "scan");
    ASSERT_EQ(instrument["detector_zero"]["values"].size(), 3u);
    ASSERT_EQ(fit["parameters"].size(), 1 + 1 + 3u);
    EXPECT_EQ(fit["parameters"][1]["name"], "incidence zero");
    EXPECT_EQ(fit["parameters"][4]["name"], "detector zero 3");
    EXPECT_EQ(fit["parameters"][4]["value"], instrument["detector_zero"]["values"][2]);
    const std::string plain = path("data.astm") + " --model lambert ";
    const auto refused = [&](const std::string& arguments, const std::string& part) {
        expectError("fit " + arguments + " -o " + path("f.json"), 2, part, 1);
    };
    refused(plain + "--detector-zero 0.1", "uncertainties");
    refused(data() + "--detector-zero 0.1:scan", "needs scans");
    refused(data() + "--detector-zero 9", "at most 5");
    refused(data() + "--incidence-zero 0.1:scans", "0.05:scan");
    refused("lambert --model lambert --incidence-zero 0.1", "values of a function");
}

}  // namespace
