// filtered_maps LEVEL PICTURE FOLDER…: draws a level of maps that `hshfit svbrdf` wrote as planes
// under a lamp close above them, a row for each: base texels averaged, the level as it is stored,
// ordinary mips (the mean normal with the lobe of a texel). For maps whose texels differ in their
// normals alone.

#include <jobs/source/facet_lobes.h>
#include <jobs/source/filtered_texel_brdf.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/filtered_maps/filtered_map.h>
#include <hshfit/normal_filtering/surface_frame.h>
#include <hshfit/pictures/rgb_picture.h>

#include <cmath>
#include <cstdlib>

namespace {

using namespace hshfit;

constexpr std::size_t gap = 4;

/// f cos(theta_i) of a texel in a frame.
struct Lit {
    const FilteredMap& map;
    const FilteredSidecar& sidecar;
    jobs::FacetLobes lobes;
    FilteredSurface surface;
    std::shared_ptr<const LobeTable> table;
    std::shared_ptr<const Basis> basis;

    explicit Lit(const FilteredMap& m)
        : map(m),
          sidecar(m.sidecar()),
          lobes(sidecar.model, sidecar.nodes),
          surface(lobes.surface(sidecar.terms, sidecar.channels.count(), sidecar.layout.albedos)),
          table(lobes.table(sidecar.layout.order)) {}

    SurfaceTexel texel(std::size_t level, std::size_t x, std::size_t y) const {
        const std::vector<double> numbers = map.numbers(level, x, y);
        const MipLayout& layout = sidecar.layout;
        SurfaceTexel t{.normal = normalised({numbers[0], numbers[1], numbers[2]})};
        for (int k = 0; k < layout.weights; ++k)
            t.weights[static_cast<std::size_t>(k)] =
                numbers[MipLayout::weight + static_cast<std::size_t>(k)];
        for (int k = 0; k < layout.albedos; ++k)
            t.albedos[static_cast<std::size_t>(k)] = numbers[layout.albedo(k)] * std::sqrt(4 * pi);
        return t;
    }
    void add(const SurfaceTexel& t, const Direction& wi, const Direction& wo, double share,
             double* sum) const {
        const SurfaceFrame frame(t.normal, t.tangent);
        const Direction i = frame.toLocal(wi), o = frame.toLocal(wo);
        double f[3] = {};
        if (!(i.z > 0) || !(o.z > 0)) return;
        surface.brdf(t, i, o, {f, sidecar.channels.count()});
        for (std::size_t c = 0; c < 3; ++c) sum[c] += share * f[c] * i.z;
    }
    void stored(std::size_t level, std::size_t x, std::size_t y, const Direction& wi,
                const Direction& wo, double* out) const {
        const bool harmonics = sidecar.form == "harmonics";
        const FilteredTexel filtered(sidecar.layout, map.numbers(level, x, y), *table);
        filtered.reflect({harmonics ? MipForm::harmonics : MipForm::ellipse}, surface.rest, wi, wo,
                         {out, sidecar.channels.count()}, surface.shape);
    }
};

void draw(const FilteredMap& map, std::size_t level, std::size_t top, RgbPicture& picture) {
    const Lit lit(map);
    const auto [width, height] = map.sidecar().levels[level];
    const std::size_t cell = std::size_t{1} << level;
    eachInParallel(height, [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x) {
            const Direction p{(static_cast<double>(x) + 0.5) / static_cast<double>(width) - 0.5,
                              0.5 - (static_cast<double>(y) + 0.5) / static_cast<double>(height),
                              0};
            const Direction toLamp = Direction{-0.15, 0.45, 0.5} - p, wi = normalised(toLamp),
                            wo = normalised(Direction{0.1, -0.9, 0.8} - p);
            double out[3][3] = {};
            for (std::size_t k = 0; k < cell * cell; ++k)
                lit.add(lit.texel(0, x * cell + k % cell, y * cell + k / cell), wi, wo,
                        1 / static_cast<double>(cell * cell), out[0]);
            lit.stored(level, x, y, wi, wo, out[1]);
            lit.add(lit.texel(level, x, y), wi, wo, 1, out[2]);
            for (std::size_t k = 0; k < 3; ++k) {
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::size_t column = k * (width + gap) + x;
                    picture
                        .values[((top + y) * static_cast<std::size_t>(picture.width) + column) * 3 +
                                c] = static_cast<float>(out[k][c] / dot(toLamp, toLamp));
                }
            }
        }
    });
}

}  // namespace

int main(int count, char** words) {
    if (count < 4) return 2;
    const std::size_t level = std::strtoul(words[1], nullptr, 10);
    RgbPicture picture;
    std::size_t top = 0;
    for (int k = 3; k < count; ++k) {
        const FilteredMap map(std::string(words[k]) + "/material.json");
        const auto [width, height] = map.sidecar().levels[level];
        if (k == 3) {
            const std::size_t rows = static_cast<std::size_t>(count) - 3;
            picture = RgbPicture{static_cast<int>(3 * width + 2 * gap),
                                 static_cast<int>(rows * (height + gap) - gap)};
            picture.values.assign(static_cast<std::size_t>(picture.width) *
                                      static_cast<std::size_t>(picture.height) * 3,
                                  1);
        }
        draw(map, level, top, picture);
        top += height + gap;
    }
    AtomicFile file(words[2]);
    file.write(rgbPng(picture, automaticExposure(picture)));
    file.commit();
}
