#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/pages/report_files.h>

#include "lib/coefficient_files/coefficient_samples.h"
#include "next_second.h"
#include "places.h"

#include <cstdlib>
#include <limits>
#include <map>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <nlohmann/json.hpp>

using namespace hshfit;
using Json = nlohmann::json;
using samples::contentOf;
using samples::Folder;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
const char* const files[] = {"report.json", "curves.csv", "curves.gp",
                             "curves.svg",  "curves.pdf", "report.html"};
/// A file name is a specification too, and may hold anything.
const std::string hostile =
    "a/<script>alert(1)</script>&'\"`touch pwned`$(touch pwned)\n%s_^{x},\",\"2.binary";

/// The projection of a BRDF with `bandEnergy` in each band, as project() would give it.
std::vector<Projection> projections(double energy, double firstBand, double ratio) {
    std::vector<Projection> all;
    for (const auto& row : bases::catalog()) {
        Projection p;
        p.coefficients = samples::make(OutgoingSet::direction(radians(52), 0), Channels::rgb(),
                                       Quantity::brdf, std::min(row.maxOrder, 9), 2);
        p.coefficients.basis = row.name;
        p.coefficients.energy = {energy, 1e-9, true, ""};
        p.evaluations = 1000 + all.size();
        double left = energy * (1 - firstBand);
        for (int order = 1; order <= p.coefficients.order; ++order, left *= ratio) {
            p.captured.push_back(energy - left);
        }
        all.push_back(std::move(p));
    }
    return all;
}

Report sample() {
    Report report;
    report.reports.push_back(reportEntry(projections(2.5, 0.3, 0.4)));
    auto unbounded = projections(2, 0.5, 0.5);
    for (auto& p : unbounded) {
        p.coefficients.energy = {none, none, false, "f^2 diverges <at> the \"horizon\""};
        p.coefficients.source = hostile;
        p.coefficients.outgoing = OutgoingSet::parabolic(8, 8);
    }
    report.reports.push_back(reportEntry(unbounded));
    report.reports.push_back(reportEntry(projections(0.1, 0.01, 0.98)));
    report.reports.back().quantity = Quantity::brdfCosine;
    return report;
}

bool runs(const std::string& command) {
    return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

/// Puts PATH back at the end of a test that hides gnuplot.
class Path {
public:
    explicit Path(const std::string& value) : before_(std::getenv("PATH")) {
        ::setenv("PATH", value.c_str(), 1);
    }
    ~Path() { ::setenv("PATH", before_.c_str(), 1); }
    Path(const Path&) = delete;
    Path& operator=(const Path&) = delete;

private:
    std::string before_;
};

std::size_t entries(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(Report, EntryIsCapturedOverEnergy) {
    const auto all = projections(2.5, 0.3, 0.4);
    const ReportEntry entry = reportEntry(all);
    ASSERT_EQ(entry.curves.size(), all.size());
    EXPECT_EQ(entry.brdf, all[0].coefficients.source);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto basis = bases::make(all[i].coefficients.basis, all[i].coefficients.order);
        const auto& points = entry.curves[i].points;
        ASSERT_EQ(points.size(), all[i].captured.size());
        for (std::size_t k = 0; k < points.size(); ++k) {
            EXPECT_EQ(points[k].order, static_cast<int>(k) + 1);
            EXPECT_EQ(points[k].slots, points[k].order * points[k].order);
            EXPECT_EQ(points[k].coefficients, basis->functionCount(points[k].order));
            ASSERT_TRUE(points[k].accuracy);
            EXPECT_DOUBLE_EQ(*points[k].accuracy * 2.5, all[i].captured[k]);
        }
        EXPECT_EQ(entry.curves[i].energy.has_value(), basis->inner() != Basis::Inner::solidAngle);
    }
}

TEST(Report, CurvesOfWaveletsAreLabelledAsBestTerms) {
    wavelets::SliceCurve slices;
    for (int k = 0; k <= 16; ++k) slices.captured.push_back(0.1 * k);
    slices.error = 1e-4;
    Report report;
    report.reports.push_back(reportEntry(projections(2.5, 0.3, 0.4)));
    ReportEntry& entry = report.reports[0];
    const std::string before = reportJson(report), pageBefore = reportPage(report, {});
    EXPECT_EQ(before.find("best_terms"), std::string::npos);
    EXPECT_EQ(pageBefore.find("nonlinear"), std::string::npos);
    entry.curves.push_back(waveletCurve(&slices, entry.energy, 4));
    const Json curve = Json::parse(reportJson(report))["reports"][0]["curves"].back();
    EXPECT_EQ(curve["basis"], "soho");
    EXPECT_EQ(curve["selection"], "best_terms");
    EXPECT_EQ(curve["error"], 1e-4);
    ASSERT_EQ(curve["points"].size(), 4u);
    for (int n = 1; n <= 4; ++n) {
        const Json& point = curve["points"][n - 1];
        EXPECT_EQ(point["coefficients"], n * n);
        EXPECT_EQ(point["slots"], n * n);
        EXPECT_DOUBLE_EQ(point["accuracy"].get<double>(), 0.1 * n * n / 2.5);
    }
    EXPECT_NE(reportPage(report, {}).find("nonlinear"), std::string::npos);
    EXPECT_NE(reportScript(report).find("soho"), std::string::npos);
    // Without an energy the curve has no accuracy.
    for (const ReportPoint& point : waveletCurve(nullptr, entry.energy, 3).points)
        EXPECT_FALSE(point.accuracy);
}

TEST(Report, FirstReaching) {
    // 1 - 0.7 * 0.4^(n-1): .3, .72, .888, .9552, .98208, .992832, …
    const ReportCurve curve = reportEntry(projections(2.5, 0.3, 0.4)).curves[0];
    EXPECT_EQ(firstReaching(curve, 0.3 - 1e-12)->order, 1);
    EXPECT_EQ(firstReaching(curve, 0.90)->order, 4);
    EXPECT_EQ(firstReaching(curve, 0.95)->order, 4);
    EXPECT_EQ(firstReaching(curve, 0.99)->order, 6);
    EXPECT_FALSE(firstReaching(curve, 0.9999999));
    EXPECT_FALSE(firstReaching(sample().reports[1].curves[0], 0.0));
}

TEST(Report, JsonHoldsTheContract) {
    const Report report = sample();
    const Json json = Json::parse(reportJson(report));
    EXPECT_EQ(json["format"], "hshfit-report");
    EXPECT_EQ(json["version"], 1);
    ASSERT_EQ(json["reports"].size(), 3u);
    const Json& first = json["reports"][0];
    EXPECT_EQ(first["brdf"], report.reports[0].brdf);
    EXPECT_EQ(first["quantity"], "brdf");
    EXPECT_EQ(first["outgoing"], Json({{"theta", 52}, {"phi", 0}}));
    EXPECT_EQ(first["energy"], Json({{"value", 2.5}, {"error", 1e-9}, {"finite", true}}));
    EXPECT_EQ(first["curves"][0]["basis"], "hsh");
    EXPECT_EQ(first["curves"][0]["points"][0],
              Json({{"order", 1},
                    {"coefficients", 1},
                    {"slots", 1},
                    {"accuracy", *report.reports[0].curves[0].points[0].accuracy}}));
    const Json& second = json["reports"][1];
    EXPECT_EQ(second["brdf"], hostile);
    EXPECT_EQ(second["outgoing"], Json({{"map", "parabolic"}, {"width", 8}, {"height", 8}}));
    EXPECT_EQ(second["energy"], Json({{"value", nullptr},
                                      {"error", nullptr},
                                      {"finite", false},
                                      {"reason", "f^2 diverges <at> the \"horizon\""}}));
    for (const Json& curve : second["curves"]) {
        for (const Json& point : curve["points"]) EXPECT_TRUE(point["accuracy"].is_null());
    }
}

class ReportFiles : public ::testing::Test {
protected:
    void SetUp() override {
        if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    }
    const Folder folder;
};

TEST_F(ReportFiles, WritesEveryFileTwiceTheSame) {
    writeReport(sample(), folder / "a");
    hshfit::test::untilNextSecond();
    writeReport(sample(), folder / "b");
    for (const char* name : files) {
        const std::string content = contentOf(folder / "a/" + name);
        EXPECT_GT(content.size(), 500u) << name;
        EXPECT_TRUE(content == contentOf(folder / "b/" + name)) << name;
    }
    EXPECT_EQ(entries(folder / "a"), std::size(files)) << "temporaries are left";
    EXPECT_FALSE(std::filesystem::exists("pwned"));
    EXPECT_FALSE(std::filesystem::exists(folder / "a/pwned"));
    writeReport(sample(), folder / "a");  // over what is there
}

TEST_F(ReportFiles, TheScriptStandsAlone) {
    writeReport(sample(), folder / "a");
    std::filesystem::create_directory(folder / "alone");
    for (const char* name : {"curves.csv", "curves.gp"}) {
        std::filesystem::copy(folder / "a/" + name, folder / "alone/" + name);
    }
    ASSERT_TRUE(runs("cd '" + folder / "alone" + "' && gnuplot curves.gp"));
    EXPECT_TRUE(contentOf(folder / "alone/curves.svg") == contentOf(folder / "a/curves.svg"));
    EXPECT_EQ(contentOf(folder / "alone/curves.pdf").substr(0, 5), "%PDF-");
    EXPECT_EQ(entries(folder / "alone"), 4u);
}

TEST_F(ReportFiles, TheFiguresShowEveryCurveAndTheReason) {
    writeReport(sample(), folder / "a");
    const std::string svg = contentOf(folder / "a/curves.svg");
    for (const auto& row : bases::catalog()) {
        EXPECT_NE(svg.find(">" + std::string(row.name) + "</text>"), std::string::npos) << row.name;
    }
    EXPECT_NE(svg.find("f^2 diverges &lt;at> the"), std::string::npos);
    // A path for each basis of the two entries that have curves, in two panels.
    const std::regex curve(R"(<path[^>]*stroke='rgb\((?!200)[^>]*d='M[\d. ,L-]+)");
    const auto drawn = std::distance(std::sregex_iterator(svg.begin(), svg.end(), curve), {});
    EXPECT_GE(drawn, static_cast<std::ptrdiff_t>(4 * bases::catalog().size()));
    if (!runs("command -v pdftotext")) return;
    ASSERT_TRUE(runs("pdftotext '" + folder / "a/curves.pdf" + "' '" + folder / "a.txt" + "'"));
    EXPECT_NE(contentOf(folder / "a.txt").find("makhotkin-flux"), std::string::npos);
}

TEST_F(ReportFiles, ThePageEscapesAndIsWellFormed) {
    writeReport(sample(), folder / "a");
    const std::string page = contentOf(folder / "a/report.html");
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos);
    EXPECT_EQ(page.find("{{"), std::string::npos) << "a field was not filled in";
    EXPECT_EQ(page.find("http-equiv"), std::string::npos);
    // Nothing is fetched; the names of XML vocabularies are the only addresses.
    const std::regex address(R"re((src|href)\s*=\s*["'](https?:|//))re");
    EXPECT_FALSE(std::regex_search(page, address));
    // Every element with an end tag is closed in order, and no id appears twice.
    static const std::regex tag(
        R"re(<(/?)([A-Za-z][A-Za-z0-9]*)((?:"[^"]*"|'[^']*'|[^>"'])*?)(/?)>)re");
    std::vector<std::string> open;
    std::map<std::string, int> ids;
    for (std::sregex_iterator i(page.begin(), page.end(), tag), end; i != end; ++i) {
        const std::string name = (*i)[2];
        if (name == "meta" || (*i)[4].length() > 0) continue;
        if ((*i)[1].length() == 0) {
            open.push_back(name);
        } else {
            ASSERT_FALSE(open.empty());
            ASSERT_EQ(open.back(), name) << "at " << i->position();
            open.pop_back();
        }
    }
    EXPECT_TRUE(open.empty());
    static const std::regex id(R"re(\sid=["']([^"']*)["'])re");
    for (std::sregex_iterator i(page.begin(), page.end(), id), end; i != end; ++i) {
        EXPECT_EQ(++ids[(*i)[1]], 1) << (*i)[1];
    }
}

TEST_F(ReportFiles, TheTableSaysHowManyCoefficientsAreNeeded) {
    Report report;
    report.reports.push_back(sample().reports[0]);
    writeReport(report, folder / "a");
    const std::string page = contentOf(folder / "a/report.html");
    // hsh: 90 % and 95 % at order 4, 99 % at 6, 99.9 % at 9 (1 - 0.7 * 0.4^8 = 0.99954).
    EXPECT_TRUE(
        std::regex_search(page, std::regex(R"(hsh</th><td[^>]*>16 \(4\)</td><td[^>]*>16 \(4\)</td>)"
                                           R"(<td[^>]*>36 \(6\)</td><td[^>]*>81 \(9\)</td>)")));
    // h-basis ends at order 3, with 6 functions and 88.8 %: a sentence has it in place of a row.
    EXPECT_EQ(page.find("h-basis</th><td"), std::string::npos);
    EXPECT_NE(page.find("tried: h-basis 88.8 % (6)."), std::string::npos);
    EXPECT_EQ(page.find("This does better"), std::string::npos);
}

TEST_F(ReportFiles, WithoutASufficientBasisThePageNamesTheCallThatDoesBetter) {
    Report report;
    report.reports.push_back(sample().reports[2]);
    ReportEntry& entry = report.reports[0];
    // 1 - 0.99 * 0.98^8 = 15.77 % at order 9, which is not rounded up.
    ASSERT_FALSE(suffices(entry));
    EXPECT_TRUE(suffices(sample().reports[0]));
    entry.better = "project <again>";
    writeReport(report, folder / "a");
    const std::string page = contentOf(folder / "a/report.html");
    EXPECT_EQ(page.find("&gt; 81"), std::string::npos);
    EXPECT_EQ(page.find("Bold: the fewest"), std::string::npos);
    EXPECT_NE(page.find("hsh 15.7 % (81)"), std::string::npos);
    EXPECT_NE(page.find("To try: <code>project &lt;again&gt;</code>"), std::string::npos);
    EXPECT_EQ(Json::parse(contentOf(folder / "a/report.json"))["reports"][0]["better"],
              entry.better);
}

TEST(ReportNames, FilesAreShownWithoutTheirFolders) {
    const std::pair<const char*, const char*> cases[] = {
        {"/data/my scans/gold.bsdf", "gold.bsdf"},
        {"../a.b/scan.binary:interpolation=nearest", "scan.binary:interpolation=nearest"},
        {"lambert:kd=.1/.2/.3 + 0.5 * sub/paint.bsdf", "lambert:kd=.1/.2/.3 + 0.5 * paint.bsdf"},
        {"grey:x/FITS.json:MATERIAL", "grey:FITS.json:MATERIAL"},
        {"preset:ngan-ward/blue-acrylic", "preset:ngan-ward/blue-acrylic"},
        {"ggx:F0=1e-3/.2e-2/.1", "ggx:F0=1e-3/.2e-2/.1"},
        {"gold.bsdf", "gold.bsdf"},
        {"", ""}};
    for (const auto& [spec, name] : cases) EXPECT_EQ(withoutFolders(spec), name);
    EXPECT_EQ(
        shortName("lambert:kd=0.4005668148951401/0.2 + 0.30000000000000004*a1.234567.bsdf", 90),
        "lambert:kd=0.4006/0.2 + 0.3*a1.234567.bsdf");
    EXPECT_EQ(shortName("ggx:F0=0.04998893803521518,alpha=1.2345678e-320", 90),
              "ggx:F0=0.04999,alpha=1.235e-320");
}

// A basis that another entry of the report has, and this one has not, is not in this one's key.
TEST_F(ReportFiles, TheKeyHasTheCurvesOfItsOwnFigure) {
    Report report;
    report.reports.push_back(sample().reports[0]);
    report.reports.push_back(sample().reports[0]);
    report.reports[1].curves.resize(1);
    writeReport(report, folder / "a");
    const std::string svg = contentOf(folder / "a/curves.svg");
    const auto count = [&](const std::string& text) {
        std::size_t found = 0;
        for (std::size_t at = svg.find(text); at != svg.npos; at = svg.find(text, at + 1)) ++found;
        return found;
    };
    EXPECT_EQ(count(">hsh</text>"), 2u);
    EXPECT_EQ(count(">zernike</text>"), 1u);
}

TEST(ReportFailures, WithoutGnuplotTheRestIsComplete) {
    const Folder folder;
    const auto expectRest = [&](const std::string& fragment) {
        try {
            writeReport(sample(), folder / "a");
            ADD_FAILURE() << "expected: " << fragment;
        } catch (const OutputError& error) {
            const std::string message = error.what();
            EXPECT_NE(message.find(fragment), std::string::npos) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        }
        EXPECT_EQ(entries(folder / "a"), 4u);
        for (const char* name : {"report.json", "curves.csv", "curves.gp", "report.html"}) {
            EXPECT_GT(contentOf(folder / "a/" + name).size(), 500u) << name;
        }
        EXPECT_NE(contentOf(folder / "a/report.html").find("No figure"), std::string::npos);
        std::filesystem::remove_all(folder / "a");
    };
    std::filesystem::create_directory(folder / "bin");
    const Path path(folder / "bin");
    expectRest("apt-get install gnuplot-nox");
    samples::put(folder / "bin/gnuplot", "#!/bin/sh\necho 'line 3: bad' >&2\necho >&2\nexit 1\n");
    ::chmod((folder / "bin/gnuplot").c_str(), 0755);
    expectRest("gnuplot failed: line 3: bad");
    samples::put(folder / "bin/gnuplot", "#!/bin/sh\nkill -9 $$\n");
    expectRest("gnuplot failed");
}

// gnuplot does not report a full disk: a stand-in ends well and leaves half of each figure.
TEST(ReportFailures, AFigureCutShortLeavesNothing) {
    const Folder folder;
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    std::filesystem::create_directory(folder / "bin");
    samples::put(folder / "bin/gnuplot",
                 "#!/bin/sh\n"
                 "PATH=${PATH#*:}\n"
                 "export PATH\n"
                 "gnuplot \"$@\" || exit\n"
                 "for file in \"$PWD\"/.hshfit-*.tmp; do\n"
                 "    head -c 8 \"$file\" | grep -aqE '<.xml|%PDF' || continue\n"
                 "    truncate -s $(($(stat -c %s \"$file\") / 2)) \"$file\"\n"
                 "done\n");
    ::chmod((folder / "bin/gnuplot").c_str(), 0755);
    const Path path((folder / "bin") + ":" + std::getenv("PATH"));
    samples::put(folder / "bin/curves.svg", "of an earlier report");
    for (const char* place : {"a", "bin"}) {
        try {
            writeReport(sample(), folder / place);
            ADD_FAILURE() << "the figures were cut";
        } catch (const OutputError& error) {
            EXPECT_NE(std::string(error.what()).find("cut short"), std::string::npos);
        }
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "a"));
    EXPECT_EQ(contentOf(folder / "bin/curves.svg"), "of an earlier report");
    EXPECT_EQ(entries(folder / "bin"), 2u) << "gnuplot and curves.svg";
}

TEST(ReportFailures, ImpossibleFoldersAreRefused) {
    const Folder folder;
    samples::put(folder / "file", "x");
    for (const std::string name : {"file", "none/a", "file/a"}) {
        EXPECT_THROW(writeReport(sample(), folder / name), OutputError) << name;
    }
    EXPECT_EQ(entries(folder.path()), 1u);
}

}  // namespace
