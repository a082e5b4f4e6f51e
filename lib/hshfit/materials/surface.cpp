#include <hshfit/materials/surface.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

namespace hshfit::inline materials {
namespace {

using Vector = std::array<float, 3>;

/// The direction of growing longitude: +y x n, normalised.
std::array<float, 4> tangentAt(const Vector& normal) {
    const double x = normal[2], z = -normal[0], length = std::hypot(x, z);
    if (length < 1e-6) return {1, 0, 0, 1};
    return {static_cast<float>(x / length), 0, static_cast<float>(z / length), 1};
}

}  // namespace

Surface sphereSurface(int rings) {
    if (rings < 2 || rings > 1024)
        throw UsageError(fmt::format("a sphere of {} rings; 2 to 1024 are possible", rings));
    Surface surface;
    const int around = 2 * rings;
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j <= around; ++j) {
            const double theta = pi * i / rings, phi = 2 * pi * j / around;
            const double sine = i == rings ? 0 : std::sin(theta);
            const Vector normal{static_cast<float>(-sine * std::sin(phi)),
                                static_cast<float>(std::cos(theta)),
                                static_cast<float>(-sine * std::cos(phi))};
            surface.positions.push_back(normal);
            surface.normals.push_back(normal);
            surface.tangents.push_back(
                {static_cast<float>(-std::cos(phi)), 0, static_cast<float>(std::sin(phi)), 1});
            surface.coordinates.push_back({static_cast<float>(j) / static_cast<float>(around),
                                           static_cast<float>(i) / static_cast<float>(rings)});
        }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (around + 1) + j); };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            if (i > 0)
                surface.indices.insert(surface.indices.end(),
                                       {at(i, j), at(i + 1, j), at(i, j + 1)});
            if (i + 1 < rings)
                surface.indices.insert(surface.indices.end(),
                                       {at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
        }
    }
    return surface;
}

Surface surfaceOf(const Mesh& mesh) {
    Surface surface;
    std::map<std::pair<std::uint32_t, Vector>, std::uint32_t> known;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = mesh.triangles[t][corner];
            const Vector& normal = mesh.normals[3 * t + corner];
            const auto next = static_cast<std::uint32_t>(surface.positions.size());
            const auto [place, added] = known.try_emplace({vertex, normal}, next);
            if (added) {
                surface.positions.push_back(mesh.positions[vertex]);
                surface.normals.push_back(normal);
                surface.tangents.push_back(tangentAt(normal));
            }
            surface.indices.push_back(place->second);
        }
    }
    return surface;
}

}  // namespace hshfit::inline materials
