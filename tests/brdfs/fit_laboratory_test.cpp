// `hshfit fit` with stated uncertainties, as a laboratory meets it.
#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <random>
#include <sstream>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

namespace fs = std::filesystem;

std::string shared(const std::string& file) {
    return hshfit::test::sharedFolder() + "/data/" + file;
}

/// Rows "theta_i,phi_i,theta_s,phi_s,value,sigma,scan" of a rough diffuse surface with noise.
struct Table {
    std::string astm = "VARS theta_i,phi_i,theta_s,phi_s,BRDF,sigma,scan\n";
    std::string plain = "VARS theta_i,phi_i,theta_s,phi_s,BRDF\n";
    std::string companion = "scan,sigma\n";

    Table() {
        std::mt19937 random(6);
        for (int scan = 0; scan < 12; ++scan)
            for (int k = 0; k < 8; ++k) {
                const double out = 0.05 + 0.15 * k, sigma = 0.002 + 0.0005 * k;
                const double noise = static_cast<double>(random()) / 0x1p32 - 0.5;
                const std::string at = std::to_string(0.1 * scan) + ",0," + std::to_string(out) +
                                       ",3.0," + std::to_string(0.2 + sigma * 3 * noise);
                const std::string stated = std::to_string(sigma);
                astm += at + "," + stated + "," + std::to_string(scan) + "\n";
                plain += at + "\n";
                companion += std::to_string(scan) + "," + stated + "\n";
                // Below the horizon: not fitted, but a row of the file.
                if (k != 3) continue;
                astm += "0.1,0,1.5717,0,9,1,0\n";
                plain += "0.1,0,1.5717,0,9\n";
                companion += "0,1\n";
            }
    }
};

class Laboratory : public Cli {
protected:
    Json answer(const std::string& arguments) {
        const Answer got = run("fit --json " + arguments);
        EXPECT_EQ(got.code, 0) << arguments << "\n" << got.err;
        if (got.code != 0) return {};
        EXPECT_TRUE(keepsSchema(got.out, "fit"));
        return Json::parse(got.out);
    }
};

TEST_F(Laboratory, ColumnsAndCompanionFilesStateTheSame) {
    const Table table;
    write("own.astm", table.astm);
    write("plain.astm", table.plain);
    write("sigmas.csv", table.companion);
    const std::string end = " --model oren-nayar --scans column";
    Json own = answer(path("own.astm") + " --sigma column" + end),
         beside = answer(path("plain.astm") + " --sigma " + path("sigmas.csv") + end);
    EXPECT_EQ(own["fit"]["samples"], 96);
    EXPECT_EQ(own["fit"]["weights"], "sigma");
    EXPECT_EQ(own["fit"]["loss"], "l2");
    EXPECT_EQ(own["fit"]["uncertainty"]["scans"]["count"], 12);
    EXPECT_EQ(own["fit"]["parameters"], beside["fit"]["parameters"]);
    own["fit"]["uncertainty"].erase("sigma");
    beside["fit"]["uncertainty"].erase("sigma");
    EXPECT_EQ(own["fit"]["uncertainty"], beside["fit"]["uncertainty"]);
    // The plain file is what it was: sigma and scan are no channels.
    EXPECT_EQ(answer(path("own.astm") + " --model oren-nayar")["fit"]["parameters"],
              answer(path("plain.astm") + " --model oren-nayar")["fit"]["parameters"]);
}

TEST_F(Laboratory, ResidualsAreARowForEachValueAndAddUpToChiSquare) {
    const Table table;
    write("own.astm", table.astm);
    const Json fit = answer(path("own.astm") + " --sigma column --model oren-nayar --residuals " +
                            path("r.csv"))["fit"];
    std::istringstream rows(read(path("r.csv")));
    std::string line;
    std::getline(rows, line);
    EXPECT_EQ(line,
              "row,wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,channel,value,sigma,model,residual,studentised,"
              "leverage,cook,theta_i,theta_o,aspecular,standardised,standard_error");
    double chiSquare = 0, leverage = 0;
    std::size_t count = 0;
    std::istringstream file(table.astm);
    std::vector<std::string> lines{""};
    for (std::string text; std::getline(file, text);) lines.push_back(text);
    while (std::getline(rows, line)) {
        std::vector<std::string> cells;
        std::istringstream parts(line);
        for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
        ASSERT_EQ(cells.size(), 20u) << line;
        EXPECT_NE(lines[std::stoul(cells[0])].find(cells[8]), std::string::npos) << line;
        EXPECT_NEAR(std::stod(cells[8]) - std::stod(cells[10]), std::stod(cells[11]), 1e-15);
        chiSquare += std::pow(std::stod(cells[11]) / std::stod(cells[9]), 2);
        leverage += std::stod(cells[13]);
        ++count;
    }
    EXPECT_EQ(count, 96u);
    EXPECT_NEAR(fit["uncertainty"]["chi_square"], chiSquare, 1e-9 * chiSquare);
    EXPECT_NEAR(96 - fit["uncertainty"]["degrees_of_freedom"].get<double>(), leverage, 1e-6);
}

TEST_F(Laboratory, ThreadsDoNotChangeErrors) {
    const Table table;
    write("own.astm", table.astm);
    for (const char* threads : {"1", "3"})
        ASSERT_EQ(run("fit " + path("own.astm") +
                      " --sigma column --scans column --model oren-nayar --bootstrap 50 --profile "
                      "--residuals " +
                      path(std::string("r") + threads) + " --threads " + threads + " -o " +
                      path(std::string(threads) + ".json"))
                      .code,
                  0);
    EXPECT_EQ(read(path("1.json")), read(path("3.json")));
    EXPECT_EQ(read(path("r1")), read(path("r3")));
}

TEST_F(Laboratory, WrongStatementsAreOneLineAndLeaveNothing) {
    const Table table;
    write("own.astm", table.astm);
    write("plain.astm", table.plain);
    write("short.csv", "sigma\n1\n2\n");
    write("named.csv", "error" + table.companion.substr(table.companion.find('\n')));
    write("zero.csv",
          "scan,sigma\n0,0\n" + table.companion.substr(table.companion.find('\n', 11) + 1));
    write("odd.astm",
          "VARS theta_i,phi_i,theta_s,phi_s,BRDF,sigma\n.1,0,.2,3,.5,.1\n.1,0,.3,3,.5,"
          "0\n");
    write("text.csv", "sigma\nhalf\n");
    const std::string out = " --residuals " + path("r.csv") + " -o " + path("f.json");
    const auto refused = [&](const std::string& arguments, int code, const std::string& part) {
        expectError("fit " + arguments + out, code, part, 7);
    };
    const std::string plain = path("plain.astm") + " --model lambert ";
    refused(plain + "--sigma two", 2, "2%+0.001");
    refused(plain + "--sigma column", 2, "sigma");
    refused(plain + "--scans column", 2, "scan");
    refused(plain + "--sigma " + path("short.csv"), 3, "108");
    refused(plain + "--sigma " + path("named.csv"), 3, "columns");
    refused(plain + "--sigma " + path("zero.csv"), 3, "line 2");
    refused(plain + "--sigma " + path("text.csv"), 3, "line 2");
    refused(plain + "--sigma " + path("absent.csv"), 3, "absent.csv");
    refused(path("odd.astm") + " --model lambert", 3, "line 3");
    refused(plain + "--sigma 1e-200", 3, "1e-200");
    refused(plain + "--sigma 1e200", 3, "line 2");
    refused(plain + "--sigma 2% --loss log", 2, "l2");
    refused(plain + "--sigma 2% --robust huber", 2, "robust");
    refused(plain + "--sigma 2% --weights solid-angle", 2, "--weights");
    refused("lambert --model lambert --scans 5", 2, "single samples");
    refused("lambert:kd=0 --model lambert --sigma 2%", 3, "absolute");
    expectError("fit " + path("plain.astm") + " --compare-models lambert --profile", 2, "--profile",
                7);
}

TEST_F(Laboratory, BandsAreARowForEachPairAndAgreeWithTheModelAndTheResiduals) {
    const Table table;
    write("own.astm", table.astm);
    const std::string fitted = path("own.astm") + " --sigma column --model oren-nayar ";
    ASSERT_EQ(run("fit " + fitted + "--residuals " + path("r.csv") + " -o " + path("f.json")).code,
              0);
    // The directions of the residuals as pairs: the same errors there.
    const Json fit = answer(fitted + "--bands " + path("r.csv") + " --bands-to " + path("b.csv"));
    EXPECT_EQ(fit["fit"]["bands"]["count"], 96);
    EXPECT_EQ(fit["bands"].size(), 96u);
    std::istringstream residuals(read(path("r.csv"))), bands(read(path("b.csv")));
    const auto next = [](std::istringstream& rows) {
        std::string line;
        std::getline(rows, line);
        std::vector<double> cells;
        std::istringstream parts(line);
        for (std::string cell; std::getline(parts, cell, ',');)
            cells.push_back(std::strtod(cell.c_str(), nullptr));
        return cells;
    };
    next(residuals), next(bands);
    for (std::size_t k = 0; k < 96; ++k) {
        const std::vector<double> residual = next(residuals), band = next(bands);
        ASSERT_EQ(band.size(), 17u);
        EXPECT_NEAR(band[8], residual[10], 1e-12);
        EXPECT_NEAR(band[9], residual[19], 1e-9 * residual[19]);
        // 96 values less two parameters, and somewhat fewer where few of them decide.
        EXPECT_GT(band[10], 20);
        EXPECT_LT(band[10], 96);
        EXPECT_GT(band[12], band[8] + band[9]);
        EXPECT_LT(band[12], band[8] + 1.03 * band[9]);
        EXPECT_GE(band[16], band[14] - 1e-12);
        EXPECT_EQ(fit["bands"][k]["f"], band[8]);
        EXPECT_EQ(fit["bands"][k]["degrees_of_freedom"], band[10]);
    }
    EXPECT_GE(fit["fit"]["bands"]["simultaneous_95"], fit["fit"]["bands"]["pointwise_95"]);
    const Json plane = answer(fitted + "--bands plane:0/30.5");
    EXPECT_EQ(plane["bands"].size(), 2 * 179u);
    EXPECT_NEAR(plane["bands"][0]["wi"][2].get<double>(), 1, 1e-12);
}

TEST_F(Laboratory, WrongBandsAreOneLineAndLeaveNothing) {
    const Table table;
    write("own.astm", table.astm);
    write("below.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,1,0,0,1\n0,0,1,0,0,-1\n");
    write("none.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n");
    const auto refused = [&](const std::string& arguments, int code, const std::string& part) {
        expectError(
            "fit " + path("own.astm") + " --model lambert " + arguments + " -o " + path("f.json"),
            code, part, 3);
    };
    const std::string to = " --bands-to " + path("b.csv");
    refused("--bands plane:90" + to, 2, "'90'");
    refused("--bands plane:" + to, 2, "plane:30/60");
    refused("--bands plane:30/nan" + to, 2, "'nan'");
    refused("--bands plane:30", 2, "--bands-to");
    refused(to, 2, "--bands PAIRS");
    refused("--bands " + path("below.csv") + to, 3, "pair 2");
    refused("--bands " + path("none.csv") + to, 3, "no pair");
    refused("--bands " + path("absent.csv") + to, 3, "absent.csv");
    refused("--bands plan:30" + to, 3, "--bands 'plan:30': no such file; expected a CSV");
}

TEST_F(Laboratory, EverySampleOfASpectralFileIsInTheAnswer) {
    const std::string file = shared("cornell/garnet_red.brdf");
    if (!fs::exists(file)) GTEST_SKIP() << "no shared data";
    const Json preset =
        answer(file + " --model lambert+ggx:F0=.04 --sigma 5%+0.002 -o " + path("f.json"));
    EXPECT_EQ(preset["fit"]["samples"], 1439);
    EXPECT_EQ(preset["fit"]["values"], 1439 * 31);
    ASSERT_EQ(preset["spectrum"].size(), 31u);
    EXPECT_TRUE(keepsSchema(read(path("f.json")), "preset"));
    const Answer at = run("eval " + path("f.json") + " --wi 30,0 --wo 30,180");
    EXPECT_EQ(at.code, 0) << at.err;
    EXPECT_EQ(at.out.substr(0, 5), "400nm");
    EXPECT_EQ(std::count(at.out.begin(), at.out.end(), '\n'), 31);
    EXPECT_EQ(run("info " + path("f.json")).code, 0);
    // Beside the mirror direction, where neighbours read 2 to 33 1/sr, these lines read below
    // 0.001.
    const Json& outliers = preset["fit"]["influence"]["outliers"];
    ASSERT_FALSE(outliers.empty());
    EXPECT_EQ(outliers[0]["row"], 1451);
}

TEST_F(Laboratory, PtfeFollowsLawsOverTheWavelengthAndOpensBetweenThem) {
    const std::string file = shared("nist_ptfe/PTFE.data.csv");
    if (!fs::exists(file)) GTEST_SKIP() << "no shared data";
    const Json preset = answer(file +
                               " --model lambert+ggx:fresnel=dielectric,ks=1 --sigma 0.7% "
                               "--dispersion ior=cauchy:2,kd=poly:2 -o " +
                               path("f.json"));
    EXPECT_EQ(preset["fit"]["samples"], 1824);
    EXPECT_EQ(preset["fit"]["dispersion"]["laws"][0]["law"], "cauchy:2");
    EXPECT_EQ(preset["fit"]["uncertainty"]["degrees_of_freedom"], 4 * 1824 - 6);
    EXPECT_TRUE(keepsSchema(read(path("f.json")), "preset"));
    const Answer at = run("eval " + path("f.json") + ":nm=400/900 --wi 30,0 --wo 40,180");
    EXPECT_EQ(at.code, 0) << at.err;
    EXPECT_EQ(at.out.substr(0, 5), "400nm");
    const auto refused = [&](const std::string& arguments, int code, const std::string& part) {
        expectError(arguments, code, part, 1);
    };
    refused("eval " + path("f.json") + ":nm=350 --wi 30,0 --wo 40,180", 2, "351 to 1064 nm");
    const std::string fit = "fit " + file + " --model lambert --dispersion ";
    refused(fit + "kd=cauchy", 2, "index of refraction");
    refused(fit + "ior=cauchy", 2, "no free parameter");
    refused(fit + "kd=spline:5", 2, "4 wavelengths");
    refused(fit + "kd=poly:1 --per-channel", 2, "free");
    refused("fit lambert --model lambert --dispersion kd=poly:1", 2, "wavelengths");
    refused("fit lambert --model ggx:metal=gold", 2, "wavelengths");
}

TEST_F(Laboratory, AGreyFileHasOneAnswerWithAndWithoutThePrefix) {
    const std::string file = shared("alta/retro-gray-tape.dat");
    if (!fs::exists(file)) GTEST_SKIP() << "no shared data";
    const std::string end = " --model lambert+ggx --sigma 5%+0.002 --scans 40";
    Json plain = answer(file + end), grey = answer("grey:" + file + end);
    for (Json* one : {&plain, &grey}) {
        EXPECT_EQ((*one)["fit"]["samples"], 7400);
        (*one)["fit"].erase("data");
    }
    EXPECT_EQ(plain["fit"], grey["fit"]);
    EXPECT_EQ(plain["spec"], grey["spec"]);
}

}  // namespace
