// normal_filtering [SIZE]: the tables of docs/normal_filtering.md.

#include <lib/normal_filtering/surfaces.h>

#include <fmt/core.h>

#include <cstdlib>

namespace {

using namespace hshfit;

void table(const char* name, const test::GgxSurface& ggx, int order) {
    const auto lobes = ggx.table(order);
    const MipLayout layout{.weights = 1, .albedos = 1, .order = order};
    const auto levels = filterNormals(ggx.size, ggx.size, ggx.texels, lobes, layout);
    fmt::print("{} alpha {} {}; gaussians {} error {:.2g}\n", name, ggx.ax, ggx.ay,
               lobes->gaussians({0, 0}).peaks.size(), lobes->gaussians({0, 0}).error);
    MipErrorOptions options;
    for (int n = 5; n < order; n = 2 * n - 1) options.orders.push_back(n);
    options.orders.push_back(order);
    for (int level = 1; level <= static_cast<int>(levels.size()); ++level) {
        if (level == 3 || level == 5) continue;
        const MipErrors e = measureMipLevel(
            ggx.surface(), level, levels[static_cast<std::size_t>(level - 1)], *lobes, options);
        for (const MipError& f : e.forms)
            fmt::print(
                "| {} | {} {} | {} | {:.4f} | {:.1f} | {:.3f} | ({:.0f}, {:.0f}) | {:.3f} | {:.3f} "
                "|\n",
                level, f.form, f.order ? std::to_string(f.order) : "", f.numbers, f.relative,
                e.forms[0].relative / f.relative, f.maximum, degrees(polarAngle(f.wi)),
                degrees(polarAngle(f.wo)), f.albedo, f.worstAlbedo);
        fmt::print("noise {:.3g}\n", e.noise);
    }
}

}  // namespace

int main() {
    for (const double alpha : {0.1, 0.3}) {
        table("bumpy .3", {test::SlopeMap::bumpy(0.3), alpha, alpha}, 33);
        table("brushed .3", {test::SlopeMap::brushed(0.3, 0.05), alpha, alpha}, 33);
    }
}
