// A fit as a laboratory hands it on: the page, the LaTeX table and the certificate.
#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <regex>
#include <set>
#include <sstream>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

namespace fs = std::filesystem;

std::string goniometer(const std::string& name) {
    return hshfit::test::sourceFolder() + "/examples/goniometer/" + name;
}

/// The output of a command of the shell, and whether it ended well.
std::pair<std::string, bool> said(const std::string& command) {
    std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    std::string text;
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
    return {text, pclose(pipe) == 0};
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != text.npos;
}

class FitReports : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    }

    /// Whether the rules of LaTeX hold for the table of a fit; its text.
    std::string tableOf(const std::string& fit) {
        const Answer got = run("fit " + fit + " --force --figures " + path("figures"));
        EXPECT_EQ(got.code, 0) << got.err;
        const std::string table = path("figures/parameters.tex");
        const auto [complaints, valid] = said("/usr/bin/python3 " + hshfit::test::sourceFolder() +
                                              "/tests/brdfs/check_latex.py '" + table + "'");
        EXPECT_TRUE(valid) << fit << "\n" << complaints << read(table);
        return read(table);
    }
};

/// A spectrum with a single high value: the scale of a lobe that holds it is not determined.
std::string spectrum() {
    std::string text = "# Test\n3\n400 500 600\n";
    for (int i = 0; i < 5; ++i)
        for (int k = 0; k < 12; ++k) {
            const double peak = i == 0 && k == 0 ? 400 : 0;
            text += std::to_string(0.3 * i) + " 0 " + std::to_string(0.13 * k) + " 3.14159265";
            for (const double kd : {0.2, 0.4, 0.7}) text += " " + std::to_string(kd / 3.14 + peak);
            text += "\n";
        }
    return text;
}

TEST_F(FitReports, TablesAreLatexThatNeedsNoPackage) {
    const std::string scans = "'" + goniometer("scans.csv") + "' --model lambert+ggx ";
    const std::string plain = tableOf(scans + "--sigma column --scans column");
    EXPECT_TRUE(has(plain, "& $U$ & $k$ & $\\nu$ &")) << plain;
    EXPECT_TRUE(has(plain, "(route: by scan)")) << plain;
    EXPECT_TRUE(has(plain, "correlation &")) << plain;
    const std::string instrument =
        tableOf(scans +
                "--sigma column --scans column --scan-scale 1% --dark fit "
                "--source-aperture cone:0.3");
    EXPECT_TRUE(has(instrument, "Instrument: source aperture: cone of half angle 0.3 degrees"))
        << instrument;
    // A value without an error has a mark behind its power of ten.
    write("spectrum.brdf", spectrum());
    const std::string bounds =
        tableOf("'" + path("spectrum.brdf") + "' --model lambert+ggx --loss l2 --accept");
    EXPECT_TRUE(has(bounds, "\\times10^{-5}$\\textsuperscript{c}")) << bounds;
    write("a_b%$&#{}~^.csv", read(goniometer("scans.csv")));
    tableOf("'" + path("a_b%$&#{}~^.csv") + "' --model phong --accept");
}

TEST_F(FitReports, PagesHaveTheFit) {
    const Answer got =
        run("fit --json '" + goniometer("scans.csv") +
            "' --model lambert+ggx --sigma column --scans column -o " + path("report"));
    ASSERT_EQ(got.code, 0) << got.err;
    EXPECT_TRUE(keepsSchema(got.out, "fit"));
    const Json fit = Json::parse(got.out)["fit"];
    const std::string page = read(path("report/comparison.html"));
    std::size_t rows = 0;
    for (const Json& p : fit["parameters"]) {
        char error[32];
        std::snprintf(error, sizeof error, "\">%.2g</td>", p["standard_error"].get<double>());
        rows += has(page, "<th scope=\"row\">" + p["name"].get<std::string>() + "</th>") &&
                has(page, error);
    }
    EXPECT_EQ(rows, 4u) << "each parameter with its standard uncertainty";
    EXPECT_TRUE(has(page, std::to_string(fit["uncertainty"]["degrees_of_freedom"].get<int>()) +
                              " degrees of freedom"));
    for (const char* title : {"Correlations of the parameters", "Leverage and influence",
                              "Residuals", "Measured values and fit", "Values that decide"})
        EXPECT_TRUE(has(page, std::string("<h3>") + title)) << title;
    for (const char* file : {"correlations.svg", "influence.pdf", "samples.csv", "parameters.tex"})
        EXPECT_TRUE(fs::exists(path("report/") + file)) << file;
    // Identifiers of the figures in one page differ.
    std::set<std::string> identifiers;
    const std::regex id(R"re( id=["']([^"']+)["'])re");
    for (std::sregex_iterator at(page.begin(), page.end(), id), end; at != end; ++at)
        EXPECT_TRUE(identifiers.insert((*at)[1]).second) << (*at)[1];
    EXPECT_GT(identifiers.size(), 5u);
    // The drawn correlations are the correlations in the answer.
    std::istringstream csv(read(path("report/correlations.csv")));
    std::string line;
    std::getline(csv, line);
    std::size_t drawn = 0;
    for (; std::getline(csv, line); ++drawn) {
        std::istringstream cells(line);
        std::vector<std::string> cell(6);
        for (std::string& one : cell) std::getline(cells, one, ',');
        const int column = std::stoi(cell[3]) - 1, row = std::stoi(cell[4]) - 1;
        EXPECT_NEAR(std::stod(cell[5]), fit["correlations"][row][column].get<double>(), 1e-12);
    }
    EXPECT_EQ(drawn, 16u);
}

TEST_F(FitReports, LobesOfOneModelAreNumbered) {
    const Answer got =
        run("fit ggx:alpha=.3,F0=.5 --model ggx+ggx --samples 400 --starts 2 --accept -o " +
            path("report"));
    ASSERT_EQ(got.code, 0) << got.err;
    for (const std::string name :
         {"ggx1.F0", "ggx1.alpha", "ggx1.ks", "ggx2.F0", "ggx2.alpha", "ggx2.ks"}) {
        EXPECT_TRUE(has(read(path("report/comparison.html")), ">" + name + "</th>")) << name;
        EXPECT_TRUE(has(read(path("report/parameters.tex")), name + " &")) << name;
    }
}

class Certificates : public FitReports {
protected:
    std::string fitTo(const std::string& pdf, const std::string& more = "") const {
        return "fit --json '" + goniometer("scans.csv") +
               "' --model lambert+ggx --sigma column --scans column --force --certificate " +
               path(pdf) + " " + more;
    }
};

TEST_F(Certificates, HoldWhatWasStatedAndFound) {
    if (!said("command -v pdftotext").second) GTEST_SKIP() << "poppler-utils is not installed";
    const Answer got = run(fitTo("c.pdf", "--certificate-fields '" + goniometer("fields.json") +
                                              "' -o " + path("fit.json")));
    ASSERT_EQ(got.code, 0) << got.err;
    const std::string text = said("pdftotext -layout " + path("c.pdf") + " -").first;
    // In the order of a laboratory's reports.
    std::size_t last = 0;
    for (const char* heading :
         {"Certificate of bidirectional reflectance", "Client and sample",
          "Instrument and geometry", "Standard and traceability", "Conditions", "Method", "Results",
          "Budget of uncertainty", "Figures", "Remarks", "Signatures", "Hashes"}) {
        const std::size_t at = text.find(heading, last);
        EXPECT_NE(at, text.npos) << heading << "\n" << text;
        if (at != text.npos) last = at;
    }
    const Json fields = Json::parse(read(goniometer("fields.json")));
    for (const char* key : {"certificate", "laboratory", "client", "operator", "date"})
        EXPECT_TRUE(has(text, fields[key].get<std::string>())) << key;
    const Json answer = Json::parse(got.out);
    for (const Json& p : answer["fit"]["parameters"])
        EXPECT_TRUE(has(text, p["name"].get<std::string>()));
    // Another program finds the same hashes of the files.
    for (const std::string& file : {goniometer("scans.csv"), goniometer("fields.json")}) {
        const std::string sum = said("sha256sum '" + file + "'").first.substr(0, 64);
        EXPECT_TRUE(has(text, sum)) << file << "\n" << text;
    }
    const std::string preset = read(path("fit.json"));
    write("content", preset.substr(0, preset.rfind(",\n  \"made_from\"")));
    EXPECT_TRUE(has(text, said("sha256sum " + path("content")).first.substr(0, 64))) << text;
}

/// Rows of the table of values in the text of a certificate. `scans` is 0 in a table without them.
struct ValueRow {
    double thetaI, thetaO, phiO;
    int scans;
    double measured, f, expandedF, beta, expandedBeta;
};
std::vector<ValueRow> valueRows(const std::string& text, bool scans) {
    const std::regex row(std::string(R"(\n *([0-9.]+) +0 +([0-9.]+) +([0-9.]+) +)") +
                         (scans ? R"(([0-9]+) +)" : "()") +
                         R"(([0-9.]+) +([0-9.]+)\([0-9]+\) +([0-9.]+) +)" +
                         R"(([0-9.]+)\([0-9]+\) +([0-9.]+) +[0-9.]+(?=\n))");
    std::vector<ValueRow> rows;
    for (std::sregex_iterator at(text.begin(), text.end(), row), end; at != end; ++at) {
        const auto number = [&](int k) { return std::stod((*at)[static_cast<std::size_t>(k)]); };
        rows.push_back({number(1), number(2), number(3), scans ? std::stoi((*at)[4]) : 0, number(5),
                        number(6), number(7), number(8), number(9)});
    }
    return rows;
}

// Beta is pi f, and both have the same relative uncertainty.
TEST_F(Certificates, RadianceFactorIsPiTimesTheBrdf) {
    if (!said("command -v pdftotext").second) GTEST_SKIP() << "poppler-utils is not installed";
    ASSERT_EQ(run(fitTo("c.pdf")).code, 0);
    const std::string text = said("pdftotext -layout " + path("c.pdf") + " -").first;
    const std::vector<ValueRow> rows = valueRows(text, true);
    for (const ValueRow& row : rows) {
        // The digits that are printed end a hundredth of the uncertainty from the value.
        EXPECT_NEAR(row.beta, std::numbers::pi * row.f, 0.05 * row.expandedBeta) << row.thetaO;
        EXPECT_NEAR(row.expandedBeta, std::numbers::pi * row.expandedF, 0.06 * row.expandedBeta);
        EXPECT_NEAR(row.measured, row.f, 0.1 * row.f) << row.thetaO;
    }
    EXPECT_GE(rows.size(), 50u) << text;
}

/// The readings of a pair of directions in the goniometer's table, by both signed angles.
using Readings = std::map<std::pair<double, double>, std::vector<double>>;

// The goniometer's scans stand twice in its table.
TEST_F(Certificates, RepeatedScansAreOneRowWithTheirNumber) {
    if (!said("command -v pdftotext").second) GTEST_SKIP() << "poppler-utils is not installed";
    std::istringstream table(read(goniometer("scans.csv")));
    std::string line, once;
    std::getline(table, line);
    once = line + "\n";
    Readings readings;
    while (std::getline(table, line)) {
        double thetaI = 0, thetaO = 0, f = 0;
        ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &thetaI, &thetaO, &f), 3) << line;
        auto& own = readings[{thetaI, thetaO}];
        if (own.empty()) once += line + "\n";
        own.push_back(f);
    }
    const auto certified = [&](bool scans, const std::string& facts) {
        const std::string text = said("pdftotext -layout " + path("c.pdf") + " -").first;
        EXPECT_TRUE(std::regex_search(text, std::regex(facts))) << text;
        const std::vector<ValueRow> rows = valueRows(text, scans);
        EXPECT_GE(rows.size(), 50u) << text;
        std::set<std::pair<double, double>> seen;
        for (const ValueRow& row : rows) {
            // The mirror direction, at positive angles, is opposite in azimuth.
            const double thetaO = row.phiO == 0 ? -row.thetaO : row.thetaO;
            EXPECT_TRUE(seen.insert({row.thetaI, thetaO}).second) << row.thetaI << " " << thetaO;
            std::vector<double> own = readings[{row.thetaI, thetaO}];
            ASSERT_EQ(own.size(), 2u) << row.thetaI << " " << thetaO;
            EXPECT_EQ(row.scans, scans ? 2 : 0);
            const double mean = scans ? (own[0] + own[1]) / 2 : own[0];
            EXPECT_NEAR(row.measured, mean, 1e-4 * mean) << row.thetaI << " " << thetaO;
        }
    };
    ASSERT_EQ(run(fitTo("c.pdf")).code, 0);
    const std::string count = std::to_string(readings.size());
    certified(true, "pairs of directions +" + count + "\n *readings +" +
                        std::to_string(2 * readings.size()) + "\n");
    // Without repetition there is no column.
    write("once.csv", once);
    const Answer got =
        run("fit --json " + path("once.csv") +
            " --model lambert+ggx --sigma column --force --certificate " + path("c.pdf"));
    ASSERT_EQ(got.code, 0) << got.err;
    certified(false, "pairs of directions +" + count + "\n *channels");
}

TEST_F(Certificates, AreTheSameBytesForTheSameInputs) {
    const std::string fields = "--certificate-fields '" + goniometer("fields.json") + "'";
    ASSERT_EQ(run(fitTo("a.pdf", fields)).code, 0);
    ASSERT_EQ(run(fitTo("b.pdf", fields + " --threads 1")).code, 0);
    EXPECT_EQ(read(path("a.pdf")), read(path("b.pdf")));
    EXPECT_TRUE(read(path("a.pdf")).starts_with("%PDF-"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2) << "and no scratch";
    EXPECT_FALSE(has(read(path("a.pdf")), "/CreationDate"));
}

TEST_F(Certificates, FieldsThatAreWrongAreNamed) {
    const auto refuses = [&](const std::string& fields, const std::string& part) {
        write("fields.json", fields);
        expectError(fitTo("c.pdf", "--certificate-fields " + path("fields.json")), 3, part, 1);
    };
    const std::string head = R"({"format":"hshfit-certificate-fields","version":1,)";
    refuses(head + R"("labratory":"x"})", "unknown field 'labratory'; known: certificate");
    refuses(head + R"("client":7})", "client");
    refuses(R"({"format":"hshfit-preset","version":1})", "hshfit-certificate-fields");
    refuses(head, "not valid JSON");
    fs::remove(path("fields.json"));
    expectError("fit '" + goniometer("scans.csv") + "' --model lambert --certificate-fields x.json",
                2, "--certificate OUT.pdf", 0);
    expectError(fitTo("c.txt"), 2, "has to end in .pdf", 0);
    expectError("fit lambert:kd=.5 --model lambert --loss picture --certificate " + path("c.pdf"),
                2, "--certificate", 0);
}

}  // namespace
