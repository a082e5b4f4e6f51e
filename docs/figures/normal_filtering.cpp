// normal_filtering PICTURE: prints the tables of docs/explanation/normal_filtering.md, and draws a
// plane of 128 x 128 mip texels of level 3 under a lamp close above it: base texels averaged,
// ellipses, harmonics of order 17, ordinary mips; bumpy above, brushed below.

#include <lib/normal_filtering/surfaces.h>

#include <hshfit/files/atomic_file.h>
#include <hshfit/normal_filtering/surface_frame.h>
#include <hshfit/pictures/rgb_picture.h>

#include <fmt/core.h>

namespace {

using namespace hshfit;

void printErrors(const char* name, const test::GgxSurface& ggx) {
    constexpr int order = 33;
    const auto lobes = ggx.table(order);
    const MipLayout layout{.weights = 1, .albedos = 1, .order = order};
    const auto levels = filterNormals(ggx.size, ggx.size, ggx.texels, lobes, layout);
    MipErrorOptions options;
    options.orders = {9, 17, 33};
    options.atMeanNormal = true;
    for (const int level : {1, 2, 4, 6, 8}) {
        const MipLevel& made = levels[static_cast<std::size_t>(level - 1)];
        const MipErrors e = measureMipLevel(ggx.surface(), level, made, *lobes, options);
        options.byVisibleArea = true;
        const MipErrors seen = measureMipLevel(ggx.surface(), level, made, *lobes, options);
        options.byVisibleArea = false;
        for (std::size_t k = 0; k < e.forms.size(); ++k) {
            const MipError& f = e.forms[k];
            if (!f.use.facets && f.use.form != MipForm::ellipse) continue;
            fmt::print(
                "| {} {} | {} | {}{} | {} | {:.3f} | {:.1f} | {:.2f} | {:.0f}, {:.0f} | "
                "{:.3f} | {:.2f} | {:.3f} |\n",
                name, ggx.ax, level, f.form, f.use.order > 0 ? fmt::format(" {}", f.use.order) : "",
                f.numbers, f.relative, e.forms[0].relative / f.relative, f.maximum,
                degrees(polarAngle(f.wi)), degrees(polarAngle(f.wo)), f.albedo, f.worstAlbedo,
                seen.forms[k].relative);
        }
        fmt::print("noise {:.3f}, order for 10 % {}\n", e.noise, orderFor(made, 0.1));
    }
}

constexpr int side = 128, cell = 8;

/// Four squares beside each other, from row `top` of the picture on.
void draw(const test::GgxSurface& ggx, int top, RgbPicture& picture) {
    const auto lobes = ggx.table(17);
    const MipLayout layout{.weights = 1, .albedos = 1, .order = 17};
    const MipLevel level = filterNormals(ggx.size, ggx.size, ggx.texels, lobes, layout)[2];
    const FilteredSurface s = ggx.surface();
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const Direction p{(x + 0.5) / side - 0.5, 0.5 - (y + 0.5) / side, 0};
            const Direction toLamp = Direction{-0.15, 0.45, 0.5} - p,
                            wo = normalised(Direction{0.1, -0.9, 0.8} - p), wi = normalised(toLamp);
            double out[4] = {};
            Direction mean{0, 0, 0};
            const auto add = [&](const Direction& n, double& sum, double share) {
                const SurfaceFrame frame(n, {1, 0, 0});
                const Direction i = frame.toLocal(wi), o = frame.toLocal(wo);
                double f = 0;
                if (i.z > 0 && o.z > 0) s.brdf({}, i, o, {&f, 1});
                sum += share * f * std::max(i.z, 0.0);
            };
            for (int k = 0; k < cell * cell; ++k) {
                const Direction n = s.texel(static_cast<std::size_t>(x * cell + k % cell),
                                            static_cast<std::size_t>(y * cell + k / cell))
                                        .normal;
                add(n, out[0], 1.0 / (cell * cell));
                mean = mean + n;
            }
            add(mean, out[3], 1);
            const FilteredTexel texel(
                layout, level.texel(static_cast<std::size_t>(x), static_cast<std::size_t>(y)),
                *lobes);
            texel.reflect({MipForm::ellipse}, s.rest, wi, wo, {&out[1], 1});
            texel.reflect({MipForm::harmonics}, s.rest, wi, wo, {&out[2], 1});
            for (int k = 0; k < 4; ++k)
                for (int c = 0; c < 3; ++c)
                    picture.values[static_cast<std::size_t>(
                        ((top + y) * picture.width + k * (side + 4) + x) * 3 + c)] =
                        static_cast<float>(out[k] / dot(toLamp, toLamp));
        }
}

}  // namespace

int main(int count, char** words) {
    const test::SlopeMap bumpy = test::SlopeMap::bumpy(0.3),
                         brushed = test::SlopeMap::brushed(0.3, 0.05);
    for (const double alpha : {0.1, 0.3}) {
        printErrors("bumpy", {bumpy, alpha, alpha});
        printErrors("brushed", {brushed, alpha, alpha});
    }
    if (count < 2) return 0;
    RgbPicture picture{4 * side + 12, 2 * side + 4};
    picture.values.assign(static_cast<std::size_t>(picture.width * picture.height * 3), 1);
    draw({bumpy, 0.1, 0.1, side * cell}, 0, picture);
    draw({brushed, 0.1, 0.1, side * cell}, side + 4, picture);
    AtomicFile file(words[1]);
    file.write(rgbPng(picture, automaticExposure(picture)));
    file.commit();
}
