#include <brdfs/measured/scattered/chart.h>

#include <hshfit/brdf/vectors.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

constexpr double crossLobe = 4;
// One direction that moves by a small angle moves p by angle / sqrt(2), and with it both s and d.
const double toRadians = std::sqrt(2.0 / (1 + crossLobe * crossLobe));

struct Plane {
    double x, y;
};

/// sqrt(2) sin(theta/2) (cos phi, sin phi) = (x, y) / sqrt(1 + z).
Plane disc(const Direction& d) {
    const double scale = 1 / std::sqrt(1 + std::max(d.z, 0.0));
    return {d.x * scale, d.y * scale};
}

double length(const Direction& d) {
    return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
}

Direction unit(const Direction& d) {
    const double size = length(d);
    return size > 1e-12 ? Direction{d.x / size, d.y / size, d.z / size} : Direction{};
}

Point pairPoint(bool isotropic, const Direction& wi, const Direction& wo) {
    const Plane i = disc(wi), o = disc(wo);
    const Plane s{i.x + o.x, i.y + o.y}, d{i.x - o.x, i.y - o.y};
    const double k = toRadians;
    if (!isotropic) return {crossLobe * k * s.x, crossLobe * k * s.y, k * d.x, k * d.y};
    const double ss = s.x * s.x + s.y * s.y, dd = d.x * d.x + d.y * d.y;
    const double radius = std::sqrt(ss + dd);
    if (radius < 1e-150) return {};
    const double y = s.x * d.x + s.y * d.y, z = s.x * d.y - s.y * d.x;
    return {k * (ss - dd) / radius, k * crossLobe * y / radius, k * crossLobe * z / radius, 0};
}

}  // namespace

int dimensions(Chart chart) {
    switch (chart) {
        case Chart::anisotropic:
            return 4;
        case Chart::isotropic:
        case Chart::halfVectorDistance:
            return 3;
        case Chart::halfDifference:
        case Chart::halfVector:
        case Chart::backVector:
        case Chart::stark:
        case Chart::neumann:
            return 2;
        case Chart::halfAngle:
        case Chart::betweenDirections:
        case Chart::fromMirror:
        case Chart::backAngle:
            break;
    }
    return 1;
}

std::string_view chartName(Chart chart) {
    switch (chart) {
        case Chart::isotropic:
        case Chart::anisotropic:
            return "pairs of directions";
        case Chart::halfAngle:
            return "theta_h";
        case Chart::halfDifference:
            return "theta_h, theta_d";
        case Chart::halfVector:
            return "half vector";
        case Chart::halfVectorDistance:
            return "half vector, theta_d";
        case Chart::betweenDirections:
            return "angle between the directions";
        case Chart::fromMirror:
            return "angle from the mirror direction";
        case Chart::backAngle:
            return "angle of the back vector";
        case Chart::backVector:
            return "back vector";
        case Chart::stark:
            return "|H_p|, |B|";
        case Chart::neumann:
            break;
    }
    return "|H_p|, |B_p|";
}

Point chartPoint(Chart chart, const Direction& wi, const Direction& wo) {
    const Direction half = unit(wi + wo);
    const Direction back = unit(wo + mirrored(wi));
    const Plane h = disc(half), k = disc(back);
    const auto flat = [](double x, double y) { return std::sqrt(x * x + y * y) / 2; };
    switch (chart) {
        case Chart::isotropic:
        case Chart::anisotropic:
            return pairPoint(chart == Chart::isotropic, wi, wo);
        case Chart::halfAngle:
            return {polarAngle(half)};
        case Chart::halfDifference:
            return {polarAngle(half), angleBetween(wi, wo) / 2};
        // sqrt(2) makes the disc true to angles at the pole.
        case Chart::halfVector:
            return {std::sqrt(2.0) * h.x, std::sqrt(2.0) * h.y};
        case Chart::halfVectorDistance:
            return {std::sqrt(2.0) * h.x, std::sqrt(2.0) * h.y, angleBetween(wi, wo) / 2};
        case Chart::betweenDirections:
            return {angleBetween(wi, wo)};
        case Chart::fromMirror:
            return {angleBetween(wi, mirrored(wo))};
        case Chart::backAngle:
            return {polarAngle(back)};
        case Chart::backVector:
            return {std::sqrt(2.0) * k.x, std::sqrt(2.0) * k.y};
        case Chart::stark:
            return {flat(wi.x + wo.x, wi.y + wo.y), std::sin(angleBetween(wi, wo) / 2)};
        case Chart::neumann:
            break;
    }
    return {flat(wi.x + wo.x, wi.y + wo.y), flat(wi.x - wo.x, wi.y - wo.y)};
}

std::vector<Point> images(Chart chart, const Folding& folding) {
    std::vector<Point> signs{{1, 1, 1, 1}};
    const auto add = [&](const Point& generator) {
        const std::size_t known = signs.size();
        for (std::size_t k = 0; k < known; ++k) {
            Point product = signs[k];
            for (std::size_t c = 0; c < product.size(); ++c) product[c] *= generator[c];
            if (std::ranges::find(signs, product) == signs.end()) signs.push_back(product);
        }
    };
    if (chart == Chart::isotropic) {
        if (folding.exchange) add({1, -1, -1, 1});
        if (folding.mirror) add({1, 1, -1, 1});
    } else if (chart == Chart::anisotropic) {
        if (folding.exchange) add({1, 1, -1, -1});
        if (folding.mirror) {
            add({1, -1, 1, -1});
            add({-1, 1, -1, 1});
        }
    }
    return signs;
}

Point folded(const Point& point, const std::vector<Point>& images) {
    Point best = point;
    for (const Point& signs : images) {
        Point image;
        for (std::size_t c = 0; c < image.size(); ++c) image[c] = point[c] * signs[c];
        best = std::max(best, image);
    }
    return best;
}

double distance(const Point& a, const Point& b) {
    double sum = 0;
    for (std::size_t c = 0; c < a.size(); ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
    return std::sqrt(sum);
}

}  // namespace hshfit::brdfs
