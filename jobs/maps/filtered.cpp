#include "filtered.h"

#include <jobs/common/clock.h>

#include "facet_surface.h"
#include "filter_checks.h"
#include "level_pass.h"
#include "map_files.h"
#include "map_processes.h"

#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/filtered_maps/filtered_map.h>
#include <hshfit/filtered_maps/filtered_map_writer.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

namespace hshfit::jobs {
namespace {

constexpr const char* textureName = "material.ktx2";
constexpr const char* harmonicsName = "harmonics.ktx2";
constexpr const char* sidecarName = "material.json";
constexpr const char* pictureName = "errors.png";
constexpr int candidateOrders[] = {9, 17, 33};

std::vector<LevelSize> sizesOf(std::size_t width, std::size_t height, bool mips) {
    std::vector<LevelSize> sizes;
    for (int level = 0; level <= (mips ? mipLevels(width, height) : 0); ++level)
        sizes.push_back({mipSize(width, level), mipSize(height, level)});
    return sizes;
}

std::vector<int> ordersFor(const FilteredMapOptions& options) {
    if (options.form == "ellipse") return {};
    if (options.harmonics > 0) return {options.harmonics};
    return {std::begin(candidateOrders), std::end(candidateOrders)};
}

/// Whether the form has to be chosen by measurement.
bool isOpen(const FilteredMapOptions& options, std::size_t levels) {
    return levels > 1 &&
           (options.form == "filtered" || (options.form == "harmonics" && options.harmonics == 0));
}

/// Reads all rows once, for what is measured, and filters them where the form is open.
void gather(const LevelPass& pass, const MipLayout& layout, bool filter, FilterChecks& checks,
            const Listener& listener) {
    LevelSinks sinks{.base = [&](std::size_t y, auto row) { checks.add(y, row); },
                     .taken = [&](const MipPart& part) { return checks.taken(part); },
                     .put = [&](const MipPart& part, auto numbers) { checks.put(part, numbers); }};
    if (filter) sinks.level = [&](const MipRow& row) { checks.addFiltered(row, layout); };
    pass.run(layout, sinks, listener.part("gathering texels"));
    checks.finish();
}

void chooseForm(const FacetSurface& surface, const LobeTable& table, const MipLayout& layout,
                const FilteredMapOptions& options, const FilterChecks& checks,
                FilteredMapAnswer& answer, const Listener& listener) {
    const double bytes = options.precision == "float32" ? 4 : 2;
    std::vector<WorstOfForm> places;
    const MipErrors worst =
        checks.worst(surface.reflectance(), layout, table, ordersFor(options), places, listener);
    MipErrors possible;
    for (std::size_t k = 0; k < worst.forms.size(); ++k) {
        const MipError& form = worst.forms[k];
        if (form.form == "parameters") continue;
        // Each of the two textures has layers of four numbers.
        const auto padded = [](std::size_t count) { return (count + 3) / 4 * 4; };
        const std::size_t ellipse = std::min(form.numbers, layout.ellipseSize());
        const std::size_t stored = padded(ellipse) + padded(form.numbers - ellipse);
        answer.choices.push_back({.form = form.form,
                                  .order = form.use.order,
                                  .numbers = form.numbers,
                                  .bytesOfTexel = bytes * static_cast<double>(stored),
                                  .error = form.relative,
                                  .level = places[k].level,
                                  .maximum = places[k].texel,
                                  .maximumLevel = places[k].texelLevel,
                                  .column = places[k].column,
                                  .row = places[k].row});
        if (options.form == "filtered" || options.form == form.form) possible.forms.push_back(form);
    }
    const MipError& chosen = cheapestForm(possible, options.error);
    answer.form = chosen.form;
    answer.order = chosen.use.order;
}

FilteredSidecar sidecarOf(const FacetSurface& surface, const LobeTable& table,
                          const FilteredMapOptions& options, const std::string& source,
                          const FilteredMapAnswer& answer, const std::vector<LevelSize>& sizes) {
    const bool harmonics = answer.form == "harmonics";
    return {.form = answer.form,
            .layout = {surface.weights(), surface.albedos(), harmonics ? answer.order : 1},
            .model = surface.lobes().model(),
            .nodes = surface.lobes().nodes(),
            .terms = surface.terms(),
            .channels = surface.channels() == 1 ? Channels::grey() : Channels::rgb(),
            .number = gpu::parseNumber(options.precision),
            .texture = textureName,
            .harmonics = harmonics ? harmonicsName : "",
            .levels = sizes,
            .lobes = surface.lobes().stored(table),
            .source = source,
            .generator = std::string("hshfit ") + version};
}

/// All levels, a row at a time.
void writeLevels(const LevelPass& pass, const LobeTable& table, const FilteredSidecar& sidecar,
                 FilteredMapWriter& writer, const Listener& listener) {
    LevelSinks sinks{.base = [&](std::size_t y, auto row) {
        writer.write(0, y, ellipseNumbers(row, table, sidecar.layout));
    }};
    if (sidecar.levels.size() > 1) {
        sinks.level = [&](const MipRow& row) {
            writer.write(static_cast<std::size_t>(row.level), row.y, row.texels);
        };
    }
    pass.run(sidecar.layout, sinks, listener.part("texels"));
}

/// Before long work is done for nothing.
void requireFree(const std::string& folder, const FilteredMapOptions& options,
                 const Processes& processes) {
    if (!processes.isFirst()) return;
    const FileSet files(folder, options.force);  // the folder goes again
    for (const char* name : {textureName, sidecarName, pictureName}) files.requireFree(name);
    if (options.form != "ellipse") files.requireFree(harmonicsName);
}

/// The answer before anything is measured.
FilteredMapAnswer answerOf(const std::string& description, const MaterialDescription& described,
                           const std::string& folder, const FilteredMapOptions& options,
                           const ParameterMaps& maps, const FacetSurface& surface) {
    FilteredMapAnswer answer{.description = description,
                             .model = described.model,
                             .folder = folder,
                             .width = maps.width(),
                             .height = maps.height(),
                             .renormalised = maps.renormalised(),
                             .nodeError = surface.nodeError(),
                             .form = options.form == "harmonics" ? "harmonics" : "ellipse",
                             .order = options.form == "harmonics" ? options.harmonics : 0,
                             .weights = static_cast<std::size_t>(surface.weights()),
                             .albedos = static_cast<std::size_t>(surface.albedos()),
                             .processes = processesOfMaps().count()};
    for (const LobeNodes& nodes : surface.lobes().nodes()) {
        answer.parameters.push_back(nodes.name);
        answer.nodes *= nodes.values.size();
    }
    return answer;
}

/// Writes the textures under temporary names, measures them, and puts all files in place.
void write(const LevelPass& pass, FacetSurface& surface, const LobeTable& table,
           FilteredSidecar sidecar, const FilteredMapOptions& options, FilterChecks& checks,
           FilteredMapAnswer& answer, const Listener& listener) {
    Processes& processes = processesOfMaps();
    MapFiles files(answer.folder, options.force, processes);
    files.requireFree({textureName, sidecarName, pictureName});
    const std::string texture = files.texture(textureName);
    const std::string harmonics = sidecar.harmonics.empty() ? "" : files.texture(sidecar.harmonics);
    const auto start = Clock::now();
    FilteredMapWriter writer(sidecar, texture, harmonics);
    if (processes.isFirst()) writer.begin();
    writeLevels(pass, table, sidecar, writer, listener);
    answer.seconds = secondsSince(start);
    answer.rate = static_cast<double>(answer.width * answer.height) / answer.seconds;
    answer.bytes = writer.bytes();
    files.write(sidecarName, toText(sidecar));
    for (const LevelSize& level : sidecar.levels) answer.levels.push_back({.size = level});
    if (options.checks > 0 && sidecar.levels.size() > 1) {
        sidecar.texture = texture;
        sidecar.harmonics = harmonics;
        const std::filesystem::path folder(answer.folder);
        const FilteredMap map(sidecar, (folder / sidecarName).string());
        checks.measure(surface.reflectance(), table, map, answer.levels, listener);
        files.write(pictureName, checks.picture(surface.reflectance(), table, map));
    }
    for (const std::string& name : files.commit())
        answer.files.push_back((std::filesystem::path(answer.folder) / name).string());
}

FilteredMapAnswer made(const std::string& description, const std::string& folder,
                       const FilteredMapOptions& options, const Listener& listener) {
    Processes& processes = processesOfMaps();
    requireFree(folder, options, processes);
    const MaterialDescription described = readMaterialDescription(description);
    ParameterMaps maps(described, processes, listener);
    FacetSurface surface(maps, description, processes, listener);
    const LevelSize size{maps.width(), maps.height()};
    const std::vector<LevelSize> sizes = sizesOf(size.width, size.height, options.mips);
    if (options.form == "harmonics" && sizes.size() == 1)
        throw UsageError("harmonics begin at level 1; a map of one level is an ellipse");
    FilteredMapAnswer answer = answerOf(description, described, folder, options, maps, surface);
    if (answer.renormalised > 0) {
        listener.say(
            fmt::format("{} normals of {} had a length that is off by more than 5 % and "
                        "were renormalised",
                        answer.renormalised, size.width * size.height));
    }
    const bool open = isOpen(options, sizes.size());
    const std::vector<int> orders = ordersFor(options);
    const int most = orders.empty() ? 3 : std::max(3, *std::ranges::max_element(orders));
    const std::shared_ptr<const LobeTable> table = surface.lobes().table(most);
    const LevelPass pass(surface, size, table, processes);
    const MipLayout layout{surface.weights(), surface.albedos(), most};
    // A form is chosen by measurement, also where none is asked for.
    constexpr int leastTexels = 8;
    FilterChecks checks(size.width, size.height, sizes,
                        open ? std::max(options.checks, leastTexels) : options.checks, processes);
    if (open || options.checks > 0) gather(pass, layout, open, checks, listener);
    if (open) chooseForm(surface, *table, layout, options, checks, answer, listener);
    FilteredSidecar sidecar = sidecarOf(surface, *table, options, described.file, answer, sizes);
    answer.numbers =
        answer.form == "ellipse" ? sidecar.layout.ellipseSize() : sidecar.layout.size();
    write(pass, surface, *table, std::move(sidecar), options, checks, answer, listener);
    maps.checkIntact();
    return answer;
}

}  // namespace

bool turnsTexels(const std::string& description) {
    const MaterialDescription described = readMaterialDescription(description);
    return described.normal.has_value() || described.direction.has_value();
}

bool isFilteredForm(std::string_view form) {
    const auto filtered = std::span(mapForms).last(3);
    return std::ranges::find(filtered, form) != filtered.end();
}

FilteredMapAnswer filteredMap(const std::string& description, const std::string& folder,
                              const FilteredMapOptions& options, const Listener& listener) {
    if (options.harmonics > 0 && options.harmonics % 2 == 0)
        throw UsageError("the order of harmonics has to be odd: D is even");
    return together([&] { return made(description, folder, options, listener); });
}

}  // namespace hshfit::jobs
