// Pictures and coefficients that are mirrored, tilted and turned, in every way that they are read.
#include "temporary_folder.h"

#include <hshfit/bases/sh.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/error.h>
#include <hshfit/irradiance/direct_irradiance.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/coefficient_light.h>
#include <hshfit/light/light_health.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/light/placement.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

namespace hshfit {
namespace {

Direction latticeDirection(std::size_t k, std::size_t count) {
    const double z = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count);
    const double s = std::sqrt((1 - z) * (1 + z)), phi = 2.399963229728653 * static_cast<double>(k);
    return {s * std::cos(phi), s * std::sin(phi), z};
}

/// A picture without any symmetry.
PictureLight picture(PictureLayout layout, std::size_t width, std::size_t height) {
    PictureLight light{
        .file = "made", .width = width, .height = height, .rgb = {}, .layout = layout};
    for (std::size_t k = 0; k < width * height; ++k) {
        const double x = static_cast<double>(k % width) / static_cast<double>(width);
        const double y = static_cast<double>(k / width) / static_cast<double>(height);
        for (const double shift : {0.1, 0.7, 1.9})
            light.rgb.push_back(static_cast<float>(
                1.2 + std::sin(5 * x + shift) * std::cos(4 * y - shift) + (k % 17 == 3 ? 2 : 0)));
    }
    return light;
}

/// The direction to which a placement of the specification takes a direction of the light, by
/// rotation matrices written out here: the mirror, Rodrigues' formula about the axis, the turn
/// about +z.
using Way = std::function<Direction(const Direction&)>;
Way wayOf(bool mirror, Direction axis, double tilt, double turn) {
    return [=](Direction d) {
        if (mirror) d.y = -d.y;
        const double length = std::sqrt(dot(axis, axis));
        const Direction n{axis.x / length, axis.y / length, axis.z / length};
        const double c = std::cos(tilt), s = std::sin(tilt), along = dot(n, d) * (1 - c);
        const Direction t{c * d.x + s * (n.y * d.z - n.z * d.y) + along * n.x,
                          c * d.y + s * (n.z * d.x - n.x * d.z) + along * n.y,
                          c * d.z + s * (n.x * d.y - n.y * d.x) + along * n.z};
        return rotateAboutZ(t, turn);
    };
}

struct Placement {
    bool mirror;
    Direction axis;
    double tilt, turn;

    template <class Placed>
    Light of(Placed light) const {
        if (mirror) light = mirrorImage(std::move(light));
        if (tilt != 0) light = rotated(std::move(light), Rotation::aboutAxis(axis, tilt));
        return turned(Light(std::move(light)), turn);
    }
    Way way() const { return wayOf(mirror, axis, tilt, turn); }
};

const std::vector<Placement> placements = {{true, {0, 1, 0}, 0, 0},
                                           {true, {0, 1, 0}, 0, 0.8},
                                           {false, {1, 0, 0}, 0.6, 0},
                                           {false, {1, -2, 0.5}, -1.9, 2.5},
                                           {true, {-1, 1, 3}, 2.2, -0.4}};

TEST(PicturePlacement, RadianceMovesWithTheDirections) {
    for (const PictureLayout layout : {PictureLayout::latlong, PictureLayout::equalArea}) {
        const PictureLight still = picture(layout, 64, layout == PictureLayout::latlong ? 32 : 64);
        for (const Placement& place : placements) {
            const Light moved = place.of(still);
            const Way way = place.way();
            int same = 0;
            for (std::size_t k = 0; k < 1000; ++k) {
                const Direction d = latticeDirection(k, 1000);
                same += radianceFrom({&moved, 1}, way(d)) == radianceOf(still, d);
            }
            EXPECT_GE(same, 998);  // a direction on the edge of pixels may fall into either
        }
    }
}

TEST(PicturePlacement, MirroredTwiceIsTheLightAgainAlsoAfterTurns) {
    const PictureLight still = picture(PictureLayout::latlong, 32, 16);
    const Light moved = placements.back().of(still);
    const PictureLight once = mirrorImage(std::get<PictureLight>(moved));
    const Light twice = mirrorImage(once);
    for (std::size_t k = 0; k < 300; ++k) {
        const Direction d = latticeDirection(k, 300);
        EXPECT_EQ(radianceFrom({&moved, 1}, d), radianceFrom({&twice, 1}, d));
        EXPECT_EQ(radianceOf(once, {d.x, -d.y, d.z}), radianceFrom({&moved, 1}, d));
    }
}

/// The series of the moved light at moved directions equals the series of the light at rest.
TEST(PicturePlacement, CoefficientsMoveExactly) {
    const auto harmonics = bases::makeSh(6, {});
    const auto series = [&](const LightCoefficients& c, const Direction& d) {
        std::vector<double> values(36);
        harmonics->evaluate(d, values.data());
        double sum = 0;
        for (std::size_t k = 0; k < 36; ++k) sum += c.at(1)[k] * values[k];
        return sum;
    };
    const auto expectMoved = [&](const auto& still) {
        const Light rest = still;
        const LightCoefficients before = projectLight({&rest, 1}, *harmonics);
        for (const Placement& place : placements) {
            const Light moved = place.of(still);
            const LightCoefficients after = projectLight({&moved, 1}, *harmonics);
            const Way way = place.way();
            for (std::size_t k = 0; k < 50; ++k) {
                const Direction d = latticeDirection(k, 50);
                EXPECT_NEAR(series(after, way(d)), series(before, d), 2e-6);
            }
            EXPECT_NEAR(after.energy.value, before.energy.value, 1e-9 * before.energy.value);
        }
    };
    expectMoved(picture(PictureLayout::latlong, 64, 32));
    expectMoved(picture(PictureLayout::faces, 24 * 6, 24));
    const Light rest = picture(PictureLayout::latlong, 64, 32);
    LightCoefficients own = projectLight({&rest, 1}, *harmonics);
    expectMoved(coefficientLight(own, "own"));
    const auto condon = bases::makeSh(6, {.condonShortley = true});
    expectMoved(coefficientLight(projectLight({&rest, 1}, *condon), "signed"));
}

TEST(PicturePlacement, IrradianceAndHemispheresMoveWithTheNormal) {
    for (const PictureLayout layout : {PictureLayout::latlong, PictureLayout::faces}) {
        const PictureLight still = layout == PictureLayout::latlong ? picture(layout, 64, 32)
                                                                    : picture(layout, 32, 32 * 6);
        const Light rest = still;
        const DirectIrradiance before({&rest, 1});
        const auto basis = bases::makeSh(1, {});
        for (const Placement& place : placements) {
            const Light moved = place.of(still);
            const DirectIrradiance after({&moved, 1});
            for (std::size_t k = 0; k < 20; ++k) {
                const Direction n = latticeDirection(k, 20), to = place.way()(n);
                const Rgb a = before.at(n), b = after.at(to);
                for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-9 * a[c]);
                const auto flux = [](const Light& light, const Direction& normal) {
                    LightDomain domain{
                        .normal = Orientation{.theta = polarAngle(normal), .phi = azimuth(normal)}};
                    const LightNodes nodes = nodesOf(light, domain, 4, 1);
                    double sum = 0;
                    for (const double part : nodes.flux[2]) sum += part;
                    return sum;
                };
                if (layout == PictureLayout::latlong) {
                    EXPECT_NEAR(flux(moved, to), flux(rest, n), 1e-9 * flux(rest, n));
                }
            }
        }
    }
}

TEST(PicturePlacement, HealthIsThatOfTheLightAtRest) {
    const PictureLight still = picture(PictureLayout::latlong, 64, 32);
    const LightHealth before = examine({still});
    for (const Placement& place : placements) {
        const LightHealth after = examine({place.of(still)});
        EXPECT_NEAR(after.mean[0], before.mean[0], 1e-12);
        EXPECT_NEAR(dot(after.peakDirection, place.way()(before.peakDirection)), 1, 1e-12);
    }
}

/// A dome is the half of the sphere above the horizon, black below: uniform ones of radiance 1 have
/// the mean 1/2, and other lights shine below the horizon as well.
TEST(PicturePlacement, DomesHaveNothingBelowTheHorizon) {
    PictureLight dome = picture(PictureLayout::dome, 64, 64);
    std::ranges::fill(dome.rgb, 1.F);
    const Light light = dome;
    EXPECT_EQ(radianceFrom({&light, 1}, {0.6, 0, 0.8})[0], 1);
    EXPECT_EQ(radianceFrom({&light, 1}, {0.6, 0, -0.8})[0], 0);
    const LightHealth health = examine({light});
    EXPECT_NEAR(health.mean[0], 0.5, 1e-4);
    EXPECT_NEAR(health.blackShare, 0.5, 1e-4);
    const SkyLight all{.zenith = {2, 2, 2}, .ground = {3, 3, 3}};
    EXPECT_NEAR(examine({light, all}).mean[0], 0.5 * (1 + 2) + 0.5 * 3, 1e-3);
    // E of a horizontal surface under a uniform sky of radiance 1 is pi; of a vertical one pi / 2.
    const DirectIrradiance irradiance({&light, 1});
    EXPECT_NEAR(irradiance.at({0, 0, 1})[1], pi, 1e-3 * pi);
    EXPECT_NEAR(irradiance.at({1, 0, 0})[1], pi / 2, 2e-3 * pi);
    EXPECT_NEAR(irradiance.at({0, 0, -1})[1], 0, 1e-3 * pi);
    const LightCoefficients c = projectLight({&light, 1}, *bases::makeSh(3, {}));
    EXPECT_NEAR(c.values[0], std::sqrt(pi), 1e-3);
    EXPECT_NEAR(c.values[2], pi * std::sqrt(3 / (4 * pi)), 2e-3);
    EXPECT_NEAR(c.values[6], 0, 2e-3);
}

class PlacedFiles : public testing::Test {
protected:
    std::string pfm(const std::string& name, int width, int height) const {
        std::ofstream out(folder_ / name, std::ios::binary);
        out << "Pf\n" << width << " " << height << "\n-1.0\n";
        for (int row = height; row-- > 0;)
            for (int column = 0; column < width; ++column) {
                const auto value = static_cast<float>(1 + column + 10 * row);
                out.write(reinterpret_cast<const char*>(&value), sizeof value);
            }
        return folder_ / name;
    }
    test::TemporaryFolder folder_;
};

TEST_F(PlacedFiles, KeysMirrorThenTiltThenTurn) {
    const std::string file = pfm("p.pfm", 32, 16);
    const auto still = std::get<PictureLight>(parseLights(file).lights.front());
    const auto expectWay = [&](const std::string& keys, const Way& way) {
        const auto moved = parseLights(file + ":" + keys).lights;
        int same = 0;
        for (std::size_t k = 0; k < 400; ++k) {
            const Direction d = latticeDirection(k, 400);
            same += radianceFrom(moved, way(d)) == radianceOf(still, d);
        }
        EXPECT_GE(same, 398) << keys;
    };
    expectWay("mirror=yes", wayOf(true, {0, 1, 0}, 0, 0));
    expectWay("tilt=30", wayOf(false, {0, 1, 0}, radians(30), 0));
    expectWay("tilt=90,axis=1/1/1", wayOf(false, {1, 1, 1}, radians(90), 0));
    expectWay("turn=40,axis=-1/0.5/2,tilt=-70,mirror=yes",
              wayOf(true, {-1, 0.5, 2}, radians(-70), radians(40)));
    EXPECT_THROW(parseLights(file + ":axis=1/0/0"), UsageError);
    EXPECT_THROW(parseLights(file + ":tilt=10,axis=0"), UsageError);
    EXPECT_THROW(parseLights("sky:type=1,mirror=yes"), UsageError);
}

TEST_F(PlacedFiles, DomesOfRowsAreTheUpperHalfOfALatlongPicture) {
    const std::string file = pfm("d.pfm", 32, 8);
    const auto light = std::get<PictureLight>(parseLights(file).lights.front());
    EXPECT_EQ(light.fileLayout, PictureLayout::dome);
    // Row 7 is just above the horizon, column 15 just left of +x.
    EXPECT_EQ(radianceOf(light, directionFromAngles(radians(89.9), radians(0.1)))[0], 1 + 15 + 70);
    EXPECT_EQ(radianceOf(light, directionFromAngles(radians(90.1), radians(0.1)))[0], 0);
    EXPECT_EQ(radianceOf(light, directionFromAngles(radians(1), radians(-179)))[0], 1 + 31);
    // A stated dome may have any proportion; a stated latlong of the same size is a whole sphere.
    const auto wide =
        std::get<PictureLight>(parseLights(pfm("w.pfm", 50, 11) + ":layout=dome").lights.front());
    EXPECT_EQ(radianceOf(wide, directionFromAngles(radians(89), radians(-179)))[0], 1 + 49 + 100);
    const auto whole = std::get<PictureLight>(parseLights(file + ":layout=latlong").lights.front());
    EXPECT_EQ(radianceOf(whole, directionFromAngles(radians(179), radians(0.1)))[0], 1 + 15 + 70);
}

TEST_F(PlacedFiles, FilesOfCoefficientsMirrorAndTiltAsPicturesDo) {
    const Light rest = picture(PictureLayout::latlong, 32, 16);
    LightCoefficients c = projectLight({&rest, 1}, *bases::makeSh(4, {}));
    c.source = "made";
    const std::string file = folder_ / "c.json";
    writeLight(c, file);
    const auto still = parseLights(file).lights;
    const auto moved = parseLights(file + ":mirror=yes,tilt=50,axis=0/1/1").lights;
    const Way way = wayOf(true, {0, 1, 1}, radians(50), 0);
    for (std::size_t k = 0; k < 100; ++k) {
        const Direction d = latticeDirection(k, 100);
        EXPECT_NEAR(radianceFrom(moved, way(d))[2], radianceFrom(still, d)[2], 1e-12);
    }
}

}  // namespace
}  // namespace hshfit
