#include <hshfit/filtered_maps/plain_texel.h>

#include <hshfit/normal_filtering/surface_frame.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline filtered_maps {

PlainTexel::PlainTexel(const FilteredSurface& surface, const MipLayout& layout,
                       const FilteredTexel& texel, std::span<const double> numbers)
    : surface_(surface),
      texel_{.normal = texel.normal(),
             .tangent = texel.tangentAt(texel.normal()),
             .lobe = texel.lobe()} {
    for (int k = 0; k < layout.weights; ++k)
        texel_.weights[static_cast<std::size_t>(k)] =
            numbers[MipLayout::weight + static_cast<std::size_t>(k)];
    // Albedo times Y_0 = 1 / sqrt(4 pi).
    for (int k = 0; k < layout.albedos; ++k)
        texel_.albedos[static_cast<std::size_t>(k)] = numbers[layout.albedo(k)] * std::sqrt(4 * pi);
}

void PlainTexel::reflect(const Direction& wi, const Direction& wo, std::span<double> out) const {
    std::fill(out.begin(), out.end(), 0.0);
    const SurfaceFrame frame(texel_.normal, texel_.tangent);
    const Direction i = frame.toLocal(wi), o = frame.toLocal(wo);
    if (!(i.z > 0) || !(o.z > 0)) return;
    surface_.brdf(texel_, i, o, out);
    for (double& value : out) value *= i.z;
}

}  // namespace hshfit::inline filtered_maps
