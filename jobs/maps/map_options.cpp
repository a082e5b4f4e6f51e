#include "map_options.h"

#include "library_svbrdf.h"

#include <jobs/common/option_words.h>

#include <hshfit/representation/forms/form.h>

#include <algorithm>
#include <iterator>

namespace hshfit::jobs {
namespace {

using options::at;

std::vector<Word> mapFormWords() {
    std::vector<Word> words;
    for (const std::string_view form : mapForms) words.push_back({std::string(form)});
    return words;
}

std::vector<Word> mapPrecisionWords() {
    return {{"half"}, {"float16", "as half"}, {"float32"}};
}

std::vector<Word> mipsWords() {
    return {{"reflectance"}, {"none"}};
}

std::vector<Word> writesWords() {
    return {{"direct"}, {"cached"}};
}

constexpr unsigned bitOf(std::string_view form) {
    return 1U << (std::ranges::find(mapForms, form) - std::begin(mapForms));
}
constexpr unsigned halfwayForm = bitOf("halfway"), libraryForm = bitOf("library"),
                   materialForms = bitOf("clusters") | halfwayForm,
                   sharedForms = bitOf("low-rank") | materialForms,
                   texelForms = bitOf("outgoing") | sharedForms,
                   commonFrameForms = texelForms | libraryForm,
                   harmonicForms = bitOf("harmonics") | bitOf("filtered");

constexpr OptionRow mapOptionRows[] = {
    OptionRow{"form", at<&MapOptions::form>,
              "outgoing: all coefficients; low-rank: weights of shared shapes; clusters: the index "
              "of a shared material; halfway: likewise, of a material in the halfway form; "
              "library: coordinates in a library of "
              "materials. Of "
              "turned texels: ellipse or harmonics of the normals' distribution; filtered: the "
              "cheaper one within --error (default: filtered where the description has normals or "
              "directions, else outgoing)"}
        .takes({.words = mapFormWords, .complete = true}),
    OptionRow{"basis", at<&MapOptions::texels, &SvbrdfOptions::basis>,
              "Basis over incoming directions"}
        .takes({.words = basisWords})
        .onlyFor(texelForms),
    OptionRow{"order", at<&MapOptions::texels, &SvbrdfOptions::order>, "Bands of the basis"}
        .within(bounds::mapOrder)
        .onlyFor(texelForms),
    OptionRow{"outgoing", at<&MapOptions::texels, &SvbrdfOptions::outgoing>,
              "Outgoing directions: N elevations, or WxH (default: 8 elevations where all texels "
              "are isotropic, else 8x8)"}
        .takes({.syntax = Syntax::outgoing})
        .onlyFor(texelForms),
    OptionRow{"cosine", at<&MapOptions::texels, &SvbrdfOptions::cosine>,
              "Coefficients of f cos(theta_i) instead of f"}
        .onlyFor(texelForms),
    OptionRow{"precision", at<&MapOptions::precision>, "Numbers of the texture: half or float32"}
        .takes({.words = mapPrecisionWords, .complete = true}),
    OptionRow{"tolerance", at<&MapOptions::texels, &SvbrdfOptions::tolerance>,
              "Relative error of lobes between the nodes of their table"}
        .within(bounds::mapTolerance)
        .onlyFor(texelForms),
    OptionRow{"rank", at<&MapOptions::texels, &SvbrdfOptions::rank>,
              "Shared shapes (default: by --error)"}
        .within(bounds::mapRank)
        .onlyFor(sharedForms),
    OptionRow{"error", at<&MapOptions::error>,
              "With --form low-rank or clusters: the largest relative error that shared shapes may "
              "leave in a sampled texel (default: 0.01); with --form filtered or harmonics: that "
              "of a level against samples (default: 0.1)"}
        .within(bounds::mapError)
        .onlyFor(sharedForms | harmonicForms),
    OptionRow{"harmonics", at<&MapOptions::harmonics>,
              "Order of the harmonics of --form harmonics, odd (default: 9, 17 or 33 by --error)"}
        .within(bounds::mapHarmonics)
        .onlyFor(harmonicForms),
    OptionRow{"halfway", at<&MapOptions::halfway>,
              "Functions along each axis of the materials of --form halfway, as of hshfit project"}
        .takes({.syntax = Syntax::list})
        .onlyFor(halfwayForm),
    OptionRow{"clusters", at<&MapOptions::texels, &SvbrdfOptions::clusters>,
              "Shared materials of --form clusters or halfway, of each level"}
        .within(bounds::mapClusters)
        .onlyFor(materialForms),
    OptionRow{"library", at<&MapOptions::texels, &SvbrdfOptions::library>,
              "A library of materials for --form library (default: learned from the map)"}
        .takes({.files = Files::read, .dash = ""})
        .onlyFor(libraryForm),
    OptionRow{"components", at<&MapOptions::texels, &SvbrdfOptions::components>,
              "Components of that library (default: 11 of one that is learned, all of a given one)"}
        .within(Bounds<int>{1, 120})
        .onlyFor(libraryForm),
    OptionRow{"mips", at<&MapOptions::texels, &SvbrdfOptions::mips>,
              "reflectance: levels of averaged reflectance; none: level 0 alone"}
        .takes({.words = mipsWords, .complete = true}),
    OptionRow{"checks", at<&MapOptions::texels, &SvbrdfOptions::checks>,
              "Texels of each level that are measured against the texels that they stand for"}
        .within(bounds::mapChecks),
    OptionRow{"seconds", at<&MapOptions::texels, &SvbrdfOptions::seconds>,
              "End the measuring of errors, and of forms that were not asked for, after that time; "
              "the map is whole all the same"}
        .within(bounds::seconds)
        .onlyFor(commonFrameForms),
    OptionRow{"memory", at<&MapOptions::memory>,
              "MiB that bands of the map may take, of each process"}
        .within(bounds::mapMemory)
        .onlyFor(commonFrameForms),
    OptionRow{"writes", at<&MapOptions::texels, &SvbrdfOptions::pastPageCache>,
              "direct: texels go past the page cache, where the file system can; cached: through "
              "it, for a slow disk or files that are read at once"}
        .takes({.words = writesWords, .complete = true})
        .inPython("direct")
        .onlyFor(commonFrameForms),
    OptionRow{"force", at<&MapOptions::texels, &SvbrdfOptions::force>, "Replace existing files"},
};

}  // namespace

OptionRows<MapOptions> mapOptions() {
    return {mapOptionRows};
}

std::string mapFormOf(const std::string& description, const MapOptions& options) {
    if (!options.form.empty()) return options.form;
    return turnsTexels(description) ? "filtered" : "outgoing";
}

unsigned mapFormBit(std::string_view form) {
    return bitOf(form);
}

std::string mapFormNames(unsigned bits) {
    std::string names;
    for (const std::string_view form : mapForms) {
        if ((bits & bitOf(form)) == 0) continue;
        bits &= ~bitOf(form);
        if (!names.empty()) names += bits == 0 ? " and " : ", ";
        names += form;
    }
    return names;
}

std::variant<Svbrdf, FilteredMapAnswer> makeMap(const std::string& description,
                                                const std::string& folder, const MapOptions& asked,
                                                const Listener& listener) {
    SvbrdfOptions options = asked.texels;
    options.form = mapFormOf(description, asked);
    options.precision = asked.precision == "half" ? "float16" : asked.precision;
    if (isFilteredForm(options.form))
        return filteredMap(description, folder,
                           {.form = options.form,
                            .harmonics = asked.harmonics,
                            .error = asked.error.value_or(FilteredMapOptions{}.error),
                            .precision = options.precision,
                            .mips = options.mips,
                            .force = options.force,
                            .checks = static_cast<int>(options.checks)},
                           listener);
    options.memory = asked.memory << 20;
    if (options.form == "library") return librarySvbrdf(description, folder, options, listener);
    options.halfway = parseHalfway(asked.halfway);
    options.error = asked.error.value_or(options.error);
    return svbrdf(description, folder, options, listener);
}

}  // namespace hshfit::jobs
