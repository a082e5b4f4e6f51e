#include "export_viewer.h"

#include <jobs/source/source.h>
#include "export_loss.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/gpu/forms/viewer_form.h>
#include <hshfit/gpu/highlight.h>
#include <hshfit/gpu/viewer.h>
#include <hshfit/projection/one_basis.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <fmt/format.h>

#include <utility>

namespace hshfit::jobs {
namespace {

constexpr int texturesOrder = 7;

/// HSH textures as an export of the usual projection has them.
gpu::Payload texturesOf(const Brdf& brdf, const Listener& listener) {
    const auto basis = bases::make("hsh", texturesOrder);
    const OutgoingSet outgoing =
        brdf.laws().isotropic ? OutgoingSet::elevations(32) : OutgoingSet::parabolic(32, 32);
    const Projection projection =
        project(brdf, *basis, outgoing, {.progress = listener.part("viewer")});
    return gpu::pack(projection.coefficients, {});
}

std::string detailOf(std::size_t bytes, std::optional<double> meanLog) {
    if (!meanLog) return fmt::format("{} bytes; error not measured", bytes);
    return fmt::format("{} bytes; mean log error {:.2g}", bytes, *meanLog);
}

gpu::ViewerInput formInput(const Representation& stored, const Brdf* source,
                           const Listener& listener, const Exported& exported) {
    const auto again = reconstruct(exported.form->form, sourceOpener());
    const Brdf& shown = source ? *source : *again;
    gpu::ViewerInput input;
    input.title = stored.head.source.empty() ? "A form" : gpu::shownName(stored.head.source);
    input.form = gpu::viewerForm(*exported.form, exported.storage, gpu::highlightRoughness(shown));
    input.payloads.push_back(texturesOf(shown, listener));
    std::optional<double> form, textures;
    if (exported.error.loss) {
        form = exported.error.loss->exported;
        const auto textured =
            reconstruct(fromCoefficients(gpu::unpack(input.payloads[0])), sourceOpener());
        textures = exportLoss(shown, stored, *textured).exported;
    }
    input.details = {detailOf(stored.bytes(), form),
                     detailOf(input.payloads[0].coefficients.bytes.size(), textures)};
    if (source) {
        input.reference = gpu::tabulate(*source);
    } else {
        input.noReference = "The source does not open. The textures are a projection of the form.";
        input.details[1] += "; of the form, not of its source";
    }
    return input;
}

}  // namespace

void writeViewer(const Representation& stored, const Brdf* source,
                 const std::vector<LightSpecification>& lights, const ExportOptions& options,
                 const Listener& listener, FileSet& files, Exported& exported) {
    if (lights.empty()) return;
    gpu::ViewerInput input;
    std::string page;
    try {
        input = exported.form ? formInput(stored, source, listener, exported)
                              : gpu::viewerInput(exported.payload, source, listener.part("viewer"));
        for (const LightSpecification& light : lights)
            input.lights.push_back(gpu::viewerLight(light, input.environmentOrder));
        page = gpu::viewerPage(input);
    } catch (const UsageError& error) {
        if (options.targets != "all" || !exported.form) throw;
        listener.say(fmt::format("left out: {}", error.what()));
        return;
    }
    const std::string file = exported.name + "_viewer.html";
    files.write(file, page);
    exported.lights = std::move(input.lights);
    exported.texts.push_back({"viewer", "viewer", file});
}

}  // namespace hshfit::jobs
