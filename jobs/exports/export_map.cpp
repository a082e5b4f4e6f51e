#include "export_map.h"

#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/light/catalog.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace hshfit::jobs {
namespace {

using gpu::Target;

/// The export of one map, target by target.
class MapExport {
public:
    MapExport(const std::string& path, const std::string& folder, const MapExportOptions& options,
              const Listener& listener)
        : options_(options),
          listener_(listener),
          wrap_(parseWrap(options.wrap)),
          chosen_(gpu::selectTargets(options.targets)),
          map_(openExportable(path, wrap_)),
          lights_(lightsOf()),
          files_(folder, options.force) {
        result_.name =
            options.name.empty() ? std::filesystem::path(path).stem().string() : options.name;
        result_.sidecar = result_.name + ".hsh.json";
        result_.test = result_.name + "_test.json";
        result_.map = map_->facts();
        for (const std::string& name : {result_.sidecar, result_.test}) files_.requireFree(name);
    }

    ExportedMap run() {
        tests_ = map_->tests();
        // A module brings containers along: its own name belongs into the message.
        std::ranges::stable_sort(chosen_, {}, [](const Target* target) {
            return target->kind == Target::Kind::module ? 0 : 1;
        });
        for (const Target* target : chosen_) {
            try {
                write(*target);
            } catch (const UsageError& error) {
                if (options_.targets != "all") throw;
                listener_.say(fmt::format("left out: {}", error.what()));
            }
        }
        if (!result_.textures.empty()) {
            const auto others = map_->writeOthers(result_.name, files_);
            result_.textures.insert(result_.textures.end(), others.begin(), others.end());
        }
        files_.write(result_.sidecar, map_->sidecar(result_.textures, tests_));
        files_.write(result_.test, map_->testText(tests_));
        map_->checkIntact();
        files_.commit();
        return std::move(result_);
    }

private:
    bool hasViewer() const {
        return std::ranges::any_of(
            chosen_, [](const Target* target) { return target->kind == Target::Kind::viewer; });
    }

    /// Early, so that a wrong light costs no work.
    std::vector<LightSpecification> lightsOf() const {
        if (!hasViewer() && !options_.lights.empty()) {
            throw UsageError(fmt::format("{} is for the target viewer, which is not among '{}'",
                                         Setting{"ExportOptions::lights"}, options_.targets));
        }
        std::vector<LightSpecification> lights;
        if (!map_->takesLight()) {
            if (options_.lights.empty()) return lights;
            throw UsageError(fmt::format("{}: a map of this form takes no light of an environment",
                                         Setting{"ExportOptions::lights"}));
        }
        for (const std::string& text : options_.lights) lights.push_back(parseLights(text));
        if (lights.empty() && hasViewer())
            lights.push_back(parseLights(std::string(studioKind().name)));
        return lights;
    }

    void write(const Target& target) {
        switch (target.kind) {
            case Target::Kind::container:
                return writeTextures(target.name);
            case Target::Kind::shader:
                return writeShader(target.name);
            case Target::Kind::viewer:
                return writeViewer();
            case Target::Kind::mips:
                return writeMips();
            case Target::Kind::renderer:
            case Target::Kind::material:
            case Target::Kind::module:
            case Target::Kind::binary:
                break;
        }
        throw UsageError(fmt::format("the target {} does not take maps of materials", target.name));
    }

    void writeTextures(const std::string& container) {
        if (container != "ktx2" && container != "exr-parts") {
            throw UsageError(fmt::format(
                "{} has no levels: maps of materials are written as ktx2, or exr-parts for OSL",
                container));
        }
        const auto made = container == "ktx2" ? map_->writeKtx2(result_.name, files_)
                                              : map_->writeExr(result_.name, files_);
        result_.textures.insert(result_.textures.end(), made.begin(), made.end());
    }

    void writeMips() {
        for (const OrdinaryMips& made : map_->writeMips(result_.name, files_)) {
            const bool normal = made.role == "normal";
            const double unit = normal ? degrees(1.0) : 1;
            listener_.say(fmt::format(
                "{}: {} bytes, {} by compression {:.3g} in the mean, {:.3g} at most{}", made.path,
                made.bytes, normal ? "degrees" : "error", unit * made.meanError,
                unit * made.largestError, normal ? "" : ", from 0 to 1"));
            result_.texts.push_back({made.role, "mips", made.path});
        }
    }

    void writeShader(const std::string& name) {
        const auto& entry = *std::ranges::find(gpu::languages(), name, &gpu::LanguageEntry::name);
        const std::string text =
            map_->shader(entry.language, options_.prefix, options_.environmentOrder);
        const std::string file = gpu::shaderFileName(result_.name, entry, options_.prefix);
        files_.write(
            file, gpu::fileText(entry.language, text, std::filesystem::path(file).stem().string()));
        result_.texts.push_back({"shader", name, file});
    }

    void writeViewer() {
        // The light of a page is as its shader takes it.
        const int order = std::max(options_.environmentOrder, 1);
        std::vector<gpu::ViewerLight> lights;
        for (const LightSpecification& light : lights_)
            lights.push_back(gpu::viewerLight(light, order));
        const std::string source = result_.map.source;
        const std::string page = map_->viewer(
            source.empty() ? result_.name : std::filesystem::path(source).stem().string(), lights,
            order, tests_);
        const std::string file = result_.name + "_viewer.html";
        files_.write(file, page);
        result_.lights = std::move(lights);
        result_.texts.push_back({"viewer", "viewer", file});
    }

    const MapExportOptions& options_;
    const Listener& listener_;
    Wrap wrap_;
    std::vector<const Target*> chosen_;
    std::unique_ptr<ExportableMap> map_;
    std::vector<LightSpecification> lights_;
    FileSet files_;
    std::vector<MapTest> tests_;
    ExportedMap result_;
};

}  // namespace

ExportedMap exportMap(const std::string& map, const std::string& folder,
                      const MapExportOptions& options, const Listener& listener) {
    return MapExport(map, folder, options, listener).run();
}

}  // namespace hshfit::jobs
