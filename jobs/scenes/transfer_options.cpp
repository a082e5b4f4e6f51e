#include "transfer.h"

#include <jobs/common/enum_words.h>

namespace hshfit::jobs {
namespace {

using options::at;
using options::spelled;

constexpr EnumWord transferKinds[] = {{"unshadowed"}, {"shadowed"}, {"interreflected"}};
constexpr EnumWord transferSides[] = {{"automatic"}, {"front"}, {"both"}};
using Kinds = EnumWords<transferKinds, TransferKind>;
using MeshSides = EnumWords<transferSides, decltype(TransferMeshOptions::sides)>;

constexpr OptionRow transferRows[] = {
    OptionRow{"kind", spelled<Kinds::parse, Kinds::name, &TransferOptions::kind>,
              "Light past nothing, past shadows, or by other surfaces too; the simpler kinds are "
              "written as well"}
        .takes({.words = Kinds::words, .complete = true}),
    OptionRow{"passes", at<&TransferOptions::passes>, "Reflections at other surfaces"}.within(
        bounds::passes),
    OptionRow{"rays", at<&TransferOptions::rays>, "Rays of each vertex"}.within(
        bounds::transferRays),
    OptionRow{"order", at<&TransferOptions::order>, "Bands of light"}.within(bounds::transferOrder),
    OptionRow{"local-order", at<&TransferOptions::localOrder>,
              "Bands of hemispherical harmonics above each vertex: matrices, for glossy materials; "
              "0: vectors alone"}
        .within(bounds::localOrder),
    OptionRow{"clusters", at<&TransferOptions::clusters>,
              "Numbers of clusters to try for the matrices; 0: they are not compressed"}
        .within(bounds::clusters)
        .takes({.syntax = Syntax::list}),
    OptionRow{"components", at<&TransferOptions::components>, "The most components of a cluster"}
        .within(bounds::components),
    OptionRow{"error", at<&TransferOptions::error>,
              "Relative L2 error that compressed matrices may have; the smallest is written"}
        .within(bounds::clusterError),
    OptionRow{"bytes", at<&TransferOptions::bytes>,
              "Bytes that compressed matrices may take; the best is written"},
    OptionRow{"edge", at<&TransferOptions::mesh, &TransferMeshOptions::edge>,
              "The longest edge of a triangle; longer ones are halved; 0: none are (default: 1/32 "
              "of the scene's diagonal)"},
    OptionRow{"sides",
              spelled<MeshSides::parse, MeshSides::name, &TransferOptions::mesh,
                      &TransferMeshOptions::sides>,
              "Sides of surfaces with vertices; automatic: both of objects with open edges"}
        .takes({.words = MeshSides::words, .complete = true}),
    OptionRow{"seed", at<&TransferOptions::seed>, "Seed of the rays"},
    OptionRow{"memory", at<&TransferOptions::memory>, "The most memory that may be needed, MB"}
        .within(bounds::transferMemory),
    OptionRow{"light", at<&TransferOptions::lights>,
              "Lights of the pictures and the page beside the scene's"}
        .takes({.syntax = Syntax::light, .files = Files::read, .dash = ""})
        .inPython("lights"),
    OptionRow{"reference-samples", at<&TransferOptions::referenceSamples>,
              "Pictures by transfer and by this many paths a pixel, and their difference by order; "
              "0: none"}
        .within(bounds::referenceSamples),
    OptionRow{"material", at<&TransferOptions::swaps>,
              "BRDFs that the page can put in the place of the scene's"}
        .takes({.syntax = Syntax::brdf, .files = Files::read})
        .inPython("materials"),
    OptionRow{"camera", at<&TransferOptions::camera>, "Of the pictures (default: all)"},
    OptionRow{"resume", at<&TransferOptions::resume>,
              "Keep finished vertices and passes in OUTPUT/.hshfit-transfer.partial until all is "
              "written, and go on from those of a run that was stopped"},
    OptionRow{"seconds", at<&TransferOptions::seconds>,
              "Take only as many rays, passes and paths of pictures as fit into that time; the "
              "page and the clusters come on top (default: no end)"}
        .within(bounds::seconds)
        .notWith("resume"),
    OptionRow{"force", at<&TransferOptions::force>, "Replace existing files"},
};

}  // namespace

OptionRows<TransferOptions> transferOptions() {
    return {transferRows};
}

}  // namespace hshfit::jobs
