#include <brdfs/measured/merl.h>
#include <brdfs/measured/no_values.h>

#include <cstdint>
#include <cstring>

namespace hshfit::brdfs {
namespace {

// Correct dimensions or a correct size are enough, so that the reader can report the wrong one.
bool looksLikeMerl(std::span<const unsigned char> head, std::uint64_t fileSize) {
    if (fileSize == MerlLayout{.azimuthCount = 180}.fileBytes() ||
        fileSize == MerlLayout{.azimuthCount = 360}.fileBytes()) {
        return true;
    }
    std::int32_t dimensions[3];
    if (head.size() < sizeof dimensions) return false;
    std::memcpy(dimensions, head.data(), sizeof dimensions);
    return dimensions[0] == 90 && dimensions[1] == 90 &&
           (dimensions[2] == 180 || dimensions[2] == 360);
}

/// Stops at the first cell that has a value.
bool hasValues(const MerlBrdf& brdf) {
    for (std::size_t cell = 0; cell < brdf.layout().cells(); ++cell)
        if (!(brdf.stored(0, cell) < 0)) return true;
    return false;
}

std::unique_ptr<Brdf> openMerl(const std::string& path, const Parameters& parameters) {
    const bool nearest = parameters.choice("interpolation") == "nearest";
    auto brdf = std::make_unique<MerlBrdf>(
        path, nearest ? MerlInterpolation::nearest : MerlInterpolation::linear);
    if (!hasValues(*brdf)) refuseWithoutValues(brdf->census(), path);
    return brdf;
}

}  // namespace

const Format& merlFormat() {
    static const Format format{
        .name = "merl",
        .help = "MERL table of half and difference angles, isotropic, RGB",
        .extension = ".binary",
        .recognises = looksLikeMerl,
        .parameters = {{.name = "interpolation",
                        .help = "between the nodes of the table",
                        .kind = Parameter::Kind::choice,
                        .fallback = {},
                        .choices = {"linear", "nearest"}}},
        .open = openMerl,
    };
    return format;
}

}  // namespace hshfit::brdfs
