#include <brdfs/measured/merl.h>

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

std::unique_ptr<Brdf> openMerl(const std::string& path, const Parameters& parameters) {
    const bool nearest = parameters.choice("interpolation") == "nearest";
    return std::make_unique<MerlBrdf>(
        path, nearest ? MerlInterpolation::nearest : MerlInterpolation::linear);
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
