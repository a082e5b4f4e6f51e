// Files of the library keep docs/schemas, as judged by python3-jsonschema.

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/pages/report.h>

#include "lib/coefficient_files/coefficient_samples.h"
#include "places.h"

#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

using namespace hshfit;
using samples::Folder;

namespace {

constexpr int missing = 77;

/// Exit code of tests/validate_schema.py, which prints what is wrong.
int validate(const std::string& schema, const std::string& files) {
    const std::string source = test::sourceFolder();
    const int status = std::system(("/usr/bin/python3 '" + source + "/tests/validate_schema.py' '" +
                                    source + "/docs/schemas/" + schema + ".schema.json' " + files)
                                       .c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

class Schemas : public ::testing::Test {
protected:
    void SetUp() override {
        const int code = validate("report", "/dev/null");
        if (code == missing || code == 127) {
            GTEST_SKIP() << "no /usr/bin/python3 with jsonschema (package python3-jsonschema)";
        }
    }
    const Folder folder;
};

TEST_F(Schemas, CoefficientFiles) {
    std::string paths;
    std::uint64_t seed = 1;
    for (const auto& outgoing : samples::allOutgoing()) {
        for (const auto& channels : samples::allChannels()) {
            const auto quantity = seed % 2 ? Quantity::brdf : Quantity::brdfCosine;
            Coefficients c = samples::make(outgoing, channels, quantity, 3, seed);
            if (seed % 4 == 0) {
                const double none = std::numeric_limits<double>::quiet_NaN();
                c.energy = {none, none, false, "it diverges"};
            }
            const std::string path = folder / (std::to_string(seed++) + ".json");
            writeCoefficients(c, path);
            paths += " '" + path + "'";
        }
    }
    EXPECT_EQ(validate("coefficients", paths), 0);
}

TEST_F(Schemas, InvalidCoefficientFilesAreRefused) {
    const auto c =
        samples::make(OutgoingSet::direction(1, 2), Channels::rgb(), Quantity::brdf, 2, 1);
    writeCoefficients(c, folder / "c.json");
    const auto good = nlohmann::json::parse(samples::contentOf(folder / "c.json"));
    for (const auto& [key, value] : good.items()) {
        auto bad = good;
        bad.erase(key);
        samples::put(folder / "bad.json", bad.dump());
        EXPECT_EQ(validate("coefficients", "'" + folder / "bad.json" + "' >/dev/null"), 1) << key;
    }
}

TEST_F(Schemas, Reports) {
    Report report;
    std::uint64_t seed = 1;
    for (const auto& outgoing : samples::allOutgoing()) {
        Projection p;
        p.coefficients = samples::make(outgoing, Channels::rgb(), Quantity::brdf, 3, seed++);
        p.captured = {0.1, 0.2, 0.3};
        Projection flux = p;
        flux.coefficients.basis = "makhotkin-flux";
        if (seed % 2) {
            p.coefficients.energy = {0, 0, false, "it diverges"};
            p.coefficients.error = std::numeric_limits<double>::quiet_NaN();
        }
        report.reports.push_back(reportEntry(std::vector{p, flux}));
        ReportEntry& entry = report.reports.back();
        wavelets::SliceCurve slices;
        slices.captured = {0, 0.1, 0.2, 0.3, 0.4};
        entry.curves.push_back(waveletCurve(seed % 2 ? nullptr : &slices, entry.energy, 2));
    }
    samples::put(folder / "report.json", reportJson(report));
    EXPECT_EQ(validate("report", "'" + folder / "report.json" + "'"), 0);
}

}  // namespace
