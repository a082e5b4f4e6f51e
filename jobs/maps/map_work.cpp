#include "map_work.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/version.h>

#include <fmt/format.h>

namespace hshfit::jobs {
namespace {

TexelLayout layoutFor(const SvbrdfOptions& options, const ModelLobes& lobes, const Basis& basis) {
    const Laws& laws = lobes.laws();
    OutgoingSet outgoing = !options.outgoing.empty() ? OutgoingSet::parse(options.outgoing)
                           : laws.isotropic          ? OutgoingSet::elevations(8)
                                                     : OutgoingSet::parabolic(8, 8);
    if (outgoing.map == OutgoingSet::Map::elevations && !laws.isotropic) {
        throw UsageError(
            "the texels are anisotropic; their outgoing directions need a map, such as 8x8");
    }
    return texelLayout(basis, outgoing, lobes.channels(), laws.mirrorSymmetric);
}

const MaterialDescription& inOneFrame(const MaterialDescription& described) {
    requireOneFrame(described);
    return described;
}

Quantity quantityOf(const SvbrdfOptions& options) {
    return options.cosine ? Quantity::brdfCosine : Quantity::brdf;
}

}  // namespace

void requireOneFrame(const MaterialDescription& described) {
    if (!described.normal && !described.direction) return;
    throw UsageError(
        fmt::format("{}: turns its texels by \"{}\"; the form has to be filtered, "
                    "ellipse or harmonics",
                    described.file, described.normal ? "normal" : "direction"));
}

ModelTexels::ModelTexels(const MaterialDescription& described, const Basis& basis,
                         const SvbrdfOptions& options, Processes& processes,
                         const Listener& listener)
    : maps(inOneFrame(described), processes, listener),
      lobes(maps, described.file),
      layout(layoutFor(options, lobes, basis)),
      table(lobes.function(layout, basis, {.quantity = quantityOf(options)}, least),
            {.tolerance = options.tolerance, .progress = listener.part("lobes")}),
      rows(maps, lobes),
      texels(rows, table, layout, lobes.axesByChannel()),
      kernel(table, layout, lobes.axesByChannel()) {}

MapWork::MapWork(const std::string& description, const SvbrdfOptions& options, Processes& processes,
                 const Listener& listener)
    : time(options.seconds),
      described(readMaterialDescription(description)),
      basis(bases::make(options.basis, options.order)),
      model(described.texels.empty()
                ? std::make_unique<ModelTexels>(described, *basis, options, processes, listener)
                : nullptr),
      measured(model ? nullptr
                     : std::make_unique<MeasuredTexels>(
                           described.texels, *basis,
                           MeasuredTexels::Options{.outgoing = options.outgoing,
                                                   .quantity = quantityOf(options),
                                                   .isotropic = described.isotropic},
                           listener)),
      texels(model ? static_cast<TexelSource&>(model->texels) : *measured),
      layout(texels.layout()),
      laws(model ? model->lobes.laws() : measured->laws()) {}

MapSidecar MapWork::head(const SvbrdfOptions& options, const std::vector<LevelSize>& levels) const {
    return {.form = "outgoing",
            .texture = textureName,
            .basis = options.basis,
            .order = options.order,
            .quantity = quantityOf(options),
            .channels = layout.channels == 1 ? Channels::grey() : Channels::rgb(),
            .layout = layout,
            .isotropic = laws.isotropic,
            .bilateral = laws.mirrorSymmetric,
            .levels = levels,
            .source = described.file,
            .generator = std::string("hshfit ") + version};
}

}  // namespace hshfit::jobs
