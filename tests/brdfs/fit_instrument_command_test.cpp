// `hshfit fit` with terms of the instrument, as a laboratory meets it.
#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

/// Scans of a Phong lobe with a dark signal, at one wavelength or at four.
std::string table(bool spectral, bool scans) {
    std::string text = "VARS theta_i,phi_i,theta_s,phi_s";
    text += spectral ? ",400nm,410nm,420nm,430nm" : ",BRDF";
    text += scans ? ",scan\n" : "\n";
    std::mt19937 random(6);
    for (int scan = 0; scan < 14; ++scan)
        for (int k = 0; k < 9; ++k) {
            const double in = 0.1 + 0.06 * scan, out = 0.05 + 0.15 * k;
            text += std::to_string(in) + ",0," + std::to_string(out) + ",3.14159265";
            for (int c = 0; c < (spectral ? 4 : 1); ++c) {
                const double noise = static_cast<double>(random()) / 0x1p32 - 0.5;
                const double lobe = 0.4 * std::pow(std::cos(out - in), 20);
                const double f =
                    (0.1 + 0.01 * c + lobe) * (1 + 0.02 * std::sin(scan)) * (1 + 0.02 * noise) +
                    0.003 / std::cos(out);
                text += "," + std::to_string(f);
            }
            text += (scans ? "," + std::to_string(scan) : "") + "\n";
        }
    return text;
}

class Instruments : public Cli {
protected:
    Json answer(const std::string& arguments) {
        const Answer got = run("fit --json " + arguments);
        EXPECT_EQ(got.code, 0) << arguments << "\n" << got.err;
        if (got.code != 0) return {};
        EXPECT_TRUE(keepsSchema(got.out, "fit"));
        return Json::parse(got.out);
    }
    const std::string model = " --model phong --sigma 1%+0.001 ";
};

TEST_F(Instruments, TermsTheirErrorsAndTheMaterialAreInThePreset) {
    write("scans.astm", table(false, true));
    const Json preset =
        answer(path("scans.astm") + model +
               "--scans column --source-aperture cone:0.5 --detector-aperture rectangle:1x2 "
               "--dark fit --scan-scale 2% -o " +
               path("f.json"));
    const Json& fit = preset["fit"];
    const Json& instrument = fit["instrument"];
    EXPECT_EQ(instrument["source_aperture"], (Json{{"shape", "cone"}, {"half_angle", 0.5}}));
    EXPECT_EQ(instrument["detector_aperture"]["half_angle_across"], 2.0);
    EXPECT_LE(instrument["averages"]["largest_change"], 1e-4);
    EXPECT_EQ(instrument["dark"]["over_cosines"], "out");
    EXPECT_EQ(instrument["scales"]["values"].size(), 14u);
    EXPECT_EQ(instrument["scales"]["width"], 0.02);
    ASSERT_EQ(fit["parameters"].size(), 3 + 1 + 14u);
    const Json& dark = fit["parameters"][3];
    EXPECT_EQ(dark["name"], "dark");
    EXPECT_EQ(dark["instrument"], true);
    EXPECT_EQ(dark["value"], instrument["dark"]["values"][0]);
    EXPECT_LT(std::abs(dark["value"].get<double>() - 0.003),
              3 * dark["standard_error"].get<double>());
    EXPECT_EQ(fit["uncertainty"]["covariance"].size(), fit["parameters"].size());
    // 14 scales with a prior each: as many values more as parameters.
    EXPECT_EQ(fit["uncertainty"]["degrees_of_freedom"], 14 * 9 - 4);
    // The material alone opens from it.
    EXPECT_EQ(preset["spec"].get<std::string>().find("dark"), std::string::npos);
    EXPECT_TRUE(keepsSchema(read(path("f.json")), "preset"));
    EXPECT_EQ(run("info " + path("f.json")).code, 0);
    const Answer text = run("fit " + path("scans.astm") + model +
                            "--scans column --detector-aperture cone:1 --scan-scale fit");
    EXPECT_NE(text.out.find("scales of 14 scans"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("averages over apertures"), std::string::npos) << text.out;
}

TEST_F(Instruments, ThreadsDoNotChangeThem) {
    write("scans.astm", table(false, true));
    for (const char* threads : {"1", "3"})
        ASSERT_EQ(run("fit " + path("scans.astm") + model +
                      "--scans column --detector-aperture cone:2 --dark fit --stray 0.01 "
                      "--scan-scale 2% --bootstrap 20 --residuals " +
                      path(std::string("r") + threads) + " --threads " + threads + " -o " +
                      path(std::string(threads) + ".json"))
                      .code,
                  0);
    EXPECT_EQ(read(path("1.json")), read(path("3.json")));
    EXPECT_EQ(read(path("r1")), read(path("r3")));
}

// A reading of a slit mixes wavelengths; the preset has f at each of them.
TEST_F(Instruments, ABandwidthIsTakenOutOfTheSpectrum) {
    write("spectrum.astm", table(true, false));
    const std::string end = path("spectrum.astm") + " --model phong ";
    const Json with = answer(end + "--bandwidth triangle:10"), without = answer(end + "--loss l2");
    EXPECT_EQ(with["fit"]["instrument"]["bandwidth"],
              (Json{{"shape", "triangle"}, {"width", 10.0}}));
    ASSERT_EQ(with["spectrum"].size(), 4u);
    EXPECT_NE(with["spectrum"], without["spectrum"]);
}

TEST_F(Instruments, BandsAreThoseOfFAndResidualsThoseOfReadings) {
    write("scans.astm", table(false, true));
    const std::string end = path("scans.astm") + model + "--dark fit ";
    const Json fit = answer(end + "--detector-aperture cone:1 --bands plane:30");
    // f of the material alone, whose diffuse part is all there is far from the lobe.
    const Json& last = fit["bands"].back();
    EXPECT_GT(last["standard_error"].get<double>(), 0);
    const Answer f =
        run("eval --json '" + fit["spec"].get<std::string>() + "' --wi 30,0 --wo 89,180");
    EXPECT_NEAR(Json::parse(f.out)["values"][0].get<double>(), last["f"].get<double>(), 1e-12);
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    answer(end + "--figures " + path("figures"));
    EXPECT_EQ(read(path("figures/cuts.csv")).find("95 %"), std::string::npos);
    // Readings have a dark signal that f does not; the table of samples allows for it.
    EXPECT_NE(read(path("figures/parameters.tex")).find("sr$^{-1}$"), std::string::npos);
}

TEST_F(Instruments, AnEntryThatDoesNotFitIsOneLineAndLeavesNothing) {
    write("scans.astm", table(false, true));
    write("plain.astm", table(false, false));
    write("spectrum.astm", table(true, false));
    const auto refused = [&](const std::string& arguments, int code, const std::string& part) {
        expectError("fit " + arguments + " -o " + path("f.json"), code, part, 3);
    };
    const std::string scans = path("scans.astm") + " --model lambert ";
    refused(scans + "--detector-aperture cone:95", 2, "below 90");
    refused(scans + "--detector-aperture cone:-1", 2, "above 0");
    refused(scans + "--source-aperture disc:1", 2, "rectangle:HALFxHALF");
    refused(scans + "--source-aperture cone:1 --aperture-tolerance 0", 2, "tolerance");
    refused(scans + "--bandwidth box:-5", 2, "above 0");
    refused(scans + "--bandwidth box:5", 2, "wavelengths");
    refused(path("spectrum.astm") + " --model lambert --bandwidth triangle:20", 4,
            "singular value");
    refused(scans + "--scan-scale 2%", 2, "needs scans");
    refused(scans + "--scans column --scan-scale 2%", 2, "uncertainties");
    refused(scans + "--scans column --scan-scale -2%", 2, "above 0");
    refused(scans + "--offset none", 2, "fit, or a number");
    refused(scans + "--dark fit:up", 2, ":both");
    refused(scans + "--stray 2", 2, "from 0 to 0.9");
    refused(scans + "--offset fit --loss log", 2, "l2 and cosine");
    refused(scans + "--offset fit --robust huber", 2, "robust");
    refused("lambert --model lambert --offset fit", 2, "values of a function");
    refused("lambert --model lambert --offset fit --loss picture", 2, "--offset");
    refused(path("plain.astm") + " --model lambert --scans column --scan-scale fit", 2, "scan");
}

}  // namespace
