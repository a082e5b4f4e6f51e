#include "library_options.h"

#include <jobs/common/option_words.h>

#include <hshfit/error.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <charconv>

namespace hshfit::jobs {
namespace {

namespace ml = material_library;
namespace of = libraries;
using options::at;

std::vector<Word> componentWords() {
    return {{"auto", "by materials that take no part"}};
}

std::vector<Word> instrumentWords() {
    return {{"free"}, {"in-plane", "a goniometer in the plane of incidence"}};
}

std::vector<Word> libraryTargetWords() {
    std::vector<Word> words;
    for (const gpu::Target& target : gpu::targets())
        if (holdsLibrary(target))
            words.push_back({std::string(target.name), std::string(target.summary)});
    return withAll(words);
}

constexpr Bounds<double> limit{0, ml::greatestLimit};
// The defaults as the rows state them.
constexpr ml::Limits usual;
static_assert(usual.log == 0.15 && usual.maximum == 0.5 && usual.flip == 0.1);

constexpr OptionRow libraryRows[] = {
    OptionRow{"components", at<&LibraryOptions::components>,
              "learn, merge: components of the basis, auto (by materials that take no part) or a "
              "number; encode: that are used"}
        .takes({.words = componentWords})
        .onlyFor(of::learn | of::merge | of::encode),
    OptionRow{"bytes",
              at<&LibraryOptions::learn, &LearnLibraryOptions::learn, &ml::LearnOptions::bytes>,
              "learn, merge: of a material in colours; a third of it for each channel"}
        .within(Bounds<int>{6, 65536})
        .onlyFor(of::learn | of::merge),
    OptionRow{"held-out",
              at<&LibraryOptions::learn, &LearnLibraryOptions::learn, &ml::LearnOptions::heldOut>,
              "learn, merge: share of the materials that take no part in choosing the components"}
        .within(Bounds<double>{0.01, 0.5})
        .onlyFor(of::learn | of::merge),
    OptionRow{"limit", at<&LibraryOptions::encode, &EncodeOptions::log>,
              "learn, encode: mean error of ln(f + 0.001) beyond which a material keeps a form of "
              "its own"}
        .within(limit)
        .byDefault("0.15")
        .onlyFor(of::learn | of::encode),
    OptionRow{"limit-maximum", at<&LibraryOptions::encode, &EncodeOptions::maximum>,
              "learn, encode: the same for the largest error of f cos, as a share of the largest "
              "f cos"}
        .within(limit)
        .byDefault("0.5")
        .onlyFor(of::learn | of::encode),
    OptionRow{"limit-flip", at<&LibraryOptions::encode, &EncodeOptions::flip>,
              "learn, encode: the same for the mean FLIP of spheres; from 1 on no picture is drawn"}
        .within(limit)
        .byDefault("0.1")
        .onlyFor(of::learn | of::encode),
    OptionRow{"add-to", at<&LibraryOptions::learn, &LearnLibraryOptions::addTo>,
              "learn: a library whose materials come first"}
        .takes({.files = Files::read, .dash = ""})
        .onlyFor(of::learn | of::add),
    OptionRow{"seconds", at<&LibraryOptions::learn, &LearnLibraryOptions::seconds>,
              "learn: end the reading of materials after that time, and learn from those that were "
              "read by then"}
        .within(bounds::seconds)
        .onlyFor(of::learn | of::add),
    OptionRow{"final", at<&LibraryOptions::learn, &LearnLibraryOptions::final>,
              "learn, merge: without what adding and merging need"}
        .onlyFor(of::learn | of::add | of::merge),
    OptionRow{"library", at<&LibraryOptions::reconstruct, &ReconstructOptions::library>,
              "reconstruct, next: the library that is the prior"}
        .takes({.files = Files::read, .dash = ""})
        .onlyFor(of::reconstruct | of::next),
    OptionRow{"count", at<&LibraryOptions::count>,
              "search, mix: materials; next: pairs of directions"}
        .within(Bounds<int>{1, 1000})
        .onlyFor(of::search | of::mix | of::next),
    OptionRow{"sigma", at<&LibraryOptions::reconstruct, &ReconstructOptions::sigma>,
              "reconstruct, next: standard uncertainty of the samples, as in fit: 2%, 0.001, "
              "2%+0.001; reconstruct also column or FILE.csv"}
        .takes(sigmaValues)
        .onlyFor(of::reconstruct | of::next),
    OptionRow{"instrument", at<&LibraryOptions::next, &NextPairsOptions::instrument>,
              "next: free, or in-plane for a goniometer in the plane of incidence"}
        .takes({.words = instrumentWords, .complete = true})
        .onlyFor(of::next),
    OptionRow{
        "target", at<&LibraryOptions::exporting, &LibraryExportOptions::targets>,
        "export: three (a material for three.js), shaders (glsl, glsl-es, hlsl, slang, metal, "
        "wgsl) and containers of texels (bin, dds, exr, ktx2, …), with commas, or all"}
        .takes({libraryTargetWords, Syntax::list})
        .inPython("targets")
        .onlyFor(of::exported),
    OptionRow{"table-error", at<&LibraryOptions::exporting, &LibraryExportOptions::tableError>,
              "export: largest error of ln(f + 0.001) by the table of the functions; 0: the "
              "functions as constants of the shader, exact and many times as slow"}
        .within(Bounds<double>{0, 10})
        .onlyFor(of::exported),
    OptionRow{"sampling", at<&LibraryOptions::exporting, &LibraryExportOptions::sampling>,
              "export: elevations of a proposal that is fitted to each material, with sample and "
              "pdf in the shaders; 0: none"}
        .within(Bounds<int>{0, 64})
        .onlyFor(of::exported),
    OptionRow{"near", at<&LibraryOptions::map, &LibraryMapOptions::near>,
              "map: mean FLIP of the thumbnails of two neighbours up to which they are near "
              "duplicates"}
        .within(Bounds<double>{0, 1})
        .onlyFor(of::map),
    OptionRow{"prefix", at<&LibraryOptions::exporting, &LibraryExportOptions::prefix>,
              "export: of the names in shaders"}
        .onlyFor(of::exported),
    OptionRow{"bands", at<&LibraryOptions::reconstruct, &ReconstructOptions::bands>,
              "reconstruct: error bands at pairs of directions: a CSV with wi_x ... wo_z, or "
              "plane:30/60 for planes of incidence"}
        .takes({.files = Files::read, .dash = ".csv"})
        .onlyFor(of::reconstruct),
    OptionRow{"bands-to", at<&LibraryOptions::reconstruct, &ReconstructOptions::bandsTo>,
              "CSV file for the bands"}
        .takes({.files = Files::written, .dash = ".csv"})
        .onlyFor(of::reconstruct),
};

}  // namespace

std::size_t LibraryOptions::componentCount() const {
    if (components == "auto") return 0;
    std::size_t number = 0;
    const char* const end = components.data() + components.size();
    const auto [next, error] = std::from_chars(components.data(), end, number);
    if (error != std::errc() || next != end || number < 1 || number > 512)
        throw UsageError(fmt::format("{} '{}': expected auto or a number from 1 to 512",
                                     Setting{"LearnOptions::components"}, components));
    return number;
}

OptionRows<LibraryOptions> libraryOptions() {
    return {libraryRows};
}

}  // namespace hshfit::jobs
