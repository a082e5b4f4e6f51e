#include "export.h"
#include "export_map.h"
#include "export_material.h"

#include <jobs/common/enum_words.h>
#include <jobs/common/option_words.h>

namespace hshfit::jobs {
namespace {

using options::at;
using options::spelled;

constexpr EnumWord packings[] = {{"coef4", "four coefficients a texel"},
                                 {"rgb", "one coefficient, its channels a texel"}};
using Packings = EnumWords<packings, gpu::Packing>;

std::vector<Word> wrapWords() {
    return {{"clamp"}, {"repeat"}};
}

constexpr OptionRow exportRows[] = {
    OptionRow{"target", at<&ExportOptions::targets>,
              "all that is possible, or containers, languages, renderers, three and viewer from "
              "hshfit list targets; or gltf, materialx, usd: a material fitted to the source"}
        .takes({targetWords, Syntax::list})
        .inPython("targets"),
    OptionRow{"outgoing", at<&ExportOptions::outgoing>,
              "Outgoing set of the textures, WxH or N; other than COEFFS' own: projected anew "
              "(default: its own; the forms halfway and basis are exported as they are)"}
        .takes({.syntax = Syntax::outgoing})
        .onlyFor(exports::coefficients),
    OptionRow{"basis", at<&ExportOptions::basis>,
              "With --outgoing, of the form halfway: what it is projected to"}
        .takes({.words = basisWords})
        .onlyFor(exports::coefficients),
    OptionRow{"order", at<&ExportOptions::order>, "With --basis"}.onlyFor(exports::coefficients),
    OptionRow{"name", at<&ExportOptions::name>,
              "What the files' names begin with (default: that of COEFFS)"},
    OptionRow{"number", spelled<gpu::parseNumber, gpu::numberName, &ExportOptions::number>,
              "float16, float32, unorm16 or unorm8 (default: float16; for the forms halfway and "
              "basis, the least that holds the file; with --lighting float16 or float32 of the "
              "cube, by default float32 beyond 65504)"}
        .takes({.words = numberWords})
        .onlyFor(exports::coefficients | exports::lighting),
    OptionRow{"storage", spelled<gpu::parseStorage, gpu::storageName, &ExportOptions::storage>,
              "Numbers of these forms in shaders: constants, block (one uniform block), texture, "
              "or auto: texture above 4096 numbers, else constants"}
        .takes({.words = storageWords})
        .onlyFor(exports::coefficients),
    OptionRow{
        "packing",
        spelled<Packings::parse, Packings::name, &ExportOptions::pack, &gpu::PackOptions::packing>,
        "coef4: four coefficients a texel; rgb: one coefficient, its channels a texel"}
        .takes({.words = Packings::words, .complete = true})
        .onlyFor(exports::coefficients),
    OptionRow{"chroma", at<&ExportOptions::pack, &gpu::PackOptions::luminanceChroma>,
              "Store luminance and chroma (Y, Co, Cg)"}
        .onlyFor(exports::coefficients),
    OptionRow{"chroma-order", at<&ExportOptions::pack, &gpu::PackOptions::chromaOrder>,
              "Bands kept of the chroma; implies --chroma (default: all)"}
        .onlyFor(exports::coefficients),
    OptionRow{"basis-textures", at<&ExportOptions::pack, &gpu::PackOptions::basisSize>,
              "Side of basis textures; without it shaders evaluate the basis"}
        .onlyFor(exports::coefficients),
    OptionRow{"environment-order",
              at<&ExportOptions::shader, &gpu::ShaderOptions::environmentOrder>,
              "Bands of the SH environment that shaders' shade() takes; 0: no shade()"}
        .onlyFor(exports::coefficients | exports::maps | exports::lighting),
    OptionRow{"prefix", at<&ExportOptions::shader, &gpu::ShaderOptions::prefix>,
              "What every name in a shader begins with"}
        .onlyFor(exports::coefficients | exports::maps | exports::lighting),
    OptionRow{"source", at<&ExportOptions::source>,
              "BRDF that the error is measured against (default: as COEFFS says)"}
        .takes({.syntax = Syntax::brdf, .files = Files::read, .dash = ""})
        .onlyFor(exports::coefficients | exports::materials | exports::lighting),
    OptionRow{"allow-loss", at<&ExportOptions::allowLoss>,
              "Accept an export more than twice as far from its source as COEFFS is"}
        .onlyFor(exports::coefficients),
    OptionRow{"error", at<&ExportOptions::measureError>, "Measure the error"}
        .orWithout("Do not measure the error")
        .inPython("measure_error")
        .onlyFor(exports::coefficients | exports::lighting),
    OptionRow{"light", at<&ExportOptions::lights>,
              "Environment of the viewer: a light of hshfit list lights, a picture, or a sum by "
              "'+'; repeated: several to choose from (default: studio)"}
        .takes({.syntax = Syntax::light, .files = Files::read, .dash = ""})
        .inPython("lights")
        .onlyFor(exports::coefficients | exports::maps | exports::lighting),
    OptionRow{"library", at<&ExportOptions::library>,
              "Of the target three: where its page finds three.js, a path from the folder or an "
              "address (default: ./node_modules/three)"}
        .takes({.files = Files::read})
        .onlyFor(exports::coefficients),
    OptionRow{"sampling", at<&ExportOptions::sampling>,
              "Fit a proposal for path tracing: in the sidecar, and as sample() and pdf() in "
              "shaders (default: with shaders)"}
        .orWithout("No proposal")
        .onlyFor(exports::coefficients),
    OptionRow{"zstd", at<&ExportOptions::zstd>, "Compress KTX2 with Zstandard"}.onlyFor(
        exports::coefficients),
    OptionRow{"force", at<&ExportOptions::force>, "Replace files that are there"},
};

constexpr OptionRow materialRows[] = {
    OptionRow{"mesh", at<&MaterialExportOptions::mesh>,
              "With gltf and usd: OBJ, PLY or glTF file, +y up (default: a sphere)"}
        .takes({.files = Files::read})
        .onlyFor(exports::materials),
    OptionRow{"extensions", at<&MaterialExportOptions::parts>,
              "With gltf, materialx and usd, of a fit: auto for the extensions (of OpenPBR: lobes) "
              "that held-out directions find worth it, none, all, or names with commas"}
        .onlyFor(exports::materials),
};

constexpr OptionRow mapRows[] = {
    OptionRow{"wrap", at<&MapExportOptions::wrap>,
              "Of a map of materials: what lies beyond its edge, clamp or repeat"}
        .takes({.words = wrapWords, .complete = true})
        .onlyFor(exports::maps),
};

}  // namespace

OptionRows<ExportOptions> exportOptions() {
    return {exportRows};
}

OptionRows<MaterialExportOptions> materialExportOptions() {
    return {materialRows};
}

OptionRows<MapExportOptions> mapExportOptions() {
    return {mapRows};
}

}  // namespace hshfit::jobs
