#include "exportable_map.h"

#include <jobs/maps/lobe_text.h>

#include <hshfit/error.h>
#include <hshfit/filtered_maps/exports/filtered_export.h>
#include <hshfit/filtered_maps/exports/filtered_sampler.h>
#include <hshfit/filtered_maps/exports/filtered_shader.h>
#include <hshfit/library_maps/exports/library_map_export.h>
#include <hshfit/material_maps/exports/map_viewer.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::jobs {
namespace {

class CoefficientMap final : public ExportableMap {
public:
    CoefficientMap(const std::string& path, Wrap wrap) : map_(path), wrap_(wrap) {
        if (map_.sidecar().form != "halfway") return;
        throw UsageError(
            fmt::format("{}: the form halfway of maps has no shader; its materials are "
                        "exported one by one, as {} is, or the map in another form, as clusters",
                        path, materialOf(map_.sidecar())));
    }

    Facts facts() const override {
        const MapSidecar& s = map_.sidecar();
        return {.source = s.source,
                .form = s.form,
                .basis = s.basis,
                .outgoing = s.layout.outgoing.spec(),
                .order = s.order,
                .levels = s.levels,
                .layers = s.layers(),
                .number = s.number};
    }
    std::vector<MapTest> tests() const override { return mapTests(map_, wrap_); }
    std::vector<MapTextureFile> writeKtx2(const std::string& name, FileSet& files) const override {
        return writeMapKtx2(map_, name, files);
    }
    std::vector<MapTextureFile> writeExr(const std::string& name, FileSet& files) const override {
        return writeMapExr(map_, name, files);
    }
    std::string shader(gpu::Language language, const std::string& prefix,
                       int environmentOrder) const override {
        return mapShader(language, map_.sidecar(),
                         {.prefix = prefix, .environmentOrder = environmentOrder, .wrap = wrap_});
    }
    std::string viewer(const std::string& title, const std::vector<gpu::ViewerLight>& lights,
                       int order, std::span<const MapTest> tests) const override {
        return mapViewerPage({.map = map_,
                              .wrap = wrap_,
                              .title = title,
                              .lights = lights,
                              .order = order,
                              .tests = tests});
    }
    std::string sidecar(std::span<const MapTextureFile> textures,
                        std::span<const MapTest> tests) const override {
        return mapExportText(map_, wrap_, textures, tests);
    }
    std::string testText(std::span<const MapTest> tests) const override {
        return mapTestText(map_.sidecar(), tests);
    }
    void checkIntact() const override { map_.checkIntact(); }

private:
    /// The file of a material of the form halfway.
    static std::string materialOf(const MapSidecar& map) {
        const auto first =
            std::ranges::find_if(map.files, [](const auto& f) { return !f.empty(); });
        return first == map.files.end() ? std::string() : *first;
    }

    MaterialMap map_;
    Wrap wrap_;
};

class MapInLibrary final : public ExportableMap {
public:
    MapInLibrary(const std::string& path, Wrap wrap)
        : map_(path), wrap_(wrap), functions_(tabledFunctions(map_)) {}

    Facts facts() const override {
        const LibrarySidecar& s = map_.sidecar();
        return {.source = s.source,
                .form = "library",
                .levels = s.levels,
                .layers = s.layout.layers(),
                .number = s.number,
                .components = s.layout.components,
                .tableError = functions_.error.largest};
    }
    std::vector<MapTest> tests() const override {
        return mapTests(map_.sidecar().levels,
                        [&](const MapPlace& place, const Direction& wo, const Direction& wi) {
                            return mapValue(map_, functions_, place, wrap_, wo, wi);
                        });
    }
    std::vector<MapTextureFile> writeKtx2(const std::string& name, FileSet& files) const override {
        return writeLibraryMapKtx2(map_, functions_, name, files);
    }
    std::vector<MapTextureFile> writeExr(const std::string& name, FileSet& files) const override {
        return writeLibraryMapExr(map_, functions_, name, files);
    }
    std::vector<MapTextureFile> writeOthers(const std::string& name,
                                            FileSet& files) const override {
        return {writeMapLibrary(map_, name, files)};
    }
    std::string shader(gpu::Language language, const std::string& prefix, int) const override {
        return libraryMapShader(language, map_, functions_, {.prefix = prefix, .wrap = wrap_});
    }
    bool takesLight() const override { return false; }
    std::string viewer(const std::string& title, const std::vector<gpu::ViewerLight>&, int,
                       std::span<const MapTest> tests) const override {
        return libraryMapViewerPage(map_, functions_, wrap_, title, tests);
    }
    std::string sidecar(std::span<const MapTextureFile> textures,
                        std::span<const MapTest> tests) const override {
        return libraryMapExportText(map_, functions_, wrap_, textures, tests);
    }
    std::string testText(std::span<const MapTest> tests) const override {
        return mapTestText(map_.sidecar().channels, "f in 1/sr", tests);
    }
    void checkIntact() const override { map_.checkIntact(); }

private:
    LibraryMap map_;
    Wrap wrap_;
    MapFunctions functions_;
};

class LobeMap final : public ExportableMap {
public:
    LobeMap(const std::string& path, Wrap wrap)
        : map_(path),
          wrap_(wrap),
          lobes_(map_.sidecar().model, map_.sidecar().nodes, path),
          text_(lobeText(lobes_, path)) {
        lobes_.checkTerms(map_.sidecar().terms.size(), path);
    }

    Facts facts() const override {
        const FilteredSidecar& s = map_.sidecar();
        return {.source = s.source,
                .form = s.form,
                .model = s.model,
                .order = s.form == "harmonics" ? s.layout.order : 0,
                .levels = s.levels,
                .layers = s.layers(),
                .number = s.number};
    }
    std::vector<MapTest> tests() const override {
        const FilteredSidecar& s = map_.sidecar();
        const int order = s.form == "harmonics" ? s.layout.order : 3;
        return FilteredSampler(map_, lobes_.surface(s.terms, s.channels.count(), s.layout.albedos),
                               lobes_.table(order), wrap_)
            .tests();
    }
    std::vector<MapTextureFile> writeKtx2(const std::string& name, FileSet& files) const override {
        return writeFilteredKtx2(map_, name, files);
    }
    std::vector<MapTextureFile> writeExr(const std::string& name, FileSet& files) const override {
        return writeFilteredExr(map_, name, files);
    }
    std::vector<OrdinaryMips> writeMips(const std::string& name, FileSet& files) const override {
        return writeOrdinaryMips(map_, name, files);
    }
    std::string shader(gpu::Language language, const std::string& prefix, int) const override {
        return filteredShader(language, map_.sidecar(), text_, {.prefix = prefix, .wrap = wrap_});
    }
    bool takesLight() const override { return false; }
    std::string viewer(const std::string& title, const std::vector<gpu::ViewerLight>&, int,
                       std::span<const MapTest> tests) const override {
        return filteredViewerPage(map_, text_, wrap_, title, tests);
    }
    std::string sidecar(std::span<const MapTextureFile> textures,
                        std::span<const MapTest> tests) const override {
        return filteredExportText(map_, wrap_, textures, tests);
    }
    std::string testText(std::span<const MapTest> tests) const override {
        return mapTestText(map_.sidecar().channels, "f cos(theta_i) in 1/sr", tests);
    }
    void checkIntact() const override { map_.checkIntact(); }

private:
    FilteredMap map_;
    Wrap wrap_;
    FacetLobes lobes_;
    LobeText text_;
};

}  // namespace

std::vector<MapTextureFile> ExportableMap::writeOthers(const std::string&, FileSet&) const {
    return {};
}

std::vector<OrdinaryMips> ExportableMap::writeMips(const std::string& name, FileSet&) const {
    throw UsageError(fmt::format(
        "{}: the target mips is of maps of normals or directions, as svbrdf filters them", name));
}

std::unique_ptr<ExportableMap> openExportable(const std::string& sidecar, Wrap wrap) {
    if (isLibrarySidecar(sidecar)) return std::make_unique<MapInLibrary>(sidecar, wrap);
    if (isFilteredSidecar(sidecar)) return std::make_unique<LobeMap>(sidecar, wrap);
    return std::make_unique<CoefficientMap>(sidecar, wrap);
}

}  // namespace hshfit::jobs
