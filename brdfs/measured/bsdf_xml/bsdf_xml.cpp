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
    std::unique_ptr<Brdf> brdf =
        openBsdfXml(file.bytes(), path, sideNamed(word), parameters.choice("wavelength"));
    file.checkIntact();
    return brdf;
}

/// The blocks of one kind; where they transmit, with the energy of the reflection beside them. A
/// reflection that cannot be read, or not be added, is a fact of the BRDF.
template <class Stored>
std::unique_ptr<MeasuredBrdf> make(const BsdfDocument& document, BsdfSelection selection,
                                   std::string_view wavelength) {
    const BsdfSide side = selection.side;
    auto brdf = std::make_unique<Stored>(document, std::move(selection));
    if (!isTransmission(side)) return brdf;
    constexpr const char* notRead = "reflection_not_read";
    try {
        if (!hasBlocks(document, counterpart(side), wavelength)) return brdf;
        const Stored reflection(document, selectBlocks(document, counterpart(side), wavelength));
        if (!brdf->addReflection(reflection))
            brdf->addFact({notRead, "its cells or channels are others; energy is judged without"});
    } catch (const InputError& error) {
        brdf->addFact({notRead, std::string(error.what()) + "; energy is judged without"});
    }
    return brdf;
}

}  // namespace

std::unique_ptr<MeasuredBrdf> openBsdfXml(std::span<const unsigned char> bytes, std::string name,
                                          std::optional<BsdfSide> side,
                                          std::string_view wavelength) {
    const BsdfDocument document(bytes, std::move(name));
    BsdfSelection selection = selectBlocks(document, side, wavelength);
    if (document.isTree()) return make<TreeBrdf>(document, std::move(selection), wavelength);
    return make<KlemsBrdf>(document, std::move(selection), wavelength);
}

const Format& bsdfXmlFormat() {
    static const Format format{
        .name = "bsdf-xml",
        .help = "BSDF XML of WINDOW and Radiance, Klems matrices and tensor trees",
        .extension = ".xml",
        .recognises = looksLikeBsdfXml,
        .parameters = {{.name = "side",
                        .help = "as the file calls it, Radiance calls the back front; auto: front, "
                                "or the only reflection there is, or the only transmission",
                        .kind = Parameter::Kind::choice,
                        .fallback = {},
                        .choices = {"auto", "front", "back", "reflection-front", "reflection-back",
                                    "transmission-front", "transmission-back"}},
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
