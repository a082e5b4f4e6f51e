// The page of the viewer and its reference table; tests/gpu/browser looks at it in a browser.

#include "asymmetric.h"

#include <hshfit/error.h>
#include <hshfit/gpu/viewer.h>

#include <brdfs/catalog.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

namespace hshfit::gpu {
namespace {

std::string contentOf(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

Payload payloadOf(const Channels& channels, const PackOptions& options = {}) {
    return pack(samples::asymmetric("hsh", 4, OutgoingSet::parabolic(8, 12), channels, 3), options);
}

std::vector<std::string> specs() {
    return {"lambert:kd=0.5",
            "phong:exponent=22",
            "phong:exponent=200",
            "ggx:alpha=0.1",
            "ward:ax=0.2,ay=0.2",
            "ward:ax=0.2,ay=0.5",
            "ward:kd=0.1/0.2/0.3,ks=0.3,ax=0.1,ay=0.4",
            "disney:roughness=0.3"};
}

/// Pairs that the table's own error is not measured at.
DirectionPair randomPair(std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto direction = [&] {
        const double z = std::sin(radians(5)) + (1 - std::sin(radians(5))) * uniform(random);
        return directionFromAngles(std::acos(z), 2 * pi * uniform(random));
    };
    const Direction wi = direction();
    return {wi, direction()};
}

TEST(ViewerReference, InterpolatesTheSource) {
    for (const std::string& spec : specs()) {
        const auto brdf = brdfs::open(spec);
        const ReferenceTable table = tabulate(*brdf);
        std::mt19937_64 random(5);
        double wrong = 0, all = 0;
        for (int n = 0; n < 20000; ++n) {
            const auto [wi, wo] = randomPair(random);
            const std::vector<double> f = evaluate(*brdf, wi, wo);
            std::vector<double> found(f.size());
            table.eval(wi, wo, found.data());
            for (std::size_t c = 0; c < f.size(); ++c) {
                wrong += std::pow((found[c] - f[c]) * wi.z, 2);
                all += std::pow(f[c] * wi.z, 2);
            }
        }
        EXPECT_LT(std::sqrt(wrong / all), 0.03) << spec;
        EXPECT_LT(table.error, 0.03) << spec;
    }
}

TEST(ViewerReference, FinerStepsAreBetter) {
    for (const char* spec : {"phong:exponent=200", "ward:ax=0.2,ay=0.5"}) {
        const auto brdf = brdfs::open(spec);
        const double coarse = tabulate(*brdf, {.thetaHalf = 24,
                                               .thetaDifference = 12,
                                               .phiDifference = 7,
                                               .half = 16,
                                               .thetaDifferenceOfFour = 8,
                                               .phiDifferenceOfFour = 6})
                                  .error;
        EXPECT_LT(tabulate(*brdf).error, 0.5 * coarse) << spec;
    }
}

TEST(ViewerReference, IsZeroBelowTheHorizon) {
    const ReferenceTable table = tabulate(*brdfs::open("lambert"), {.errorPairs = 1});
    double f = 1;
    table.eval({0, 0.6, -0.8}, {0, 0, 1}, &f);
    EXPECT_EQ(f, 0);
}

TEST(Viewer, PageIsSelfContainedAndTheSameAgain) {
    const auto brdf = brdfs::open("lambert");
    const ViewerInput input{.title = "<b>&</b> </script>",
                            .payloads = {payloadOf(Channels::grey()), payloadOf(Channels::rgb())},
                            .reference = tabulate(*brdf)};
    const std::string page = viewerPage(input);
    EXPECT_EQ(page, viewerPage(input));
    EXPECT_EQ(page.find("<b>&"), page.npos) << "the title is not escaped";
    for (const char* reference : {"http:", "https:", "<link rel=\"stylesheet", "src=", "@import",
                                  "import(", "fetch(", "url("}) {
        EXPECT_EQ(page.find(reference), page.npos) << reference;
    }
    // One script of data, one of code: nothing in them ends an element early.
    std::size_t ends = 0;
    for (std::size_t at = page.find("</script>"); at != page.npos;
         at = page.find("</script>", at + 1))
        ++ends;
    EXPECT_EQ(ends, 2u);
}

TEST(Viewer, TakesEveryTypeOfNumber) {
    for (const Number number : {Number::float32, Number::unorm16, Number::unorm8}) {
        const ViewerInput input{.title = "numbers",
                                .payloads = {payloadOf(Channels::rgb(), {.number = number})}};
        EXPECT_NE(viewerPage(input).find("The source is not known."), std::string::npos);
    }
}

TEST(Viewer, RefusesWhatItCannotShow) {
    const Payload spectral = payloadOf(Channels::spectral({450, 550, 650}));
    EXPECT_THROW(viewerPage({.title = "", .payloads = {}}), UsageError);
    EXPECT_THROW(viewerPage({.title = "", .payloads = {spectral}}), UsageError);
    const Payload grey = payloadOf(Channels::grey());
    EXPECT_THROW(viewerPage({.title = "", .payloads = {grey, grey, grey}}), UsageError);
    EXPECT_THROW(viewerPage({.title = "", .payloads = {grey}, .environmentOrder = 11}), UsageError);
}

TEST(Viewer, ReplacesAFileOnlyWithForce) {
    const auto path = std::filesystem::path(testing::TempDir()) / "hshfit_viewer.html";
    std::filesystem::remove(path);
    const ViewerInput input{.title = "force", .payloads = {payloadOf(Channels::grey())}};
    writeViewer(path.string(), input);
    EXPECT_EQ(contentOf(path), viewerPage(input));
    std::ofstream(path) << "mine";
    EXPECT_THROW(writeViewer(path.string(), input), OutputError);
    EXPECT_EQ(contentOf(path), "mine");
    writeViewer(path.string(), input, true);
    EXPECT_EQ(contentOf(path), viewerPage(input));
    std::filesystem::remove(path);
    EXPECT_THROW(writeViewer("/nowhere/page.html", input), OutputError);
}

TEST(Viewer, ProjectsTheOtherBasis) {
    const auto brdf = brdfs::open("phong:exponent=5");
    for (const auto& [given, other] : {std::pair{"hsh", "sh"}, std::pair{"sh", "hsh"}}) {
        Payload payload = pack(
            samples::asymmetric(given, 3, OutgoingSet::elevations(4), Channels::grey(), 1), {});
        const ViewerInput input = viewerInput(payload, brdf.get());
        ASSERT_EQ(input.payloads.size(), 2u);
        EXPECT_EQ(input.payloads[1].head.basis, other);
        EXPECT_EQ(input.payloads[1].head.order, 3);
        EXPECT_TRUE(input.reference.has_value());
        EXPECT_EQ(viewerInput(payload, nullptr).payloads.size(), 1u);
    }
}

}  // namespace
}  // namespace hshfit::gpu
