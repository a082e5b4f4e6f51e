#include <hshfit/light/placement.h>

namespace hshfit::inline light {
namespace {

struct Turn {
    double angle;
    void operator()(DiscLight& light) const { turn(light.towards); }
    void operator()(PanelLight& light) const {
        // At the poles azimuth is 0 (directions.h), so that the panel turns about its centre.
        if (light.towards.x == 0 && light.towards.y == 0) {
            light.turn += light.towards.z > 0 ? -angle : angle;
        } else {
            turn(light.towards);
        }
    }
    void operator()(SkyLight& light) const { turn(light.sun); }
    void operator()(PictureLight& light) const { light.turn += angle; }
    void operator()(DirectionalLight& light) const { turn(light.towards); }
    void operator()(CoefficientLight& light) const {
        for (Direction* axis : {&light.tangent, &light.bitangent, &light.normal}) turn(*axis);
    }

private:
    void turn(Direction& direction) const { direction = rotateAboutZ(direction, angle); }
};

struct Scale {
    double factor;
    void operator()(DiscLight& light) const { scale(light.radiance); }
    void operator()(PanelLight& light) const { scale(light.radiance); }
    void operator()(SkyLight& light) const {
        scale(light.zenith);
        scale(light.ground);
    }
    void operator()(PictureLight& light) const {
        for (float& value : light.rgb) value = static_cast<float>(value * factor);
        light.scale *= factor;
    }
    void operator()(DirectionalLight& light) const { scale(light.irradiance); }
    void operator()(CoefficientLight& light) const { light.scale *= factor; }

private:
    void scale(Rgb& rgb) const {
        for (double& value : rgb) value *= factor;
    }
};

}  // namespace

Light turned(Light light, double angle) {
    std::visit(Turn{angle}, light);
    return light;
}

Light scaled(Light light, double factor) {
    std::visit(Scale{factor}, light);
    return light;
}

PictureLight rotated(PictureLight light, const Rotation& rotation) {
    light.tilt = rotation * Rotation::aboutAxis({0, 0, 1}, light.turn) * light.tilt;
    light.turn = 0;
    return light;
}

CoefficientLight rotated(CoefficientLight light, const Rotation& rotation) {
    for (Direction* axis : {&light.tangent, &light.bitangent, &light.normal})
        *axis = rotation(*axis);
    return light;
}

PictureLight mirrorImage(PictureLight light) {
    // With S the mirror: S R_z(turn) T S^mirrored = R_z(-turn) (S T S) S S^mirrored.
    std::array<double, 9> rows = light.tilt.matrix();
    for (const std::size_t k : {1U, 3U, 5U, 7U}) rows[k] = -rows[k];
    light.tilt = Rotation::fromMatrix(rows);
    light.turn = -light.turn;
    light.mirrored = !light.mirrored;
    return light;
}

CoefficientLight mirrorImage(CoefficientLight light) {
    for (Direction* axis : {&light.tangent, &light.bitangent, &light.normal}) axis->y = -axis->y;
    return light;
}

}  // namespace hshfit::inline light
