#pragma once

// Radiosity of the Cornell box with its blocks, and the same box for rays. Form factors of points
// to quadrilaterals are exact; the share of each that is visible is sampled by rays.

#include <hshfit/brdf/vectors.h>
#include <hshfit/meshes/mesh_file.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/rays/ray_scene.h>
#include <hshfit/transport/path_tracer.h>

#include <lib/transport/box_radiosity.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace hshfit::test {

/// A flat quadrilateral, or a triangle with a corner twice, whose front is on the side of `normal`.
struct Quad {
    std::array<Direction, 4> corners;
    Direction normal;
    std::size_t object = 0;

    Direction at(double a, double b) const {
        return (1 - a) * ((1 - b) * corners[0] + b * corners[3]) +
               a * ((1 - b) * corners[1] + b * corners[2]);
    }
    /// d area of the surface / (da db).
    double stretch(double a, double b) const {
        const Direction n =
            cross((1 - b) * (corners[1] - corners[0]) + b * (corners[2] - corners[3]),
                  (1 - a) * (corners[3] - corners[0]) + a * (corners[2] - corners[1]));
        return std::sqrt(dot(n, n));
    }
    double area() const {
        const Direction n = cross(corners[2] - corners[0], corners[3] - corners[1]);
        return std::sqrt(dot(n, n)) / 2;
    }
};

/// The box from a folder with its meshes. Reflectances are the published measurements in RGB; the
/// lamp has radiance 1.
class CornellBox {
public:
    static constexpr std::size_t objects = 8, lamp = 7;
    static constexpr const char* names[objects] = {"floor",   "ceiling",  "back",     "greenwall",
                                                   "redwall", "smallbox", "largebox", "luminaire"};

    explicit CornellBox(const std::string& folder) {
        for (std::size_t k = 0; k < objects; ++k) {
            meshes_.push_back(readMesh(fmt::format("{}/cbox_{}.obj", folder, names[k])).mesh);
            // Half a unit below the ceiling, in whose plane it is stored.
            if (k == lamp)
                for (MeshVector& p : meshes_[k].positions) p[1] -= 0.5F;
            addFaces(k);
        }
    }

    static Rgb reflectance(std::size_t object) {
        if (object == 3) return {0.105421, 0.37798, 0.076425};
        if (object == 4) return {0.570068, 0.0430135, 0.0443706};
        if (object == 5 || object == 6) return {0.45, 0.30, 0.90};
        if (object == lamp) return {0.936461, 0.740433, 0.705267};
        return {0.885809, 0.698859, 0.666422};
    }

    /// [bounce][object]: the mean radiance that leaves an object after that many reflections, with
    /// patches of a wall's n-th part.
    std::vector<std::array<Rgb, objects>> radianceByBounce(int n, int bounces) const {
        const std::vector<Quad> patches = patchesOf(n);
        const std::vector<double> factors = factorsOf(patches);
        std::vector<Rgb> radiance(patches.size());
        for (std::size_t i = 0; i < patches.size(); ++i)
            if (patches[i].object == lamp) radiance[i] = {1, 1, 1};
        std::vector<std::array<Rgb, objects>> result;
        for (int bounce = 0; bounce <= bounces; ++bounce) {
            result.push_back(means(patches, radiance));
            radiance = reflected(patches, factors, radiance);
        }
        return result;
    }

    SurfaceScene scene() const {
        std::vector<SurfaceMaterial> materials;
        std::vector<SurfaceObject> all;
        for (std::size_t k = 0; k < objects; ++k) {
            const Rgb r = reflectance(k);
            materials.push_back(materialOf(fmt::format("lambert:kd={}/{}/{}", r[0], r[1], r[2])));
            all.push_back({names[k], meshes_[k], k, k == lamp ? Rgb{1, 1, 1} : Rgb{}});
        }
        return {std::move(materials), std::move(all), {}};
    }

    /// The mean radiance that leaves an object after exactly `bounce` reflections, by paths from
    /// places all over it; the error follows from the scatter between places.
    PathEstimate traced(const SurfaceScene& scene, std::size_t object, int bounce,
                        int paths) const {
        std::vector<Quad> own;
        std::vector<double> upTo;
        for (const Quad& face : faces_) {
            if (face.object != object) continue;
            own.push_back(face);
            upTo.push_back((upTo.empty() ? 0 : upTo.back()) + face.area());
        }
        return meanOverPlaces(scene, bounce, paths, [&](int k) { return placeOf(own, upTo, k); });
    }

private:
    static std::size_t faceOf(const std::vector<double>& upTo, int k) {
        const double wanted = fractionOf(k, 0.8191725133961645) * upTo.back();
        std::size_t face = 0;
        while (face + 1 < upTo.size() && upTo[face] < wanted) ++face;
        return face;
    }
    /// Even over the faces, a little off them.
    static Place placeOf(const std::vector<Quad>& own, const std::vector<double>& upTo, int k) {
        const Quad& face = own[faceOf(upTo, k)];
        const auto& c = face.corners;
        const auto areaOf = [](const Direction& u, const Direction& v) {
            const Direction n = cross(u, v);
            return std::sqrt(dot(n, n));
        };
        const double first = areaOf(c[1] - c[0], c[2] - c[0]),
                     second = areaOf(c[2] - c[0], c[3] - c[0]);
        double u = fractionOf(k, 0.6710436067037893), share = first / (first + second);
        const bool inFirst = u < share;
        u = std::sqrt(inFirst ? u / share : (u - share) / (1 - share));
        const double v = fractionOf(k, 0.5497004779019703);
        const Direction &a = c[0], &b = inFirst ? c[1] : c[2], &d = inFirst ? c[2] : c[3];
        return {a + u * (1 - v) * (b - a) + u * v * (d - a) + 0.05 * face.normal, face.normal};
    }

    /// The outline of two triangles with a common edge.
    static std::array<Direction, 4> joined(const std::array<Direction, 3>& a,
                                           const std::array<Direction, 3>& b) {
        const auto same = [](const Direction& p, const Direction& q) {
            return p.x == q.x && p.y == q.y && p.z == q.z;
        };
        const auto in = [&](const Direction& p, const std::array<Direction, 3>& all) {
            return same(p, all[0]) || same(p, all[1]) || same(p, all[2]);
        };
        std::size_t own = 0, other = 0;
        while (in(a[own], b)) ++own;
        while (in(b[other], a)) ++other;
        return {a[own], a[(own + 1) % 3], b[other], a[(own + 2) % 3]};
    }

    /// Two triangles after one another are a face. Fronts: into the room, out of the blocks, down.
    void addFaces(std::size_t object) {
        const Mesh& mesh = meshes_[object];
        Direction middle{0, 0, 0};
        const auto corner = [&](std::size_t triangle, std::size_t k) {
            return directionOf(mesh.positions[mesh.triangles[triangle][k]]);
        };
        for (const MeshVector& p : mesh.positions)
            middle = middle + 1.0 / static_cast<double>(mesh.positions.size()) * directionOf(p);
        const bool block = object == 5 || object == 6;
        const auto add = [&](const std::array<Direction, 4>& corners) {
            Quad face{corners, {}, object};
            face.normal = normalised(cross(corners[1] - corners[0], corners[2] - corners[0]));
            const Direction centre = face.at(0.5, 0.5), room{278, 274, 280};
            if (dot(face.normal, block ? centre - middle : room - centre) < 0)
                face.normal = -face.normal;
            // The blocks stand on the floor.
            if (!block || face.normal.y > -0.9) faces_.push_back(face);
        };
        for (std::size_t t = 0; t + 1 < mesh.triangles.size(); t += 2) {
            const std::array<Direction, 3> a{corner(t, 0), corner(t, 1), corner(t, 2)},
                b{corner(t + 1, 0), corner(t + 1, 1), corner(t + 1, 2)};
            const Direction n = normalised(cross(a[1] - a[0], a[2] - a[0])),
                            m = normalised(cross(b[1] - b[0], b[2] - b[0]));
            if (dot(n, m) > 1 - 1e-9) {
                add(joined(a, b));
            } else {
                // The red wall is not flat.
                add({a[0], a[1], a[2], a[2]});
                add({b[0], b[1], b[2], b[2]});
            }
        }
    }

    std::vector<Quad> patchesOf(int n) const {
        std::vector<Quad> patches;
        for (const Quad& face : faces_) {
            const double side = std::sqrt(face.area());
            const int cells = std::max(face.object == lamp ? n : 2,
                                       static_cast<int>(std::lround(n * side / 556)));
            for (int i = 0; i < cells; ++i) {
                for (int j = 0; j < cells; ++j) {
                    const auto at = [&](int a, int b) {
                        return face.at(static_cast<double>(i + a) / cells,
                                       static_cast<double>(j + b) / cells);
                    };
                    patches.push_back(
                        {{at(0, 0), at(1, 0), at(1, 1), at(0, 1)}, face.normal, face.object});
                }
            }
        }
        return patches;
    }

    /// The share of a quadrilateral's quarters whose middles a point sees.
    static double visible(const RayScene& rays, const Direction& from, const Quad& to) {
        double share = 0;
        for (const double a : {0.25, 0.75}) {
            for (const double b : {0.25, 0.75}) {
                const Direction gap = to.at(a, b) - from;
                const double distance = std::sqrt(dot(gap, gap));
                const auto hit = rays.firstHit({from.x, from.y, from.z}, 1 / distance * gap);
                if (!hit || hit->distance > 0.999 * distance) share += 0.25;
            }
        }
        return share;
    }

    std::vector<double> factorsOf(const std::vector<Quad>& patches) const {
        Mesh all;
        for (const Mesh& mesh : meshes_) {
            const auto first = static_cast<std::uint32_t>(all.positions.size());
            all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
            for (const auto& t : mesh.triangles)
                all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        }
        completeNormals(all);
        const RayScene rays(all);
        const GaussRule& gauss = gaussLegendre(2);
        std::vector<double> factors(patches.size() * patches.size());
        tbb::parallel_for(std::size_t{0}, patches.size(), [&](std::size_t i) {
            const Quad& own = patches[i];
            for (const double a : gauss.nodes) {
                for (const double b : gauss.nodes) {
                    const Direction point = own.at((1 + a) / 2, (1 + b) / 2);
                    const double weight = own.stretch((1 + a) / 2, (1 + b) / 2) / (4 * own.area());
                    for (std::size_t j = 0; j < patches.size(); ++j) {
                        const Quad& other = patches[j];
                        if (dot(other.normal, point - other.corners[0]) <= 1e-6) continue;
                        const double factor = factorTo(point, own.normal, other.corners);
                        if (factor < 1e-12) continue;
                        factors[i * patches.size() + j] +=
                            factor * weight * visible(rays, point + 0.01 * own.normal, other);
                    }
                }
            }
        });
        return factors;
    }

    static std::array<Rgb, objects> means(const std::vector<Quad>& patches,
                                          const std::vector<Rgb>& radiance) {
        std::array<Rgb, objects> result{};
        std::array<double, objects> areas{};
        for (std::size_t i = 0; i < patches.size(); ++i) {
            areas[patches[i].object] += patches[i].area();
            for (std::size_t c = 0; c < 3; ++c)
                result[patches[i].object][c] += patches[i].area() * radiance[i][c];
        }
        for (std::size_t k = 0; k < objects; ++k)
            for (double& value : result[k]) value /= areas[k];
        return result;
    }

    static std::vector<Rgb> reflected(const std::vector<Quad>& patches,
                                      const std::vector<double>& factors,
                                      const std::vector<Rgb>& radiance) {
        std::vector<Rgb> next(patches.size());
        for (std::size_t i = 0; i < patches.size(); ++i) {
            const Rgb albedo = reflectance(patches[i].object);
            for (std::size_t j = 0; j < patches.size(); ++j)
                for (std::size_t c = 0; c < 3; ++c)
                    next[i][c] += albedo[c] * factors[i * patches.size() + j] * radiance[j][c];
        }
        return next;
    }

    std::vector<Mesh> meshes_;
    std::vector<Quad> faces_;
};

}  // namespace hshfit::test
