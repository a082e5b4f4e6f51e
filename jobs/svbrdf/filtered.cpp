#include "filtered.h"

#include "facet_surface.h"
#include "filter_checks.h"

#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/filtered_maps/filtered_map.h>
#include <hshfit/filtered_maps/filtered_map_writer.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

namespace hshfit::jobs {
namespace {

using Clock = std::chrono::steady_clock;
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
void gather(FacetSurface& surface, const ParameterMaps& maps,
            std::shared_ptr<const LobeTable> table, const MipLayout& layout, bool filter,
            FilterChecks& checks, const Listener& listener) {
    std::optional<MipFilter> filtered;
    if (filter) {
        filtered.emplace(maps.width(), maps.height(), std::move(table), layout,
                         [&](const MipRow& row) { checks.addFiltered(row, layout); });
    }
    const auto progress = listener.part("gathering texels");
    for (std::size_t y = 0; y < maps.height(); ++y) {
        const std::vector<SurfaceTexel> row = surface.row(y);
        checks.add(row);
        if (filtered) filtered->add(row);
        if (progress) progress(y + 1, maps.height());
    }
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
void writeLevels(FacetSurface& surface, const ParameterMaps& maps,
                 const std::shared_ptr<const LobeTable>& table, const FilteredSidecar& sidecar,
                 FilteredMapWriter& writer, const Listener& listener) {
    std::optional<MipFilter> filter;
    if (sidecar.levels.size() > 1) {
        filter.emplace(maps.width(), maps.height(), table, sidecar.layout, [&](const MipRow& row) {
            writer.write(static_cast<std::size_t>(row.level), row.y, row.texels);
        });
    }
    const auto progress = listener.part("texels");
    for (std::size_t y = 0; y < maps.height(); ++y) {
        const std::vector<SurfaceTexel> row = surface.row(y);
        writer.write(0, y, ellipseNumbers(row, *table, sidecar.layout));
        if (filter) filter->add(row);
        if (progress) progress(y + 1, maps.height());
    }
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
    const MaterialDescription described = readMaterialDescription(description);
    Processes alone;
    ParameterMaps maps(described, alone, listener);
    FacetSurface surface(maps, description, listener);
    const std::vector<LevelSize> sizes = sizesOf(maps.width(), maps.height(), options.mips);
    if (options.form == "harmonics" && sizes.size() == 1)
        throw UsageError("harmonics begin at level 1; a map of one level is an ellipse");
    FilteredMapAnswer answer{.description = description,
                             .model = described.model,
                             .folder = folder,
                             .width = maps.width(),
                             .height = maps.height(),
                             .renormalised = maps.turns().renormalised(),
                             .form = options.form == "harmonics" ? "harmonics" : "ellipse",
                             .order = options.form == "harmonics" ? options.harmonics : 0,
                             .weights = static_cast<std::size_t>(surface.weights()),
                             .albedos = static_cast<std::size_t>(surface.albedos())};
    if (answer.renormalised > 0) {
        listener.say(
            fmt::format("{} normals of {} had a length that is off by more than 5 % and "
                        "were renormalised",
                        answer.renormalised, maps.width() * maps.height()));
    }
    answer.nodeError = surface.nodeError();
    for (const LobeNodes& nodes : surface.lobes().nodes()) {
        answer.parameters.push_back(nodes.name);
        answer.nodes *= nodes.values.size();
    }
    const bool open = isOpen(options, sizes.size());
    const std::vector<int> orders = ordersFor(options);
    const int most = orders.empty() ? 3 : std::max(3, *std::ranges::max_element(orders));
    const std::shared_ptr<const LobeTable> table = surface.lobes().table(most);
    // A form is chosen by measurement, also where none is asked for.
    constexpr int leastTexels = 8;
    FilterChecks checks(maps.width(), maps.height(), sizes,
                        open ? std::max(options.checks, leastTexels) : options.checks);
    if (open || options.checks > 0) {
        gather(surface, maps, table, {surface.weights(), surface.albedos(), most}, open, checks,
               listener);
    }
    if (open) {
        chooseForm(surface, *table, {surface.weights(), surface.albedos(), most}, options, checks,
                   answer, listener);
    }

    FileSet files(folder, options.force);
    files.removeOthers();
    for (const char* name : {textureName, harmonicsName, sidecarName, pictureName})
        if (name != harmonicsName || answer.form == "harmonics") files.requireFree(name);
    const FilteredSidecar sidecar =
        sidecarOf(surface, *table, options, described.file, answer, sizes);
    answer.numbers = sidecar.layout.size();
    if (answer.form == "ellipse") answer.numbers = sidecar.layout.ellipseSize();
    const std::string texture = files.add(textureName).temporaryPath();
    const std::string harmonics =
        answer.form == "harmonics" ? files.add(harmonicsName).temporaryPath() : "";
    const auto start = Clock::now();
    FilteredMapWriter writer(sidecar, texture, harmonics);
    writeLevels(surface, maps, table, sidecar, writer, listener);
    answer.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    answer.rate = static_cast<double>(maps.width() * maps.height()) / answer.seconds;
    answer.bytes = writer.bytes();
    maps.checkIntact();
    files.write(sidecarName, toText(sidecar));
    for (const LevelSize& size : sizes) answer.levels.push_back({.size = size});
    std::vector<const char*> names{textureName, sidecarName};
    if (answer.form == "harmonics") names.push_back(harmonicsName);
    if (options.checks > 0 && sizes.size() > 1) {
        FilteredSidecar written = sidecar;
        written.texture = texture;
        written.harmonics = harmonics;
        const FilteredMap map(written, (files.folder() / sidecarName).string());
        checks.measure(surface.reflectance(), *table, map, answer.levels, listener);
        files.write(pictureName, checks.picture(surface.reflectance(), *table, map));
        names.push_back(pictureName);
    }
    files.commit();
    for (const char* name : names)
        answer.files.push_back((std::filesystem::path(folder) / name).string());
    return answer;
}

}  // namespace hshfit::jobs
