#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/one_channel.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/plan/internal/ladder.h>
#include <hshfit/plan/internal/material_light.h>
#include <hshfit/plan/plan_files.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/tradeoff/kept_projections.h>

#include <brdfs/catalog.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>

#include <unistd.h>

namespace hshfit::plan {
namespace {

std::unique_ptr<Brdf> open(const std::string& spec) {
    return brdfs::open(spec);
}

Rgb grey(double value) {
    return {value, value, value};
}

/// Irradiance of the surface, first channel.
double irradiance(const LightSamples& samples) {
    double sum = 0;
    for (std::size_t k = 0; k < samples.count(); ++k) sum += samples.flux[0][k] * samples.z[k];
    return sum;
}

void expectIrradiance(const Light& light, const Orientation& orientation, double expected,
                      const std::string& what) {
    const Light one[] = {light};
    const Frame frame(orientation);
    EXPECT_NEAR(irradiance(sampleLights(one, frame, 4)), expected, 1e-6 * expected) << what;
    EXPECT_NEAR(irradiance(latticeSamples(one, frame, 40000)), expected, 1e-3 * expected) << what;
}

Direction cross(const Direction& a, const Direction& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

TEST(Lights, DiscsPanelsAndSkiesGiveTheIrradianceOfTheirFormulas) {
    // A round source wholly above the horizon: E = pi L sin^2(r) cos(theta).
    for (double theta : {0.0, 40.0, 70.0}) {
        const double radius = radians(9);
        const DiscLight disc{directionFromAngles(radians(theta), 1), radius, grey(2)};
        expectIrradiance(disc, {},
                         2 * pi * std::pow(std::sin(radius), 2) * std::cos(radians(theta)), "disc");
    }
    // A tilted plane under a uniform sky: half of 1 + cos(tilt); an overcast one: 7/9 pi L.
    for (double tilt : {0.0, 30.0, 90.0, 150.0, 180.0}) {
        const SkyLight sky{SkyLight::Model::uniform, grey(1), grey(0.25)};
        const double share = (1 + std::cos(radians(tilt))) / 2;
        expectIrradiance(sky, {radians(tilt), 2, 0.3}, pi * (share + 0.25 * (1 - share)), "sky");
    }
    expectIrradiance(SkyLight{SkyLight::Model::overcast, grey(3), {}}, {}, 3 * pi * 7 / 9,
                     "overcast");
}

TEST(Lights, APanelGivesTheIrradianceOfItsPolygon) {
    // Lambert's formula: E = L/2 sum over edges of the angle times the normal's share of its axis.
    const double width = radians(50), height = radians(30);
    const Direction centre = directionFromAngles(radians(35), radians(70));
    const Direction east{-std::sin(radians(70)), std::cos(radians(70)), 0};
    const Direction south = cross(east, centre);
    const auto corner = [&](double a, double b) {
        const double x = a * std::tan(width / 2), y = b * std::tan(height / 2);
        Direction d{centre.x + x * east.x + y * south.x, centre.y + x * east.y + y * south.y,
                    centre.z + x * east.z + y * south.z};
        const double length = std::sqrt(dot(d, d));
        return Direction{d.x / length, d.y / length, d.z / length};
    };
    const Direction corners[] = {corner(1, 1), corner(1, -1), corner(-1, -1), corner(-1, 1)};
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
        const Direction &a = corners[k], &b = corners[(k + 1) % 4];
        const Direction axis = cross(a, b);
        const double length = std::sqrt(dot(axis, axis));
        sum += std::acos(dot(a, b)) * axis.z / length;
    }
    expectIrradiance(PanelLight{centre, width, height, 0, grey(1)}, {}, std::abs(sum) / 2, "panel");
}

TEST(Lights, APictureGivesTheIrradianceOfItsPixels) {
    PictureLight picture{.file = "", .width = 32, .height = 16, .rgb = {}, .turn = 0.4};
    for (std::size_t k = 0; k < 32 * 16; ++k) {
        const float value = k == 77 ? 500.F : static_cast<float>(k % 7);
        picture.rgb.insert(picture.rgb.end(), {value, value, value});
    }
    // Pixels by midpoints: rings of equal angle, not of equal area as in both samplers.
    const Frame frame({0.7, 1.1, 0.2});
    const int rings = 16 * 24, azimuths = 32 * 24;
    double expected = 0, total = 0;
    for (int r = 0; r < rings; ++r) {
        const double theta = pi * (r + 0.5) / rings;
        for (int j = 0; j < azimuths; ++j) {
            const double column = (j + 0.5) * 32 / azimuths;
            const Direction world = directionFromAngles(theta, pi - 2 * pi * column / 32 + 0.4);
            const auto k = static_cast<std::size_t>(r / 24) * 32 + static_cast<std::size_t>(j / 24);
            const double flux =
                picture.rgb[3 * k] * std::sin(theta) * (pi / rings) * (2 * pi / azimuths);
            expected += flux * std::max(0.0, dot(world, frame.normal));
            total += flux;
            ASSERT_EQ(radianceOf(picture, world)[0], picture.rgb[3 * k]);
        }
    }
    const Light one[] = {picture};
    EXPECT_NEAR(irradiance(sampleLights(one, frame, 4)), expected, 3e-3 * expected);
    EXPECT_NEAR(irradiance(latticeSamples(one, frame, 300000)), expected, 1e-2 * expected);
    double flux = 0;
    for (const PictureSample& part : pictureSamples(picture, 1e-3)) flux += part.flux[0];
    EXPECT_NEAR(flux, total, 1e-4 * total);
}

TEST(Lights, APictureComesFromAnExrFileAndNowhereElse) {
    const std::string path = std::filesystem::temp_directory_path() /
                             ("hshfit-picture-" + std::to_string(getpid()) + ".exr");
    const auto write = [&](std::size_t width, float third) {
        ExrPicture picture{.width = width, .height = 2, .channels = {"B", "G", "R"}};
        picture.values.assign(3 * 2 * width, 1);
        picture.at(0, 1, 2) = third;
        AtomicFile file(path);
        writeExrPicture(picture, ExrPixels::single, file);
        file.commit();
    };
    write(4, 5);
    const PictureLight light = readPictureLight(path, 2);
    // Row 0, column 1 lies above the horizon a little to the left of +x, towards +y.
    const Direction d = directionFromAngles(radians(45), radians(45));
    EXPECT_EQ(radianceOf(light, d), (Rgb{10, 2, 2}));
    EXPECT_EQ(radianceOf(light, directionFromAngles(radians(45), radians(-45))), (Rgb{2, 2, 2}));
    write(4, -1);
    EXPECT_THROW(readPictureLight(path, 1), InputError);
    write(6, 1);
    EXPECT_THROW(readPictureLight(path, 1), InputError);
    std::ofstream(path) << "no picture";
    EXPECT_THROW(readPictureLight(path, 1), InputError);
    std::filesystem::remove(path);
}

TEST(Lights, FramesAreRightHandedAndCarryTheTangent) {
    for (const Orientation& o :
         {Orientation{}, Orientation{0, 1, 0.5}, Orientation{1, 2, 0}, Orientation{pi, 0.3, 1}}) {
        const Frame frame(o);
        const Direction z = cross(frame.tangent, frame.bitangent);
        EXPECT_NEAR(dot(z, frame.normal), 1, 1e-14);
        EXPECT_NEAR(dot(frame.tangent, frame.normal), 0, 1e-14);
        const Direction d = directionFromAngles(0.6, 2.5);
        EXPECT_NEAR(dot(frame.toWorld(frame.toLocal(d)), d), 1, 1e-14);
    }
    // Small tilts hardly move the tangent, wherever they lean.
    for (double phi : {0.0, 1.0, 4.0}) {
        EXPECT_NEAR(Frame({1e-6, phi, 0.25}).tangent.x, std::cos(0.25), 1e-5);
        EXPECT_NEAR(Frame({1e-6, phi, 0.25}).tangent.y, std::sin(0.25), 1e-5);
    }
}

TEST(Lights, AUniformSkyHasTwoBands) {
    const Light sky[] = {SkyLight{SkyLight::Model::uniform, grey(1), {}}};
    const LightSamples samples = sampleLights(sky, Frame({}), 4);
    const std::vector<double> power =
        BasisLight(*bases::make("hsh", 12), Quantity::brdf, samples).bandPower();
    // cos(theta) is half a constant and half the Legendre polynomial of 2 cos(theta) - 1.
    EXPECT_NEAR(power[0], 3 * 2 * pi / 4, 1e-9);
    EXPECT_NEAR(power[1], 3 * 2 * pi / 12, 1e-9);
    EXPECT_LT(std::accumulate(power.begin() + 2, power.end(), 0.0), 1e-20);
}

TEST(Views, WeightsAreTheSolidAngleAndErrorsThoseOfTheirFormulas) {
    const ViewRange range{.thetaMin = 0.2, .thetaMax = 1.3, .phiMin = 0.5, .phiMax = 2.5};
    const Views views = viewsOf(range, 5, 0.3);
    EXPECT_NEAR(std::accumulate(views.weights.begin(), views.weights.end(), 0.0),
                std::cos(0.2) - std::cos(1.3), 1e-12);
    for (const Direction& d : views.directions) {
        EXPECT_GT(polarAngle(d), 0.2);
        EXPECT_LT(polarAngle(d), 1.3);
        EXPECT_GE(azimuth(d), 0.5);
        EXPECT_LE(azimuth(d), 2.5);
    }
    std::vector<Radiance> truth(2, Radiance(views.size(), Rgb{1, 2, 3})), other = truth;
    for (Radiance& each : other) {
        for (Rgb& rgb : each) rgb = {1.1, 2.2, 3.3};
    }
    EXPECT_NEAR(errorOf({Budget::Metric::relativeL2, 0}, views, truth, other), 0.1, 1e-12);
    // e is a hundredth of the mean, 0.02.
    const double expected =
        (std::log(1.12 / 1.02) + std::log(2.22 / 2.02) + std::log(3.32 / 3.02)) / 3;
    EXPECT_NEAR(errorOf({Budget::Metric::log, 0}, views, truth, other), expected, 1e-12);
    for (double each : errorsByElevation({}, views, truth, other)) EXPECT_NEAR(each, 0.1, 1e-12);
    other[1][3][1] = std::nan("");
    EXPECT_TRUE(std::isinf(errorOf({}, views, truth, other)));
}

Scene smallScene(const std::string& brdf, const Light& light, double error) {
    Scene scene{.file = "scene", .materials = {}, .lights = {light}, .views = {}, .limits = {}};
    scene.views.thetaMax = radians(75);
    scene.materials.push_back({.name = "m", .brdf = brdf, .budget = {.error = error}});
    return scene;
}

/// The sum over light samples is linear: by coefficients and by values it is the same.
TEST(Radiance, ByCoefficientsIsRadianceByValues) {
    const Light lights[] = {DiscLight{directionFromAngles(0.5, 2), 0.2, {1, 2, 3}},
                            SkyLight{SkyLight::Model::overcast, {0.1, 0.3, 0.2}, grey(0.1)}};
    const LightSamples light = sampleLights(lights, Frame({0.6, 1, 0.4}), 0);
    const Views views = viewsOf({}, 15, 0.2);
    const auto forms = {
        Form{.basis = "hsh", .order = 5, .outgoing = "6", .halfway = {}, .split = {}},
        Form{.basis = "zernike",
             .order = 4,
             .quantity = Quantity::brdfCosine,
             .outgoing = "8x8",
             .halfway = {},
             .split = {}},
        Form{.kind = Representation::Kind::basis,
             .basis = "makhotkin",
             .order = 5,
             .outgoing = {},
             .halfway = {},
             .reciprocal = true,
             .split = {}},
        Form{.basis = "hsh", .order = 6, .outgoing = "8", .halfway = {}, .split = {}, .rank = 3}};
    const auto brdf = open("phong:exponent=6,kd=0.2/0.3/0.1,ks=0.4");
    for (const Form& form : forms) {
        const Representation kept = represent(*brdf, form, open, {.tolerance = 1e-4});
        const auto basis = bases::make(form.basis, 7);
        const Radiance fast = linearRadiance(kept, BasisLight(*basis, form.quantity, light), views);
        const Radiance slow = outgoingRadiance(*reconstruct(kept, open), light, views);
        for (std::size_t v = 0; v < views.size(); ++v) {
            for (std::size_t c = 0; c < 3; ++c) {
                ASSERT_NEAR(fast[v][c], slow[v][c], 1e-10) << optionsOf(form);
            }
        }
    }
}

TEST(Ladder, RisesByTheBytesThatFormsReallyTake) {
    for (const char* spec : {"phong:exponent=6", "ward:ax=0.4,ay=0.7,ks=0.2/0.3/0.4"}) {
        const auto brdf = open(spec);
        const LadderSource source{.brdf = brdf.get()};
        const LadderOptions options{
            .bases = {"hsh", "zernike"}, .maxOrder = 6, .maxBytes = 4000, .views = {}};
        const std::vector<Rung> rungs = ladder(std::span(&source, 1), options);
        ASSERT_GT(rungs.size(), 100U);
        for (std::size_t i = 1; i < rungs.size(); ++i) {
            EXPECT_LE(rungs[i - 1].bytes, rungs[i].bytes);
        }
        tradeoff::KeptProjections kept(*brdf, {.projection = {.tolerance = 1e-2},
                                               .bases = options.bases,
                                               .maxOrder = options.maxOrder});
        std::size_t looked = 0;
        for (std::size_t i = 0; i < rungs.size(); i += rungs.size() / 40 + 1) {
            if (rungs[i].form.outgoing.size() > 3) continue;  // large maps take long
            // Factors of a matrix of lower rank than asked for take less.
            const std::size_t bytes = represent(kept, rungs[i].form).bytes();
            ++looked;
            EXPECT_LE(bytes, rungs[i].bytes) << optionsOf(rungs[i].form);
            if (rungs[i].form.rank == 0) {
                EXPECT_EQ(bytes, rungs[i].bytes) << optionsOf(rungs[i].form);
            }
        }
        EXPECT_GT(looked, 15U);
    }
}

TEST(Plan, OneColourOfLightNeedsOneChannel) {
    const DiscLight red{directionFromAngles(0.4, 0), 0.3, {1, 0, 0}};
    const Plan plan = planScene(smallScene("lambert:kd=0.6/0.2/0.1", red, 0.01), open);
    ASSERT_TRUE(plan.materials[0].accepted);
    const Accepted& accepted = *plan.materials[0].accepted;
    EXPECT_EQ(accepted.choice.spec, "grey=1/0/0:lambert:kd=0.6/0.2/0.1");
    EXPECT_EQ(accepted.representation.head.channels.count(), 1U);
    EXPECT_LE(accepted.choice.bytes, 12U);
    EXPECT_LE(accepted.verified, 0.01);
    // White light on the same: three channels.
    const DiscLight white{directionFromAngles(0.4, 0), 0.3, grey(1)};
    const Plan other = planScene(smallScene("lambert:kd=0.6/0.2/0.1", white, 0.01), open);
    ASSERT_TRUE(other.materials[0].accepted);
    EXPECT_EQ(other.materials[0].accepted->representation.head.channels.count(), 3U);
}

TEST(Plan, ErrorsOfAMaterialNameTheSceneAndTheMaterial) {
    Scene scene = smallScene("lambert:kd=x", SkyLight{}, 0.01);
    scene.file = "some-scene.json";
    try {
        planScene(scene, open);
        FAIL() << "kd=x was taken";
    } catch (const Error& error) {
        const std::string named = "some-scene.json: material '" + scene.materials[0].name + "': ";
        EXPECT_TRUE(std::string(error.what()).starts_with(named)) << error.what();
    }
}

TEST(Plan, IsTheSameTwiceAndGrowsAsTheBudgetShrinks) {
    const DiscLight lamp{directionFromAngles(0.6, 1), 0.2, grey(1)};
    std::size_t last = 0;
    for (double error : {0.2, 0.05}) {
        const Scene scene = smallScene("phong:exponent=12,ks=0.3,kd=0.2", lamp, error);
        const Plan plan = planScene(scene, open);
        ASSERT_TRUE(plan.materials[0].accepted) << plan.materials[0].refused;
        if (last == 0) {
            EXPECT_EQ(planJson(plan), planJson(planScene(scene, open)));
        }
        const Accepted& accepted = *plan.materials[0].accepted;
        EXPECT_LE(accepted.verified, error);
        EXPECT_LE(accepted.choice.error, error);
        EXPECT_GE(accepted.choice.bytes, last);
        last = accepted.choice.bytes;
        for (const Choice& each : plan.materials[0].cheaper) {
            EXPECT_LT(each.bytes, last);
            EXPECT_GT(each.error, error);
        }
    }
}

/// A wide lamp is content with a form whose highlights under points are wrong.
TEST(Plan, PicturesBoundTheFormToo) {
    const SkyLight sky{SkyLight::Model::overcast, grey(1), grey(0.1)};
    Scene scene = smallScene("lambert:kd=0.3+ggx:alpha=0.3,F0=0.2", sky, 0.02);
    const Plan free = planScene(scene, open);
    ASSERT_TRUE(free.materials[0].accepted);
    EXPECT_FALSE(free.materials[0].accepted->choice.flip);
    constexpr double most = 0.05;
    EXPECT_GT(free.materials[0].accepted->picture.flip.mean, most);
    scene.materials[0].budget.flip = most;
    const Plan plan = planScene(scene, open);
    ASSERT_TRUE(plan.materials[0].accepted) << plan.materials[0].refused;
    const Accepted& accepted = *plan.materials[0].accepted;
    const auto source = open(scene.materials[0].brdf);
    const PictureError seen = pictureError(*source, *reconstruct(accepted.representation, open));
    EXPECT_LE(seen.flip.mean, most);
    EXPECT_EQ(seen.flip.mean, accepted.picture.flip.mean);
    EXPECT_LE(accepted.verified, 0.02);
    EXPECT_GT(accepted.choice.bytes, free.materials[0].accepted->choice.bytes);
    ASSERT_FALSE(plan.materials[0].cheaper.empty());
    for (const Choice& each : plan.materials[0].cheaper) {
        ASSERT_TRUE(each.flip);
        EXPECT_TRUE(each.flip->mean > most || each.error > 0.02);
    }
    for (const PlannedFormula& each : plan.materials[0].formulas) {
        EXPECT_TRUE(each.row.picture.flip.mean <= most || !each.within) << each.row.name;
    }
    // No form of a few bytes looks right: the reason is the pictures.
    scene.limits.bytes = free.materials[0].accepted->choice.bytes;
    const Plan none = planScene(scene, open);
    EXPECT_FALSE(none.materials[0].accepted);
    EXPECT_NE(none.materials[0].refused.find("FLIP"), std::string::npos);
}

/// Without time to search, a form that keeps to the budget is there all the same.
TEST(Plan, TakesALargeFormWhereTheTimeIsOver) {
    const DiscLight lamp{directionFromAngles(0.6, 1), 0.2, grey(1)};
    Scene scene = smallScene("lambert:kd=0.3+ggx:alpha=0.3,F0=0.2", lamp, 0.05);
    const Plan plan = planScene(scene, open, {.seconds = 1e-3});
    const MaterialPlan& cut = plan.materials[0];
    ASSERT_TRUE(cut.accepted) << cut.refused;
    EXPECT_TRUE(cut.cut);
    EXPECT_LT(cut.tried, cut.rungs);
    EXPECT_LE(cut.accepted->verified, 0.05);
    EXPECT_NE(planText(plan).find("the time was over after"), std::string::npos);
    const Plan whole = planScene(scene, open);
    ASSERT_TRUE(whole.materials[0].accepted);
    EXPECT_FALSE(whole.materials[0].cut);
    EXPECT_LT(whole.materials[0].accepted->choice.bytes, cut.accepted->choice.bytes);
    // No form of so few bytes: said as it is.
    scene.limits.bytes = 8;
    const Plan none = planScene(scene, open, {.seconds = 1e-3});
    EXPECT_FALSE(none.materials[0].accepted);
    const std::string& reason = none.materials[0].refused;
    EXPECT_TRUE(reason.starts_with("the time was over after 0 of")) << reason;
}

TEST(Plan, TellsAFormWithinTheBudgetBeforeItSearches) {
    const DiscLight lamp{directionFromAngles(0.6, 1), 0.2, grey(1)};
    const Scene scene = smallScene("phong:exponent=12,ks=0.3,kd=0.2", lamp, 0.05);
    std::vector<Choice> told;
    const Plan plan = planScene(scene, open, {.found = [&](const Material&, const Choice& choice) {
                                    told.push_back(choice);
                                }});
    ASSERT_EQ(told.size(), 1U);
    EXPECT_LE(told[0].error, 0.05);
    ASSERT_TRUE(plan.materials[0].accepted);
    EXPECT_LE(plan.materials[0].accepted->choice.bytes, told[0].bytes);
    // By the other integration, of the form made anew.
    const auto source = open(told[0].spec);
    const auto again = reconstruct(represent(*source, told[0].form, open), open);
    const LatticeCheck check(scene, scene.materials[0], *source);
    EXPECT_NEAR(check.of(*again).error, told[0].error, 0.3 * told[0].error);
    EXPECT_EQ(check.of(*source).error, 0);
}

TEST(Plan, SmoothLightBoundsTheOrder) {
    const SkyLight sky{SkyLight::Model::uniform, grey(1), {}};
    const Plan plan = planScene(smallScene("phong:exponent=8,ks=0.3", sky, 0.02), open);
    bool said = false;
    for (const std::string& rule : plan.materials[0].rules) {
        said |= rule.find("smooth light: bands from 2 on") == 0;
    }
    EXPECT_TRUE(said);
    ASSERT_TRUE(plan.materials[0].accepted);
    EXPECT_LE(plan.materials[0].accepted->choice.form.order, 2);
}

TEST(Plan, AMirrorHasNoPlanAndAlternativesAreNamed) {
    // A wall sees the edge between sky and ground.
    const SkyLight sky{SkyLight::Model::overcast, grey(1), grey(0.1)};
    Scene scene = smallScene("ggx:alpha=0.0001", sky, 0.05);
    scene.materials[0].orientations = {{pi / 2, 0, 0}};
    const Plan plan = planScene(scene, open);
    EXPECT_FALSE(plan.materials[0].accepted);
    EXPECT_NE(plan.materials[0].refused.find("°"), std::string::npos);
    EXPECT_EQ(plan.materials[0].instead.at(0), "the model itself: ggx:alpha=0.0001");
}

TEST(Grey, IsTheWeightedMeanAndHasASpecification) {
    const auto colour = open("lambert:kd=0.6/0.3/0.1");
    for (const auto& [spec, mean] : {std::pair("grey:lambert:kd=0.6/0.3/0.1", 1.0 / 3),
                                     std::pair("grey=3/0/1:lambert:kd=0.6/0.3/0.1", 0.475)}) {
        const auto one = open(spec);
        EXPECT_EQ(one->name(), spec);
        EXPECT_EQ(one->channels().count(), 1U);
        EXPECT_NEAR(evaluate(*one, {0, 0, 1}, {0, 0, 1})[0], mean / pi, 1e-12);
    }
    EXPECT_THROW(open("grey=1/0:lambert:kd=0.6/0.3/0.1"), UsageError);
    EXPECT_THROW(open("grey=0/0/0:lambert:kd=0.6/0.3/0.1"), UsageError);
    EXPECT_THROW(open("grey=a:lambert"), UsageError);
    EXPECT_THROW(open("grey="), UsageError);
}

/// A replacement in a scene file that makes it wrong, and the name that the error has to contain.
struct BadScene {
    const char *from, *to, *named;
};

TEST(SceneFile, NamesTheFieldThatIsWrong) {
    const std::string good = R"({"format": "hshfit-scene", "version": 1,
        "materials": [{"name": "a", "brdf": "lambert"}],
        "lights": [{"kind": "disc", "theta": 30, "angular_diameter": 5, "irradiance": 1}],
        "views": {"theta": [0, 60]}, "budget": {"error": 0.05}})";
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() /
        ("hshfit-scene-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) + "-" +
         std::to_string(getpid()) + ".json");
    const auto read = [&](const std::string& text) {
        std::ofstream(path) << text;
        return scene::readScene(path.string(), scene::Purpose::plan);
    };
    const Scene scene = read(good);
    EXPECT_NEAR(std::get<DiscLight>(scene.lights[0]).radiance[1],
                1 / (pi * std::pow(std::sin(radians(2.5)), 2)), 1e-9);
    EXPECT_NEAR(scene.views.thetaMax, radians(60), 1e-15);
    for (const BadScene& bad : {
             BadScene{"\"brdf\": \"lambert\"", "\"brdf\": \"lambert\", \"colour\": 1",
                      "'materials[0].colour' is not known; valid: name, brdf, lobe"},
             BadScene{"\"views\"", "\"view\"", "'view' is not known; valid: format"},
             BadScene{"\"disc\"", "\"spot\"", "'lights[0].kind' is 'spot'; valid: disc, panel"},
             BadScene{"\"irradiance\": 1", "\"irradiance\": -1", "'lights[0].irradiance'"},
             BadScene{"\"irradiance\": 1", "\"irradiance\": [1, 2]", "it has to have 3"},
             BadScene{"\"irradiance\": 1", "\"irradiance\": 1, \"radiance\": 1", "one of the two"},
             BadScene{"[0, 60]", "[60, 0]", "'views.theta' is [60, 0]"},
             BadScene{"[0, 60]", "[0, 95]", "'views.theta'"},
             BadScene{"\"error\": 0.05", "\"error\": 0", "'budget.error' is 0"},
             BadScene{"\"error\": 0.05", "\"metric\": \"psnr\", \"error\": 1",
                      "'budget.metric' is 'psnr'; valid: relative_l2, log"},
             BadScene{"\"error\": 0.05", "\"error\": 1, \"flip\": 2", "'budget.flip' is 2"},
             BadScene{"\"name\": \"a\"", "\"name\": \"../a\"", "'materials[0].name'"},
             BadScene{"\"name\": \"a\"", "\"name\": \"a\", \"orientations\": []",
                      "'materials[0].orientations' has to hold at least one"},
             BadScene{"\"version\": 1", "\"version\": 2", "'version' is 2"},
             BadScene{"}]", "", "not valid JSON"},
         }) {
        std::string text = good;
        text.replace(text.find(bad.from), std::string(bad.from).size(), bad.to);
        try {
            read(text);
            ADD_FAILURE() << bad.to;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(bad.named), std::string::npos) << error.what();
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    }
    std::filesystem::remove(path);
}

}  // namespace
}  // namespace hshfit::plan
