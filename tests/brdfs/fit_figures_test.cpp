// `hshfit fit --figures` and `hshfit compare --figures`: figures for print with their data and
// table.
#include <cli/program.h>

#include <gsl/gsl_cdf.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <regex>
#include <set>
#include <sstream>
#include <vector>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

namespace fs = std::filesystem;

constexpr int elevations = 9, scattered = 17;

/// Scans in nine planes of incidence, of which a fit draws six, with two rows out of all planes.
std::string scans() {
    std::mt19937 random(9);
    std::string text = "VARS theta_i,phi_i,theta_s,phi_s,BRDF,sigma\n";
    const auto add = [&](double thetaIn, double thetaOut, double phiOut) {
        const double near = std::exp(-10 * std::pow(phiOut > 3 ? thetaOut - thetaIn : 1, 2));
        const double f = 0.1 + 2 * near, sigma = 0.02 * f;
        const double noise = static_cast<double>(random()) / 0x1p31 - 1;
        text += std::to_string(thetaIn) + ",0," + std::to_string(thetaOut) + "," +
                std::to_string(phiOut) + "," + std::to_string(f + sigma * noise) + "," +
                std::to_string(sigma) + "\n";
    };
    for (int i = 0; i < elevations; ++i)
        for (int k = 0; k < scattered; ++k) {
            const double angle = -1.4 + 0.175 * k;
            add(0.1 + 0.15 * i, std::abs(angle), angle < 0 ? 0 : 3.14159265);
        }
    add(0.4, 0.7, 1.5);
    add(0.4, 0.9, -1.2);
    return text;
}

std::vector<std::vector<std::string>> rowsOf(const std::string& csv) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream in(csv);
    for (std::string line; std::getline(in, line);) {
        rows.emplace_back(1);
        bool quoted = false;
        for (const char c : line) {
            if (c == '"')
                quoted = !quoted;
            else if (c == ',' && !quoted)
                rows.back().emplace_back();
            else
                rows.back().back() += c;
        }
    }
    return rows;
}

/// The numbers of a column.
std::vector<double> column(const std::vector<std::vector<std::string>>& rows,
                           const std::string& name) {
    const auto at = std::ranges::find(rows.at(0), name);
    EXPECT_NE(at, rows[0].end()) << name;
    std::vector<double> values;
    for (std::size_t k = 1; k < rows.size(); ++k)
        values.push_back(std::stod(rows[k].at(static_cast<std::size_t>(at - rows[0].begin()))));
    return values;
}

std::set<std::string> entries(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
    return names;
}

/// Markers drawn in an SVG document, including its legend.
int markersIn(const std::string& svg) {
    const std::string drawn = svg.substr(svg.find("</defs>"));
    const std::regex use("<use ");
    return static_cast<int>(
        std::distance(std::sregex_iterator(drawn.begin(), drawn.end(), use), {}));
}

class FitFigures : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
        write("scans.astm", scans());
    }

    Json fitted(const std::string& options) {
        const Answer got = run("fit --json " + path("scans.astm") + " --model lambert+phong " +
                               "--force --figures " + path("figures") + " " + options);
        EXPECT_EQ(got.code, 0) << got.err;
        if (got.code != 0) return {};
        EXPECT_TRUE(keepsSchema(got.out, "fit"));
        return Json::parse(got.out);
    }
};

TEST_F(FitFigures, SamplesAreRowsThatAgreeWithEval) {
    const Json answer = fitted("--sigma column -o " + path("fit.json"));
    const auto rows = rowsOf(read(path("figures/samples.csv")));
    ASSERT_EQ(rows.size() - 1, elevations * scattered + 2);
    EXPECT_EQ(answer["fit"]["samples"], rows.size() - 1);
    // The values of the preset at the directions of the rows.
    const Answer evaluated = run("eval " + path("fit.json") + " --pairs " +
                                 path("figures/samples.csv") + " -o " + path("f.csv"));
    ASSERT_EQ(evaluated.code, 0) << evaluated.err;
    const auto f = rowsOf(read(path("f.csv")));
    ASSERT_EQ(f.size(), rows.size());
    const auto model = column(rows, "model"), value = column(rows, "value"),
               sigma = column(rows, "sigma"), residual = column(rows, "residual"),
               standardised = column(rows, "standardised"), thetaIn = column(rows, "theta_i"),
               z = column(rows, "wi_z");
    double squares = 0;
    for (std::size_t k = 0; k < model.size(); ++k) {
        EXPECT_NEAR(model[k], std::stod(f[k + 1].back()), 1e-6 * model[k]);
        EXPECT_NEAR(residual[k], value[k] - model[k], 1e-12);
        EXPECT_NEAR(standardised[k], residual[k] / sigma[k], 1e-9);
        EXPECT_NEAR(std::cos(thetaIn[k] * std::acos(-1.0) / 180), z[k], 1e-12);
        squares += standardised[k] * standardised[k];
    }
    EXPECT_NEAR(squares, answer["fit"]["uncertainty"]["chi_square"].get<double>(), 1e-6 * squares);
}

TEST_F(FitFigures, PanelsHaveAMarkerForEachSampleOfTheirCuts) {
    for (const auto& [option, panels] :
         {std::pair{"", 6}, {"--panels all", elevations}, {"--panels 14.3,40", 2}}) {
        const Json figures = fitted(option)["figures"];
        EXPECT_EQ(figures["panels"], panels) << option;
        EXPECT_EQ(figures["samples"]["drawn"], panels * scattered);
        EXPECT_EQ(figures["samples"]["in_planes"], elevations * scattered);
        EXPECT_EQ(figures["samples"]["all"], elevations * scattered + 2);
        for (const char* name : {"cuts", "polar"}) {
            const std::string svg = read(path("figures/") + name + ".svg");
            EXPECT_EQ(markersIn(svg), panels * scattered + 1) << name << ", one in the legend";
            EXPECT_NE(svg.find("phong"), svg.npos) << "terms are named";
        }
        // Four panels of residuals, without a legend.
        EXPECT_EQ(markersIn(read(path("figures/residuals.svg"))), 4 * (elevations * scattered + 2));
    }
}

TEST_F(FitFigures, CutsStandAtTheirMeasuredAngles) {
    fitted("--panels all");
    const auto rows = rowsOf(read(path("figures/cuts.csv")));
    std::vector<double> measured;
    for (const auto& row : rows)
        if (row[2] == "measured" && row[0] == "3") measured.push_back(std::stod(row[3]));
    ASSERT_EQ(measured.size(), scattered);
    for (int k = 0; k < scattered; ++k)
        EXPECT_NEAR(measured[static_cast<std::size_t>(k)],
                    (-1.4 + 0.175 * k) * 180 / std::acos(-1.0), 1e-4);
}

// A Lambert fit has one value, and one error, at all directions.
/// The degrees of freedom of HC3's variance of a weighted mean: Satterthwaite's formula for one
/// parameter, by the shares of the weights.
double degreesOfMean(const std::string& astm) {
    std::vector<double> weights;
    double sum = 0;
    std::istringstream lines(astm);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line.find_first_not_of("0123456789.,-") != line.npos) continue;
        const double sigma = std::stod(line.substr(line.rfind(',') + 1));
        weights.push_back(1 / (sigma * sigma));
        sum += weights.back();
    }
    double trace = 0, squares = 0, product = 0;
    for (const double weight : weights) {
        const double share = weight / sum, own = share / ((1 - share) * (1 - share));
        trace += own * (1 - share);
        squares += own * own * (1 - 2 * share);
        product += own * share;
    }
    return trace * trace / (squares + product * product);
}

TEST_F(FitFigures, BandsAreStudentsOfTheStandardErrorOfF) {
    const Answer got = run("fit --json " + path("scans.astm") +
                           " --model lambert --sigma column --figures " + path("figures"));
    ASSERT_EQ(got.code, 0) << got.err;
    const Json parameter = Json::parse(got.out)["fit"]["parameters"][0];
    const double pi = std::acos(-1.0), f = parameter["value"].get<double>() / pi,
                 error = parameter["standard_error"].get<double>() / pi;
    const double factor = gsl_cdf_tdist_Pinv(0.975, degreesOfMean(scans()));
    EXPECT_GT(factor, 1.97);
    int rows = 0;
    for (const auto& row : rowsOf(read(path("figures/cuts.csv")))) {
        if (row[2] != "95 %") continue;
        ++rows;
        EXPECT_NEAR(std::stod(row[5]), f - factor * error, 1e-6 * f);
        EXPECT_NEAR(std::stod(row[6]), f + factor * error, 1e-6 * f);
    }
    EXPECT_GT(rows, 100);
}

TEST_F(FitFigures, AxisOfFIsAsAsked) {
    fitted("--axis log");
    EXPECT_NE(read(path("figures/figures.gp")).find("set logscale y"), std::string::npos);
    fitted("--axis linear");
    EXPECT_EQ(read(path("figures/figures.gp")).find("set logscale y"), std::string::npos);
}

TEST_F(FitFigures, SenselessOptionsAreOneLine) {
    const std::string command =
        "fit " + path("scans.astm") + " --model phong --figures " + path("figures") + " ";
    for (const auto& [option, part] : {std::pair{"--figure-width 0mm", "20 to 1000 mm"},
                                       {"--figure-width 84", "unit"},
                                       {"--font-size huge", "points"},
                                       {"--font-size 0", "4 to 24"},
                                       {"--font 'a,b'", "font"},
                                       {"--axis cubic", "auto, linear or log"},
                                       {"--panels x", "elevations"},
                                       {"--panels 100", "elevations"}})
        expectError(command + option, 2, part, 1);
    expectError(command + "--panels 89", 2, "those measured: 5.73", 1);
    expectError("fit " + path("scans.astm") + " --model phong --font Times", 2, "--figures", 1);
    expectError("compare lambert lambert --sigma 2%", 2, "--figures", 1);
}

TEST_F(FitFigures, AppearWholeOrNotAtAll) {
    fs::create_directory(path("bin"));
    const auto standIn = [&](const std::string& script) {
        write("bin/gnuplot", "#!/bin/sh\n" + script);
        fs::permissions(path("bin/gnuplot"), fs::perms::owner_all);
        return "PATH=" + path("bin") + ":$PATH ";
    };
    const auto with = [&](const std::string& environment) {
        const std::string command = environment + hshfit::test::program() + " fit --quiet " +
                                    path("scans.astm") + " --model phong --figures " +
                                    path("figures") + " 2>" + path("stderr") + " >/dev/null";
        return WEXITSTATUS(std::system(command.c_str()));
    };
    // gnuplot fails: everything but the figures.
    EXPECT_EQ(with(standIn("echo broken >&2; exit 1\n")), 5);
    EXPECT_NE(read(path("stderr")).find("broken"), std::string::npos);
    EXPECT_EQ(entries(path("figures")),
              (std::set<std::string>{"cuts.csv", "polar.csv", "residuals.csv", "figures.gp",
                                     "samples.csv", "parameters.tex"}));
    fs::remove_all(path("figures"));
    // A figure is cut short: nothing.
    EXPECT_EQ(with(standIn("exit 0\n")), 5);
    EXPECT_FALSE(fs::exists(path("figures")));
}

/// Whether every brace that is no character of a name has its other.
bool bracesBalance(const std::string& tex) {
    int depth = 0;
    for (std::size_t k = 0; k < tex.size(); ++k) {
        if (tex[k] == '\\') {
            ++k;
            continue;
        }
        if (tex[k] == '%') {
            k = std::min(tex.find('\n', k), tex.size());
            continue;
        }
        depth += tex[k] == '{' ? 1 : tex[k] == '}' ? -1 : 0;
        if (depth < 0) return false;
    }
    return depth == 0;
}

/// Rows of all tabulars as cells; each has to have the columns of its tabular.
std::vector<std::vector<std::string>> cellsOf(const std::string& tex) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream in(tex);
    std::size_t columns = 0;
    for (std::string line; std::getline(in, line);) {
        std::smatch begin;
        if (std::regex_search(line, begin, std::regex(R"(\\begin\{tabular\}\{([lrc]+)\})")))
            columns = begin[1].length();
        if (line.find("\\end{tabular}") != line.npos) columns = 0;
        if (columns == 0 || !line.ends_with("\\\\")) continue;
        line.resize(line.size() - 2);
        std::vector<std::string> cells(1);
        for (std::size_t k = 0; k < line.size(); ++k)
            if (line[k] == '&' && (k == 0 || line[k - 1] != '\\'))
                cells.emplace_back();
            else if (line[k] != ' ')
                cells.back() += line[k];
        EXPECT_EQ(cells.size(), columns) << line;
        rows.push_back(cells);
    }
    return rows;
}

/// The tabulars of parameters, which stand before the tabular of correlations.
std::string parametersOf(const std::string& tex) {
    return tex.substr(0, tex.find("  correlation &"));
}

TEST_F(FitFigures, TableHoldsTheParametersToTheirErrors) {
    const Json answer = fitted("--sigma column");
    const std::string tex = read(path("figures/parameters.tex"));
    EXPECT_TRUE(bracesBalance(tex)) << tex;
    std::map<std::string, std::string> values;
    for (const auto& row : cellsOf(parametersOf(tex))) values[row[0]] = row[1];
    const std::regex form(
        R"(\$(-?[0-9]+)(?:\.([0-9]+))?\(([0-9]+)\)(?:\\times10\^\{(-?[0-9]+)\})?\$)");
    int found = 0;
    for (const Json& p : answer["fit"]["parameters"]) {
        if (!p["standard_error"].is_number()) continue;
        ++found;
        std::smatch part;
        const std::string& text = values[p["name"]];
        ASSERT_TRUE(std::regex_match(text, part, form)) << p["name"] << " " << text;
        const double power = std::pow(10, part[4].matched ? std::stoi(part[4]) : 0);
        const double unit = std::pow(10, -static_cast<double>(part[2].length())) * power;
        const double value = std::stod(part[1].str() + "." + part[2].str()) * power;
        EXPECT_NEAR(value, p["value"].get<double>(), 0.5000001 * unit);
        EXPECT_NEAR(std::stod(part[3]) * unit, p["standard_error"].get<double>(), 0.5000001 * unit);
        EXPECT_EQ(part[3].length(), 2) << "two digits of the error";
    }
    EXPECT_GE(found, 2);
    const Json& uncertainty = answer["fit"]["uncertainty"];
    EXPECT_NE(tex.find("/" + std::to_string(uncertainty["degrees_of_freedom"].get<int>()) + " ="),
              tex.npos);
    EXPECT_NE(tex.find("lambert + phong"), tex.npos);
    EXPECT_NE(tex.find("$N = 155$"), tex.npos);
    EXPECT_NE(tex.find("sr$^{-1}$"), tex.npos) << "the unit of an unnormalised lobe's scale";
}

TEST_F(FitFigures, NamesOfAnyKindMakeATableAndFigures) {
    const std::string name = "a_b%$&#{}~^\\ \"é\".astm";
    write(name, scans());
    const std::string folder = "é'\"$x_%";
    const Answer got =
        run("fit '" + path(name) + "' --model phong --figures '" + path("") + "é'\\''\"$x_%'");
    ASSERT_EQ(got.code, 0) << got.err;
    const std::string tex = read(path(folder) + "/parameters.tex");
    EXPECT_TRUE(bracesBalance(tex)) << tex;
    EXPECT_NE(tex.find(R"(a\_b\%\$\&\#\{\}\textasciitilde{}\textasciicircum{}\textbackslash{})"),
              tex.npos)
        << tex;
    EXPECT_GT(markersIn(read(path(folder) + "/cuts.svg")), 0);
}

// A Lambertian surface is read as f + dark / cos(theta_o).
TEST_F(FitFigures, CurvesOfAnInstrumentAreItsReadingsBesideF) {
    const Answer got =
        run("fit --json " + path("scans.astm") +
            " --model lambert --sigma column --dark fit --figures " + path("figures"));
    ASSERT_EQ(got.code, 0) << got.err;
    double dark = 0, kd = 0;
    const Json answer = Json::parse(got.out);
    for (const Json& own : answer["fit"]["parameters"])
        (own["name"] == "dark" ? dark : kd) = own["value"];
    ASSERT_NE(dark, 0);
    const double pi = std::acos(-1.0), f = kd / pi;
    int bare = 0, drawn = 0;
    for (const auto& row : rowsOf(read(path("figures/cuts.csv")))) {
        if (row[2] == "f of the fit") {
            EXPECT_NEAR(std::stod(row[4]), f, 1e-6);
            ++bare;
        }
        if (row[2] != "fit as the instrument reads it") continue;
        const double angle = std::stod(row[3]) * pi / 180;
        EXPECT_NEAR(std::stod(row[4]), f + dark / std::cos(angle),
                    1e-4 * std::abs(std::stod(row[4])));
        ++drawn;
    }
    EXPECT_GT(drawn, 100);
    EXPECT_EQ(bare, drawn);
}

TEST_F(FitFigures, UnitsOfLawsAreThoseOfTheirCoefficients) {
    std::string text = "# Test\n3\n400 500 600\n";
    for (int i = 0; i < 5; ++i)
        for (int k = 0; k < 12; ++k)
            text += std::to_string(0.3 * i) + " 0 " + std::to_string(0.12 * k) + " 3.14159265 " +
                    std::to_string(0.1 + 0.3 * std::exp(-5 * std::pow(0.3 * i - 0.12 * k, 2))) +
                    " 0.2 0.3\n";
    write("paint.brdf", text);
    const Answer got = run("fit " + path("paint.brdf") +
                           " --model lambert+ggx:fresnel=dielectric,ks=1 --accept --dispersion "
                           "ior=cauchy:2,kd=poly:1 --figures " +
                           path("figures"));
    ASSERT_EQ(got.code, 0) << got.err;
    std::map<std::string, std::string> units;
    for (const auto& row : cellsOf(parametersOf(read(path("figures/parameters.tex")))))
        if (row.size() == 6) units[row[0]] = row[5];
    EXPECT_EQ(units["ggx.ior.A"], "1");
    EXPECT_EQ(units["ggx.ior.B"], "$\\mu$m$^{2}$");
    EXPECT_EQ(units["lambert.kd@400nm"], "1");
}

TEST_F(FitFigures, SpectraHaveTheirParametersOverTheWavelength) {
    std::string text = "# Test\n3\n400 500 600\n";
    std::mt19937 random(4);
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 12; ++k) {
            text += std::to_string(0.3 * i) + " 0 " + std::to_string(0.12 * k) + " 3.14159265";
            for (const double kd : {0.2, 0.4, 0.7})
                text +=
                    " " + std::to_string(kd / 3.14159265 *
                                         (1 + 1e-3 * (static_cast<double>(random()) / 0x1p31 - 1)));
            text += "\n";
        }
    write("paint.brdf", text);
    const Answer got =
        run("fit --json " + path("paint.brdf") + " --model lambert --figures " + path("figures"));
    ASSERT_EQ(got.code, 0) << got.err;
    const auto rows = rowsOf(read(path("figures/spectrum.csv")));
    std::map<double, double> kd;
    for (std::size_t k = 1; k < rows.size(); ++k) kd[std::stod(rows[k][3])] = std::stod(rows[k][4]);
    ASSERT_EQ(kd.size(), 3u);
    EXPECT_NEAR(kd[400], 0.2, 1e-3);
    EXPECT_NEAR(kd[600], 0.7, 1e-3);
    EXPECT_EQ(markersIn(read(path("figures/spectrum.svg"))), 3);
    const auto cells = cellsOf(parametersOf(read(path("figures/parameters.tex"))));
    ASSERT_EQ(cells.size(), 4u) << "a head and a row for each wavelength";
    EXPECT_EQ(cells[3][0], "600");
    EXPECT_TRUE(cells[3][1].starts_with("$0.70") || cells[3][1].starts_with("$0.69"));
}

TEST_F(FitFigures, ComparisonsDrawTheirPlotsAndMeasuredSamples) {
    const Answer models = run("compare --json lambert ggx:alpha=.3 --figures " + path("figures"));
    ASSERT_EQ(models.code, 0) << models.err;
    EXPECT_TRUE(keepsSchema(models.out, "compare"));
    for (const char* name : {"polar-0", "half-0", "albedo-0", "residual-0"})
        for (const char* end : {".csv", ".pdf", ".svg"})
            EXPECT_TRUE(fs::exists(path("figures/") + name + end)) << name << end;
    fs::remove_all(path("figures"));
    const Answer measured = run("compare " + path("scans.astm") + " lambert:kd=.5 --sigma column " +
                                "--figures " + path("figures"));
    ASSERT_EQ(measured.code, 0) << measured.err;
    EXPECT_EQ(markersIn(read(path("figures/cuts.svg"))), 6 * scattered + 1);
    EXPECT_TRUE(fs::exists(path("figures/residuals.pdf")));
}

TEST_F(FitFigures, TablesAndFunctionsAreComparedWithTheirFit) {
    const Answer got = run(
        "fit --json ggx:alpha=.4,F0=.2 --model lambert --loss cosine --figures " + path("figures"));
    ASSERT_EQ(got.code, 0) << got.err;
    EXPECT_TRUE(keepsSchema(got.out, "fit"));
    for (const char* name : {"polar-0.pdf", "half-0.svg", "residuals.svg", "parameters.tex"})
        EXPECT_TRUE(fs::exists(path("figures/") + name)) << name;
    EXPECT_FALSE(fs::exists(path("figures/samples.csv")));
}

}  // namespace
