#include <brdfs/measured/rgl.h>
#include <hshfit/files/tensor_file.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

bool looksLikeRgl(std::span<const unsigned char> head, std::uint64_t) {
    return head.size() >= TensorFile::magic.size() &&
           std::equal(TensorFile::magic.begin(), TensorFile::magic.end(), head.begin());
}

std::unique_ptr<Brdf> openRgl(const std::string& path, const Parameters& parameters) {
    const bool smooth = parameters.choice("reading") == "smooth";
    return RglBrdf::open(path, smooth ? RglReading::smooth : RglReading::published);
}

}  // namespace

const Format& rglFormat() {
    static const Format format{
        .name = "rgl",
        .help = "RGL adaptive parameterisation, isotropic or not, RGB or spectral",
        .extension = ".bsdf",
        .recognises = looksLikeRgl,
        .parameters = {{.name = "reading",
                        .help = "smooth: without the ripple of the file's normals, and one value "
                                "over azimuth where wi is the normal",
                        .kind = Parameter::Kind::choice,
                        .fallback = {},
                        .choices = {"published", "smooth"}}},
        .open = openRgl,
    };
    return format;
}

}  // namespace hshfit::brdfs
