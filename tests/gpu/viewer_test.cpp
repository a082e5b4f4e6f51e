// The page of the viewer and its reference table; tests/gpu/browser looks at it in a browser.

#include "asymmetric.h"

#include <hshfit/error.h>
#include <hshfit/gpu/viewer.h>

#include <brdfs/catalog.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
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

TEST(Viewer, NamesAreThoseOfTheMaterialAndNotOfFolders) {
    for (const auto& [source, name] : std::map<std::string, std::string>{
             {"/some/where/cc_ibiza_sunset_rgb.bsdf", "cc_ibiza_sunset_rgb"},
             {"gold-metallic.binary", "gold-metallic"},
             {"rgb:data/x/paper.v2.bsdf", "paper.v2"},
             {"maps/hall.hdr:turn=30,scale=0.5", "hall"},
             {"ward:kd=0.1/0.2/0.3,ax=0.2", "ward:kd=0.1/0.2/0.3,ax=0.2"},
             {"ggx:alpha=0.05", "ggx:alpha=0.05"},
             {"lambert", "lambert"},
             {"preset:hsh-phong", "preset:hsh-phong"},
             {"", ""}})
        EXPECT_EQ(shownName(source), name);
    Payload payload = payloadOf(Channels::grey());
    payload.head.source = "/somewhere/secret/satin.bsdf";
    const ViewerInput input = viewerInput(payload, nullptr);
    EXPECT_EQ(input.title, "satin");
    EXPECT_EQ(viewerPage(input).find("secret"), std::string::npos);
}

/// Flux of the picture's texels, by their solid angles.
Rgb fluxOf(const ViewerLight& light) {
    const std::vector<float> radiance = decodeRgbe(light.rgbe);
    Rgb flux{};
    for (int row = 0; row < light.height; ++row) {
        const double angle =
            2 * pi / light.width *
            (std::cos(pi * row / light.height) - std::cos(pi * (row + 1) / light.height));
        for (int k = 3 * row * light.width; k < 3 * (row + 1) * light.width; ++k)
            flux[static_cast<std::size_t>(k % 3)] +=
                angle * static_cast<double>(radiance[static_cast<std::size_t>(k)]);
    }
    return flux;
}

TEST(ViewerLight, PicturesOfSmallLightsKeepTheirFlux) {
    // The flux of light from one direction is its irradiance on a surface across it. The same holds
    // for a sun, but for the cosine over half a degree.
    for (const char* spec : {"directional:elevation=33,azimuth=71,irradiance=1/2/4",
                             "sun:elevation=33,azimuth=71,irradiance=1/2/4"}) {
        const Rgb flux = fluxOf(viewerLight(parseLights(spec), 4));
        EXPECT_NEAR(flux[0], 1, 0.01) << spec;
        EXPECT_NEAR(flux[1], 2, 0.01) << spec;
        EXPECT_NEAR(flux[2], 4, 0.02) << spec;
    }
}

TEST(ViewerLight, UniformLightIsOneCoefficientAndOneValue) {
    const ViewerLight light = viewerLight(parseLights("uniform:radiance=3"), 5, 16);
    EXPECT_EQ(light.rgbe.size(), 4 * 32 * 16u);
    for (const float value : decodeRgbe(light.rgbe)) EXPECT_NEAR(value, 3, 3.0 / 255);
    EXPECT_NEAR(light.coefficients.at(1)[0], 3 * std::sqrt(4 * pi), 1e-5);
    EXPECT_NEAR(light.captured, 1, 1e-6);
    EXPECT_LT(light.pictureError, 2.0 / 255);
}

TEST(ViewerLight, PicturesOfWideLightsHaveTheirCoefficients) {
    for (const char* spec : {"sky:type=12,elevation=40,azimuth=70,radiance=2/3/5",
                             "panel:elevation=20,azimuth=200,width=60,height=30,radiance=5/1/2",
                             "sun:elevation=60,angle=25,radiance=4+uniform:radiance=0.2"}) {
        const ViewerLight light = viewerLight(parseLights(spec), 7);
        EXPECT_LT(light.pictureError, 0.01) << spec;
        EXPECT_EQ(light.width, 256);
    }
}

TEST(ViewerLight, FoldersWithAPlusStayOutOfItsName) {
    const auto folder = std::filesystem::path(testing::TempDir()) / "hshfit+secret+maps";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "hall+1.hdr", std::ios::binary)
        << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n"
        << std::string(4 * 2 * 4, '\x80');
    const std::string text = (folder / "hall+1.hdr").string() + ":layout=latlong+uniform";
    EXPECT_EQ(viewerLight(parseLights(text), 3, 8).name, "hall+1+uniform");
    std::filesystem::remove_all(folder);
}

TEST(Viewer, ShowsAFormBesideOnePayload) {
    const ViewerForm form{.name = "Halfway 3,2,1", .shader = "float form_eval(vec3 o, vec3 i);"};
    ViewerInput input{.title = "paint",
                      .payloads = {payloadOf(Channels::grey())},
                      .form = form,
                      .details = {"12 bytes", "34 bytes"}};
    const std::string page = viewerPage(input);
    for (const char* text : {"Halfway 3,2,1 and HSH", "12 bytes", "34 bytes", "HSH: order"})
        EXPECT_NE(page.find(text), page.npos) << text;
    input.form->spectral = true;
    EXPECT_THROW(viewerPage(input), UsageError);
    input.form->spectral = false;
    input.payloads.push_back(payloadOf(Channels::grey()));
    EXPECT_THROW(viewerPage(input), UsageError);
}

TEST(Viewer, LightsOfAnotherOrderAreRefused) {
    const ViewerInput input{.title = "order",
                            .payloads = {payloadOf(Channels::grey())},
                            .environmentOrder = 5,
                            .lights = {viewerLight(parseLights("uniform"), 4, 4)}};
    EXPECT_THROW(viewerPage(input), UsageError);
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
