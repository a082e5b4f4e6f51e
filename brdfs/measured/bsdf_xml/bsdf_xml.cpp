#include <brdfs/measured/bsdf_xml/bsdf_xml.h>
#include <brdfs/measured/bsdf_xml/klems_brdf.h>
#include <brdfs/measured/bsdf_xml/tree_brdf.h>
#include <hshfit/files/mapped_file.h>

namespace hshfit::brdfs {
namespace {

bool looksLikeBsdfXml(std::span<const unsigned char> head, std::uint64_t) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    return text.find("<WindowElement") != std::string_view::npos;
}

std::unique_ptr<Brdf> openFile(const std::string& path, const Parameters& parameters) {
    const MappedFile file(path);
    const std::string word = parameters.choice("side");
    std::optional<BsdfSide> side;
    if (word != "auto") side = word.ends_with("back") ? BsdfSide::back : BsdfSide::front;
    std::unique_ptr<Brdf> brdf =
        openBsdfXml(file.bytes(), path, side, parameters.choice("wavelength"));
    file.checkIntact();
    return brdf;
}

}  // namespace

std::unique_ptr<MeasuredBrdf> openBsdfXml(std::span<const unsigned char> bytes, std::string name,
                                          std::optional<BsdfSide> side,
                                          std::string_view wavelength) {
    const BsdfDocument document(bytes, std::move(name));
    BsdfSelection selection = selectBlocks(document, side, wavelength);
    if (document.isTree()) return std::make_unique<TreeBrdf>(document, std::move(selection));
    return std::make_unique<KlemsBrdf>(document, std::move(selection));
}

const Format& bsdfXmlFormat() {
    static const Format format{
        .name = "bsdf-xml",
        .help = "BSDF XML of WINDOW and Radiance, Klems matrices and tensor trees",
        .extension = ".xml",
        .recognises = looksLikeBsdfXml,
        .parameters = {{.name = "side",
                        .help = "as the file calls it, Radiance calls the back front; auto: front, "
                                "or the only reflection there is",
                        .kind = Parameter::Kind::choice,
                        .fallback = {},
                        .choices = {"auto", "front", "back", "reflection-front",
                                    "reflection-back"}},
                       {.name = "wavelength",
                        .help =
                            "visible (in colour where the file is), solar, nir, a wavelength in "
                            "nm, or spectrum for all of them; left out: visible, else spectrum",
                        .kind = Parameter::Kind::text,
                        .fallback = {},
                        .choices = {"solar"}}},
        .open = openFile,
    };
    return format;
}

}  // namespace hshfit::brdfs
