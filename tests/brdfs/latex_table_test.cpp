// Numbers with their errors as physicists print them, and text that LaTeX shows as it is.

#include <brdfs/fit/latex_table.h>
#include <brdfs/fit/printed_number.h>

#include <gtest/gtest.h>

#include <limits>

namespace hshfit::brdfs {
namespace {

TEST(LatexNumber, HasTheDigitsOfItsError) {
    EXPECT_EQ(latexNumber(0.0663, 0.0022), "0.0663(22)");
    EXPECT_EQ(latexNumber(-0.12341, 0.003), "-0.1234(30)");
    EXPECT_EQ(latexNumber(0, 0.5), "0.00(50)");
    EXPECT_EQ(latexNumber(0.00004, 0.0022), "0.0000(22)");
    EXPECT_EQ(latexNumber(5.3, 3.9), "5.3(39)");
    EXPECT_EQ(latexNumber(41, 12), "41(12)");
}

TEST(LatexNumber, RoundsUpToANewDigit) {
    EXPECT_EQ(latexNumber(0.99999, 0.01), "1.000(10)");
    EXPECT_EQ(latexNumber(5, 0.0996), "5.00(10)");
}

TEST(LatexNumber, TakesAPowerOfTenFarFromOne) {
    EXPECT_EQ(latexNumber(12350, 680), "1.235(68)\\times10^{4}");
    EXPECT_EQ(latexNumber(1e-7, 2e-9), "1.000(20)\\times10^{-7}");
    EXPECT_EQ(latexNumber(3e-12, 0), "3\\times10^{-12}");
}

TEST(LatexNumber, StandsAloneWithoutAnError) {
    EXPECT_EQ(latexNumber(551.315, 0), "551.315");
    EXPECT_EQ(latexNumber(1.25, std::numeric_limits<double>::infinity()), "1.25");
    EXPECT_EQ(latexNumber(1, 1e-12), "1\\pm 1\\times10^{-12}");
}

TEST(PlainNumber, HasSignsInPlaceOfCommands) {
    EXPECT_EQ(plainNumber(12350, 680), "1.235(68)×10⁴");
    EXPECT_EQ(plainNumber(-1e-12, 2e-14), "−1.000(20)×10⁻¹²");
    EXPECT_EQ(plainNumber(1, 1e-12), "1 ± 1×10⁻¹²");
    EXPECT_EQ(plainValue(-0.25), "−0.25");
    EXPECT_EQ(plainValue(std::numeric_limits<double>::infinity()), "∞");
}

TEST(Uncertainty, HasBothOfItsDigits) {
    EXPECT_EQ(plainError(0.002), "0.0020");
    EXPECT_EQ(plainError(0.0998), "0.10");
    EXPECT_EQ(plainError(2.34), "2.3");
    EXPECT_EQ(plainError(41.7), "42");
    EXPECT_EQ(plainError(1234), "1200");
    EXPECT_EQ(plainError(2e-7), "2.0×10⁻⁷");
    EXPECT_EQ(latexError(2e-7), "2.0\\times10^{-7}");
}

TEST(LatexText, HasNoCommandOfItsOwn) {
    EXPECT_EQ(latexText("a_b%$&#{}"), "a\\_b\\%\\$\\&\\#\\{\\}");
    EXPECT_EQ(latexText("~^\\"), "\\textasciitilde{}\\textasciicircum{}\\textbackslash{}");
    EXPECT_EQ(latexText("a\nb"), "a?b");
    EXPECT_EQ(latexText("é"), "é");
    EXPECT_EQ(latexText("−2×10⁻⁵"), "$-$2$\\times$10\\textsuperscript{-}\\textsuperscript{5}");
}

/// The report of a fit with one parameter.
struct OneParameter {
    FitSamples samples;
    FitReport report;

    OneParameter(const std::string& name, double value, double error) {
        report.data = "d.csv";
        report.samples = &samples;
        report.result.model = "lambert";
        FittedParameter& parameter = report.result.parameters.emplace_back();
        parameter.name = name;
        parameter.value = value;
        parameter.standardError = error;
        report.result.correlations = {1};
    }
};

// By hand: 0.03 of the samples and 0.04 that they share make 0.05, and twice that expanded.
TEST(LatexTable, HasTheErrorsOfABudget) {
    OneParameter kd("kd", 0.5, 0.05);
    ParameterBudget own;
    own.name = "kd";
    own.value = 0.5;
    own.rows.resize(2);
    own.rows[0].name = "samples";
    own.rows[0].type = 'A';
    own.rows[0].standard = 0.03;
    own.rows[0].sensitivity = 1;
    own.rows[1].name = "standard & scale";
    own.rows[1].standard = 0.08;
    own.rows[1].sensitivity = -0.5;
    combine(own);
    kd.report.result.budget.emplace().parameters = {own};
    const std::string table = latexTable(kd.report);
    const auto has = [&](const std::string& part) { return table.find(part) != table.npos; };
    EXPECT_TRUE(has("kd & $0.500(50)$ & $0.10$ & 2.00 & $\\infty$ & 1")) << table;
    EXPECT_TRUE(has("combined with the budget")) << table;
}

// A lobe that is normalised has an albedo, the other a height.
TEST(LatexTable, UnitsAreThoseOfTheTermThatHasTheParameter) {
    const auto unitOf = [](const std::string& model, const std::string& parameter) {
        OneParameter one(parameter, 0.5, 0.05);
        one.report.result.model = model;
        return latexTable(one.report).find("& sr$^{-1}$") != std::string::npos ? "1/sr" : "1";
    };
    const std::string two = "phong:normalized=true + phong:normalized=false";
    EXPECT_EQ(unitOf(two, "phong1.ks"), "1");
    EXPECT_EQ(unitOf(two, "phong2.ks"), "1/sr");
}

TEST(LatexTable, ZerosOfAnglesAreDegrees) {
    const std::string table = latexTable(OneParameter("incidence zero", 0.02, 0.01).report);
    EXPECT_NE(table.find("& $^\\circ$"), table.npos) << table;
}

}  // namespace
}  // namespace hshfit::brdfs
