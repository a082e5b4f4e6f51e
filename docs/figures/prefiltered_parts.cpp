// prefiltered_parts LOBES LIGHT SPEC…: parts of the error of lookups in an environment that
// three.js has prefiltered (docs/explanation/prefiltered.md). Relative L2 and FLIP of a sphere of
// 48 x 48 pixels against direct integration: of the table as it is exported; of one with 256 rows;
// of one with 256 rows and a cube of twice as many texels along an edge, whose rest is the fit's;
// of a table for seven levels on a cube that has them (three-512), and of the one for six on that.
// Last the relative L2 between references of tolerances 5e-3 and 1e-3.

#include <hshfit/light/catalog.h>
#include <hshfit/lighting/lit_surface.h>
#include <hshfit/lighting/prefiltered_lobes.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/rendering/lit_picture.h>

#include <jobs/source/source.h>

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

namespace {

using namespace hshfit;

constexpr int size = 48;

/// A light in a view, with the cubes that are looked up.
class Scene {
public:
    explicit Scene(const std::string& light)
        : lights_(parseLights(light).lights),
          view_(radians(75), 0),
          points_(spherePoints(view_, size, 1)),
          cube_(lighting::prefiltered(engine(), lights_)),
          fine_(lighting::prefiltered(engine(), lights_, 16)),
          seven_(lighting::prefiltered(sevenLevels(), lights_)) {}

    static const lighting::Prefilter& engine() { return lighting::prefilterNamed("three"); }
    static const lighting::Prefilter& sevenLevels() {
        return lighting::prefilterNamed("three-512");
    }

    SpherePicture integrated(const Brdf& brdf, double tolerance) const {
        const DirectIntegral direct(lights_, tolerance);
        return renderByIntegration(brdf, points_, view_, direct, {.tolerance = tolerance}).picture;
    }
    SpherePicture asExported(const lighting::PrefilteredTable& table) const {
        return lookedUp(table, cube_);
    }
    SpherePicture onFineCube(const lighting::PrefilteredTable& table) const {
        return lookedUp(table, fine_);
    }
    SpherePicture onSevenLevels(lighting::PrefilteredTable table) const {
        table.engine = &sevenLevels();
        return lookedUp(table, seven_);
    }

private:
    SpherePicture lookedUp(const lighting::PrefilteredTable& table,
                           const lighting::EnvironmentCube& cube) const {
        return lighting::render(
                   [&](const Direction& normal, const Direction& viewer) {
                       return radiance(table, cube, normal, viewer, frameAt(normal).tangent);
                   },
                   points_, view_)
            .picture;
    }

    std::vector<Light> lights_;
    View view_;
    SurfacePoints points_;
    lighting::EnvironmentCube cube_, fine_, seven_;
};

void printRow(const std::string& spec, std::size_t lobes, const Scene& scene) {
    const auto brdf = jobs::openBrdf(spec, true);
    const SpherePicture truth = scene.integrated(*brdf, 5e-3);
    std::string row = fmt::format("| {} |", spec);
    const auto add = [&](const SpherePicture& picture) {
        row += fmt::format(" {:.3f}, {:.3f} |", differenceOf(truth, picture).relativeL2,
                           sphereFlip(truth, picture));
    };
    const auto fitted = [&](std::size_t rows, const lighting::Prefilter& engine = Scene::engine()) {
        return lighting::fitPrefiltered(*brdf, engine, lobes, {.count = rows});
    };
    constexpr std::size_t rows = lighting::ElevationRows{}.count;
    const lighting::PrefilteredTable exported = fitted(rows), dense = fitted(256);
    add(scene.asExported(exported));
    add(scene.asExported(dense));
    add(scene.onFineCube(dense));
    add(scene.onSevenLevels(fitted(rows, Scene::sevenLevels())));
    add(scene.onSevenLevels(exported));
    row += fmt::format(" {:.4f} |", differenceOf(scene.integrated(*brdf, 1e-3), truth).relativeL2);
    std::puts(row.c_str());
    std::fflush(stdout);
}

}  // namespace

int main(int count, char** words) {
    if (count < 4) return 2;
    const Scene scene(words[2]);
    for (int k = 3; k < count; ++k) printRow(words[k], std::strtoul(words[1], nullptr, 10), scene);
}
