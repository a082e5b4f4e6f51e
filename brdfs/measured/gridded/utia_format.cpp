#include <brdfs/measured/gridded/utia.h>
#include <hshfit/files/exr_header.h>

namespace hshfit::brdfs {
namespace {

// A picture of that size, unless its attributes name another of our formats.
bool looksLikeUtia(std::span<const unsigned char> head, std::uint64_t fileSize) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    if (!hasExrMagic(text)) return fileSize == UtiaBrdf::fileBytes;
    return exrSaysSize(text, UtiaBrdf::nodes, UtiaBrdf::nodes) &&
           !exrHasAttribute(text, "hshfit:slices") && !exrSaysCoefficients(text);
}

std::unique_ptr<Brdf> openUtia(const std::string& path, const Parameters& parameters) {
    UtiaOptions options{.scale = parameters.number("scale")};
    if (parameters.choice("beyond") == "constant") options.beyond = UtiaOptions::Beyond::constant;
    const std::string colours = parameters.choice("colours");
    if (colours == "srgb") options.colours = UtiaOptions::Colours::srgb;
    if (colours == "xyz") options.colours = UtiaOptions::Colours::xyz;
    return UtiaBrdf::open(path, options);
}

}  // namespace

const Format& utiaFormat() {
    static const Format format{
        .name = "utia",
        .help = "UTIA table of two directions, anisotropic, RGB (.bin and .exr)",
        .extension = ".bin",
        .recognises = looksLikeUtia,
        .parameters = {{.name = "beyond",
                        .help = "between 75 degrees and the horizon",
                        .kind = Parameter::Kind::choice,
                        .fallback = {},
                        .choices = {"linear", "constant"}},
                       {.name = "colours",
                        .help = "what the three planes hold",
                        .kind = Parameter::Kind::choice,
                        .fallback = {},
                        .choices = {"rgb", "srgb", "xyz"}},
                       {.name = "scale",
                        .help = "f in 1/sr of a stored 1",
                        .kind = Parameter::Kind::number,
                        .fallback = 1,
                        .min = 1e-12,
                        .max = 1e12}},
        .open = openUtia,
    };
    return format;
}

}  // namespace hshfit::brdfs
