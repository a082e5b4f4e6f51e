#include <hshfit/pictures/internal/picture_lights.h>

#include <hshfit/brdf/vectors.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::inline pictures {
namespace {

/// The direction at `offset`, in radians across and up, from `centre`.
Direction beside(const Direction& centre, double across, double up) {
    const Direction horizontal = normalised(cross({0, 1, 0}, centre));
    const Direction vertical = cross(centre, horizontal);
    return normalised(centre + std::tan(across) * horizontal + std::tan(up) * vertical);
}

/// A disc as its middle and points on two circles, of equal strengths that add up to 1.
SphereRig disc(const Direction& centre, double radius) {
    SphereRig rig{.lights = {}, .dome = 0};
    constexpr int circles = 2, points = 1 + 6 + 12;
    for (int circle = 0; circle <= circles; ++circle) {
        const int count = circle == 0 ? 1 : 6 * circle;
        // Each circle stands for a ring as wide as the others, so that none lies on the rim.
        const double from = radius * circle / (circles + 0.5);
        for (int k = 0; k < count; ++k) {
            const double turn = 2 * pi * k / count;
            rig.lights.push_back(
                {beside(centre, from * std::cos(turn), from * std::sin(turn)), 1.0 / points});
        }
    }
    return rig;
}

/// Points over a panel, of strengths that add up to `strength`.
void addPanel(const Direction& centre, double width, double height, int columns, int rows,
              double strength, SphereRig& rig) {
    for (int column = 0; column < columns; ++column)
        for (int row = 0; row < rows; ++row)
            rig.lights.push_back({beside(centre, width * ((column + 0.5) / columns - 0.5),
                                         height * ((row + 0.5) / rows - 0.5)),
                                  strength / (columns * rows)});
}

SphereRig room() {
    SphereRig rig{.lights = {}, .dome = 0.2};
    const Direction window = directionFromAngles(radians(55), radians(160));
    addPanel(window, radians(40), radians(30), 5, 4, 1, rig);
    addPanel(directionFromAngles(radians(75), radians(80)), radians(10), radians(10), 2, 2, 0.3,
             rig);
    addPanel(directionFromAngles(radians(80), radians(-10)), radians(60), radians(60), 3, 3, 0.2,
             rig);
    return rig;
}

std::vector<PictureLight> madeLights() {
    std::vector<PictureLight> lights;
    for (const int theta : {4, 30, 60, 80}) {
        const Direction towards = directionFromAngles(radians(theta), radians(135));
        lights.push_back({fmt::format("lamp at {} degrees", theta), {{{towards, 1}}, 0}});
        lights.push_back({fmt::format("disc at {} degrees", theta), disc(towards, radians(10))});
    }
    lights.push_back({"even sky", {{}, 1}});
    lights.push_back({"room", room()});
    return lights;
}

}  // namespace

const std::vector<PictureLight>& pictureLights() {
    static const std::vector<PictureLight> lights = madeLights();
    return lights;
}

}  // namespace hshfit::inline pictures
