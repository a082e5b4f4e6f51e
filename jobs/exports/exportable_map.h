#pragma once

#include <hshfit/filtered_maps/exports/ordinary_mips.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/gpu/viewer_light.h>
#include <hshfit/material_maps/exports/map_export.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// A map of `svbrdf` as the exports take it.
class ExportableMap {
public:
    virtual ~ExportableMap() = default;

    /// The map in an answer; `order` is of its basis or its harmonics. Maps of coefficients
    /// have a basis and outgoing directions, others a model.
    struct Facts {
        std::string source, form, basis = {}, outgoing = {}, model = {};
        int order = 0;
        std::vector<LevelSize> levels = {};
        std::size_t layers = 0;
        gpu::Number number = gpu::Number::float16;
        std::size_t components = 0;  ///< of a library
        double tableError = 0;       ///< the largest of ln(f + 0.001) by the table of its functions
    };
    virtual Facts facts() const = 0;
    virtual std::vector<MapTest> tests() const = 0;
    virtual std::vector<MapTextureFile> writeKtx2(const std::string& name,
                                                  FileSet& files) const = 0;
    virtual std::vector<MapTextureFile> writeExr(const std::string& name, FileSet& files) const = 0;
    /// Files that go with textures of either kind.
    virtual std::vector<MapTextureFile> writeOthers(const std::string& name, FileSet& files) const;
    /// Mips for an engine's own material. Throws UsageError for maps without normals.
    virtual std::vector<OrdinaryMips> writeMips(const std::string& name, FileSet& files) const;
    virtual std::string shader(gpu::Language language, const std::string& prefix,
                               int environmentOrder) const = 0;
    /// Whether shaders and the page take the light of an environment.
    virtual bool takesLight() const { return true; }
    /// The page, with lights of `order` bands.
    virtual std::string viewer(const std::string& title,
                               const std::vector<gpu::ViewerLight>& lights, int order,
                               std::span<const MapTest> tests) const = 0;
    virtual std::string sidecar(std::span<const MapTextureFile> textures,
                                std::span<const MapTest> tests) const = 0;
    virtual std::string testText(std::span<const MapTest> tests) const = 0;
    virtual void checkIntact() const = 0;
};

/// Opens a map of coefficients, of filtered lobes or of coordinates in a library. Throws UsageError
/// for a form without a shader and InputError.
std::unique_ptr<ExportableMap> openExportable(const std::string& sidecar, Wrap wrap);

}  // namespace hshfit::jobs
