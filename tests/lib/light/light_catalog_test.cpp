#include "hosek_wilkie_file.h"
#include "temporary_folder.h"

#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_samples.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace hshfit {
namespace {

/// A folder with tables of the name that the catalog's example has.
const std::string& tablesFolder() {
    static const test::TemporaryFolder folder;
    static const std::string path = [] {
        for (const auto& [space, file] : {std::pair("RGB", "RGB"), {"XYZ", "CIEXYZ"}})
            std::ofstream(folder / fmt::format("ArHosekSkyModelData_{}.h", file))
                << test::hosekWilkieFile(space, test::plainHosekWilkie);
        return folder.path().string();
    }();
    return path;
}

std::string hosekWilkie(const std::string& file, const std::string& keys) {
    return fmt::format("hosek-wilkie:data={}/ArHosekSkyModelData_{}.h,{}", tablesFolder(), file,
                       keys);
}

/// Every kind, most in several ways.
const std::vector<std::string> specs = {
    "uniform:",
    "uniform:irradiance=1/2/3",
    "directional:elevation=35,azimuth=200,irradiance=2/1/0.5",
    "sun:elevation=60,azimuth=-30",
    "sun:elevation=60,azimuth=20,angle=30,radiance=2",
    "panel:width=60,height=20,elevation=50,azimuth=80,roll=25,radiance=3",
    "panel:irradiance=2",
    "sky:type=1",
    "sky:type=5,irradiance=3,ground=0.2",
    "sky:type=3,radiance=1/2/3",
    "sky:type=7,elevation=20,azimuth=50,irradiance=1",
    "sky:type=12,elevation=45,azimuth=10,irradiance=1/2/3,ground=0.1",
    "sky:type=15,elevation=75,azimuth=300,irradiance=2",
    "sky:type=14,elevation=2,azimuth=300,irradiance=2",
    "preetham:elevation=50,azimuth=70",
    "preetham:turbidity=6,elevation=15,irradiance=2/2.5/3",
    "preetham:turbidity=2,elevation=80,radiance=3",
    "perez:elevation=40,azimuth=30,direct=300,diffuse=260",
    "perez:elevation=60,direct=800,diffuse=110,ground=20",
    "sun:latitude=50.1,longitude=14.4,date=2024-06-21,time=09:30,zone=2",
    hosekWilkie("RGB", "elevation=40,azimuth=30"),
    hosekWilkie("CIEXYZ", "elevation=3,azimuth=-100,ground=1,turbidity=8.5"),
    hosekWilkie("RGB", "elevation=88,albedo=0.4,irradiance=1/2/3"),
};

/// Directions over the whole sphere, in no order.
std::vector<Direction> directions(std::size_t count) {
    std::vector<Direction> all;
    const double golden = pi * (3 - std::sqrt(5.0));
    for (std::size_t k = 0; k < count; ++k) {
        const double z = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count);
        const double s = std::sqrt((1 - z) * (1 + z)), phi = golden * static_cast<double>(k);
        all.push_back({s * std::cos(phi), s * std::sin(phi), z});
    }
    return all;
}

Rgb radiance(const std::string& spec, const Direction& world) {
    return radianceFrom(parseLights(spec).lights, world);
}

Rgb irradiance(const LightSamples& samples) {
    Rgb sum{};
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t k = 0; k < samples.count(); ++k) {
            sum[c] += samples.flux[c][k] * samples.z[k];
        }
    }
    return sum;
}

std::string with(const std::string& spec, const std::string& option) {
    return spec + (spec.back() == ':' ? "" : ",") + option;
}

std::string messageOf(const std::string& spec) {
    try {
        parseLights(spec);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "no error";
}

TEST(LightCatalog, ExamplesParseToOneLightEach) {
    for (const LightKind& kind : lightKinds()) {
        const LightSpecification parsed = parseLights(std::string(kind.example), tablesFolder());
        EXPECT_EQ(parsed.lights.size(), 1U) << kind.example;
        EXPECT_TRUE(namesLight(kind.example)) << kind.example;
        EXPECT_EQ(parsed.text, kind.example);
    }
}

TEST(LightCatalog, AStudioIsSeveralLightsThatTurnAndScaleTogether) {
    const auto plain = parseLights("studio"), turned = parseLights("studio:turn=30,scale=2");
    EXPECT_EQ(plain.lights.size(), 5U);
    ASSERT_EQ(parseLights("uniform+studio").lights.size(), 6U);
    EXPECT_EQ(turned.terms, std::vector<std::string>{"studio:turn=30,scale=2"});
    for (const Direction& d : directions(2000)) {
        const double phi = radians(-30);
        const Direction back{d.x * std::cos(phi) - d.y * std::sin(phi),
                             d.x * std::sin(phi) + d.y * std::cos(phi), d.z};
        const auto expected = radianceFrom(plain.lights, back);
        const auto found = radianceFrom(turned.lights, d);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t c = 0; c < found.size(); ++c)
            EXPECT_NEAR(found[c], 2 * expected[c], 1e-9 * (1 + found[c])) << d.x << ' ' << d.y;
    }
    EXPECT_THROW(parseLights("studio:elevation=3"), UsageError);
}

TEST(LightCatalog, EveryKindIsHeldToTheLaws) {
    for (const LightKind& kind : lightKinds()) {
        const auto isOfKind = [&](const std::string& spec) {
            return spec.starts_with(std::string(kind.name) + ":");
        };
        EXPECT_TRUE(std::ranges::any_of(specs, isOfKind)) << kind.name;
    }
}

TEST(LightCatalog, RadianceIsFiniteAndNotNegative) {
    for (const std::string& spec : specs) {
        const LightSpecification parsed = parseLights(spec);
        for (const Direction& d : directions(2000)) {
            for (const double value : radianceFrom(parsed.lights, d)) {
                ASSERT_TRUE(std::isfinite(value) && value >= 0) << spec << " " << value;
            }
        }
        for (const Direction& d : {Direction{1, 0, 0}, Direction{0, 0, 1}, Direction{0, 0, -1}}) {
            for (const double value : radianceFrom(parsed.lights, d)) {
                ASSERT_TRUE(std::isfinite(value) && value >= 0) << spec << " " << value;
            }
        }
    }
}

/// The irradiance that a specification states, of the surface that its kind's help names.
struct Stated {
    std::string spec;
    Orientation surface;
    Rgb irradiance;
    double lattice;  ///< relative error of 100,000 points of the lattice
};

TEST(LightCatalog, IrradianceIsAsStatedByTwoSetsOfSamples) {
    const auto facing = [](double elevation, double azimuth) {
        return Orientation{radians(90 - elevation), radians(azimuth), 0.3};
    };
    const std::vector<Stated> cases = {
        {"uniform:irradiance=1/2/3", facing(-20, 70), {1, 2, 3}, 1e-4},
        {"directional:elevation=35,azimuth=200,irradiance=2/1/0.5",
         facing(35, 200),
         {2, 1, 0.5},
         1e-12},
        {"sun:elevation=60,azimuth=-30,irradiance=3", facing(60, -30), {3, 3, 3}, 1e-4},
        {"sun:elevation=10,azimuth=5,angle=90,irradiance=2", facing(10, 5), {2, 2, 2}, 1e-4},
        {"panel:elevation=50,azimuth=80,width=60,height=20,roll=25,irradiance=2",
         facing(50, 80),
         {2, 2, 2},
         1e-4},
        {"sky:type=5,irradiance=3", {}, {3, 3, 3}, 1e-4},
        {"sky:type=12,elevation=45,azimuth=10,irradiance=1/2/3", {}, {1, 2, 3}, 3e-4},
        {"sky:type=15,elevation=75,irradiance=2", {}, {2, 2, 2}, 3e-4},
        {"sky:type=14,elevation=2,irradiance=2", {}, {2, 2, 2}, 3e-4},
        {"preetham:turbidity=6,elevation=15,irradiance=2/2.5/3", {}, {2, 2.5, 3}, 3e-4},
        {"perez:elevation=40,direct=300,diffuse=260", {}, {260, 260, 260}, 5e-4},
        {hosekWilkie("RGB", "elevation=40,irradiance=2/2.5/3"), {}, {2, 2.5, 3}, 5e-4},
        {hosekWilkie("CIEXYZ", "elevation=4,irradiance=2/2.5/3"), {}, {2, 2.5, 3}, 5e-4},
    };
    for (const Stated& one : cases) {
        const LightSpecification parsed = parseLights(one.spec);
        const Frame frame(one.surface);
        const Rgb nodes = irradiance(sampleLights(parsed.lights, frame, 3));
        const Rgb lattice = irradiance(latticeSamples(parsed.lights, frame, 100000));
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(nodes[c], one.irradiance[c], 2e-6 * one.irradiance[c]) << one.spec;
            EXPECT_NEAR(lattice[c], one.irradiance[c], one.lattice * one.irradiance[c]) << one.spec;
        }
    }
}

TEST(LightCatalog, TiltedSurfacesAgreeByBothSetsOfSamples) {
    for (const std::string& spec : specs) {
        const LightSpecification parsed = parseLights(spec);
        for (const Orientation& surface : {Orientation{0.7, 1, 0}, Orientation{2.2, 4, 1}}) {
            const Frame frame(surface);
            const Rgb nodes = irradiance(sampleLights(parsed.lights, frame, 3));
            const Rgb lattice = irradiance(latticeSamples(parsed.lights, frame, 100000));
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(nodes[c], lattice[c], 2e-3 * nodes[c] + 1e-9) << spec;
            }
        }
    }
}

TEST(LightCatalog, ATurnedLightIsTheLightSeenInTurnedDirections) {
    for (const std::string& spec : specs) {
        const LightSpecification plain = parseLights(spec);
        const LightSpecification turned = parseLights(with(spec, "turn=37"));
        std::size_t differ = 0;
        for (const Direction& d : directions(3000)) {
            const Rgb a = radianceFrom(plain.lights, d);
            const Rgb b = radianceFrom(turned.lights, rotateAboutZ(d, radians(37)));
            for (std::size_t c = 0; c < 3; ++c) {
                // The rim of a disc or panel may fall on either side.
                if (std::abs(a[c] - b[c]) > 1e-9 * (a[c] + b[c])) ++differ;
            }
        }
        EXPECT_LE(differ, 3U) << spec;
    }
    const LightSpecification beam = parseLights("directional:elevation=0,turn=90");
    EXPECT_NEAR(std::get<DirectionalLight>(beam.lights[0]).towards.y, 1, 1e-15);
}

TEST(LightCatalog, ScaleIsLinearAndSumsAdd) {
    const auto other = parseLights("sky:type=3,ground=0.5").lights;
    for (const std::string& spec : specs) {
        const auto plain = parseLights(spec).lights;
        const auto scaled = parseLights(with(spec, "scale=2.5")).lights;
        const auto sum = parseLights(spec + " + sky:type=3,ground=0.5+" + spec).lights;
        for (const Direction& d : directions(50)) {
            const Rgb one = radianceFrom(plain, d), more = radianceFrom(scaled, d);
            const Rgb all = radianceFrom(sum, d), second = radianceFrom(other, d);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(more[c], 2.5 * one[c], 1e-13 * one[c]) << spec;
                EXPECT_NEAR(all[c], 2 * one[c] + second[c], 1e-13 * (one[c] + 1)) << spec;
            }
        }
    }
    const Light beam = parseLights("directional:elevation=3,irradiance=2,scale=3").lights[0];
    EXPECT_EQ(std::get<DirectionalLight>(beam).irradiance, (Rgb{6, 6, 6}));
}

TEST(LightCatalog, PlusSeparatesTermsButNotExponents) {
    EXPECT_EQ(parseLights("uniform:radiance=1e+3").lights.size(), 1U);
    EXPECT_EQ(radiance("uniform:radiance=1e+3", {})[0], 1000);
    EXPECT_EQ(parseLights("uniform+uniform: +  sky:type=1").lights.size(), 3U);
    EXPECT_EQ(parseLights(" uniform:radiance=2e-1 ").lights.size(), 1U);
    EXPECT_NE(messageOf("uniform:+").find("empty term"), std::string::npos);
    EXPECT_NE(messageOf("+uniform:").find("empty term"), std::string::npos);
    EXPECT_NE(messageOf("").find("empty"), std::string::npos);
}

TEST(LightCatalog, ErrorsNameTheValidKindsKeysAndRanges) {
    EXPECT_NE(messageOf("skye:type=1").find("did you mean 'sky'?"), std::string::npos);
    EXPECT_NE(messageOf("moon:").find("uniform, directional, sun, panel, sky, preetham"),
              std::string::npos);
    EXPECT_NE(messageOf("sky:tipe=1").find("valid: type, elevation"), std::string::npos);
    EXPECT_NE(messageOf("sky:type=16").find("1 to 15"), std::string::npos);
    EXPECT_NE(messageOf("sky:type=2.5").find("whole number"), std::string::npos);
    EXPECT_NE(messageOf("sky:type=12").find("elevation has to be given"), std::string::npos);
    EXPECT_NE(messageOf("sky:").find("type has to be given"), std::string::npos);
    EXPECT_NE(messageOf("sky:type=12,elevation=-1").find("0 to 90"), std::string::npos);
    EXPECT_NE(messageOf("sun:elevation=nan").find("not a finite"), std::string::npos);
    EXPECT_NE(messageOf("sun:elevation=10,scale=-1").find("0 to"), std::string::npos);
    EXPECT_NE(messageOf("sun:elevation=10,irradiance=-1").find("out of range"), std::string::npos);
    EXPECT_NE(messageOf("sun:elevation=10,irradiance=1/2").find("2 values"), std::string::npos);
    EXPECT_NE(messageOf("sun:elevation=10,radiance=1,irradiance=1").find("one of the two"),
              std::string::npos);
    EXPECT_NE(messageOf("sun:latitude=50").find("longitude is missing"), std::string::npos);
    const std::string place = "sun:latitude=50,longitude=14,";
    EXPECT_NE(messageOf(place + "date=2023-02-29,time=12:00").find("no date"), std::string::npos);
    EXPECT_NE(messageOf(place + "date=1023-02-20,time=12:00").find("1950"), std::string::npos);
    EXPECT_NE(messageOf(place + "date=2023-02-20,time=25:00").find("no time"), std::string::npos);
    EXPECT_NE(messageOf(place + "date=2023-02-20,time=01:00").find("below the horizon"),
              std::string::npos);
    EXPECT_NE(messageOf(place + "date=2023-02-20,time=12:00,elevation=3").find("one of the two"),
              std::string::npos);
    EXPECT_THROW(parseLights("no/such/file.exr:turn=1"), InputError);
}

}  // namespace
}  // namespace hshfit
