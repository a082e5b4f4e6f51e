#include "command.h"
#include "within.h"

#include <hshfit/percent.h>

#include <jobs/scenes/transfer.h>
#include <jobs/source/quality.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace hshfit::cli {
namespace {

const std::vector<std::string> kindNames(jobs::transferKinds.begin(), jobs::transferKinds.end());
const std::vector<std::string> sidesNames(jobs::transferSides.begin(), jobs::transferSides.end());

template <class Enumeration>
Enumeration numbered(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<Enumeration>(std::ranges::find(names, name) - names.begin());
}

struct TransferArguments {
    std::string scene, output, kind = "interreflected", sides = "automatic";
    double edge = 0, memory = 1e-6 * static_cast<double>(jobs::defaultTransferMemory);
    jobs::TransferOptions options;
};

std::string textOf(const jobs::Transferred& done) {
    std::string text =
        fmt::format("{}: {} vertices, {} triangles\n", done.scene, done.vertices, done.triangles);
    if (done.rays > 0) {
        text += fmt::format(
            "  {} rays a vertex, {:.3g} a second, {:.0f} % of the processor time in Embree; {} "
            "buried vertices\n  noise of the vectors {}, at most {} at vertex {}\n",
            done.options.rays, jobs::raysPerSecond(done), 100 * done.embreeShare, done.buried,
            percent(done.noise, 2), percent(done.largestNoise, 2), done.noisiest);
    }
    if (!done.energy.empty()) {
        text += "  energy by pass:";
        for (const double energy : done.energy) text += fmt::format(" {:.4g}", energy);
        text += "\n";
    }
    text += fmt::format("  {} bytes of vectors, {} of matrices; at most {:.3g} MB of memory\n",
                        done.vectorBytes, done.matrixBytes, static_cast<double>(done.memory) / 1e6);
    if (done.compressed) {
        text += fmt::format(
            "  {} clusters of {} components: {} bytes, error {}, at most {} at vertex "
            "{}\n",
            done.compressed->clusters, done.compressed->components, done.compressed->bytes,
            percent(done.compressed->relativeL2, 2), percent(done.compressed->largest, 2),
            done.compressed->vertex);
    }
    for (const jobs::TransferPicture& picture : done.pictures) {
        const jobs::TransferPictureError& error = picture.errors.back();
        text += fmt::format(
            "  {} under {}: error {} against path tracing (noise {}), at most {} "
            "of the mean at ({}, {})\n",
            picture.camera, picture.light, percent(error.relativeL2, 2), percent(picture.noise, 2),
            percent(error.maximum, 2), error.column, error.row);
    }
    if (done.resumed > 0)
        text += fmt::format("  {} vertices of an earlier run were taken\n", done.resumed);
    for (const std::string& file : done.files) text += fmt::format("  {}\n", file);
    return text;
}

void runTransfer(const TransferArguments& arguments, const Globals& globals) {
    const jobs::Transferred done =
        jobs::transfer(arguments.scene, arguments.output, arguments.options, listenerFor(globals));
    if (done.poor) note(globals, done.poor->line());
    if (globals.json) return printJson(jobs::transferJson(done, true));
    printText(textOf(done));
}

void addMesh(CLI::App& command, const std::shared_ptr<TransferArguments>& arguments) {
    command.add_option("--edge", arguments->edge,
                       "The longest edge of a triangle; longer ones are halved; 0: none are "
                       "(default: 1/32 of the scene's diagonal)");
    command
        .add_option("--sides", arguments->sides,
                    "Sides of surfaces with vertices; automatic: both of objects with open edges")
        ->check(CLI::IsMember(sidesNames))
        ->capture_default_str();
}

void addCompression(CLI::App& command, jobs::TransferOptions& options) {
    command
        .add_option("--clusters", options.clusters,
                    "Numbers of clusters to try for the matrices; 0: they are not compressed")
        ->delimiter(',')
        ->check(within(jobs::bounds::clusters))
        ->capture_default_str();
    command.add_option("--components", options.components, "The most components of a cluster")
        ->check(within(jobs::bounds::components))
        ->capture_default_str();
    command
        .add_option("--error", options.error,
                    "Relative L2 error that compressed matrices may have; the smallest is written")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command.add_option("--bytes", options.bytes,
                       "Bytes that compressed matrices may take; the best is written");
}

}  // namespace

void addTransfer(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<TransferArguments>();
    jobs::TransferOptions& options = arguments->options;
    command.add_option("SCENE", arguments->scene, "Materials, objects and cameras, as JSON")
        ->required();
    command
        .add_option("-o,--output", arguments->output,
                    "Folder for transfer.tensor, transfer.json, the page and pictures")
        ->required();
    command
        .add_option("--kind", arguments->kind,
                    "Light past nothing, past shadows, or by other surfaces too; the simpler kinds "
                    "are written as well")
        ->check(CLI::IsMember(kindNames))
        ->capture_default_str();
    command.add_option("--passes", options.passes, "Reflections at other surfaces")
        ->check(within(jobs::bounds::passes))
        ->capture_default_str();
    command.add_option("--rays", options.rays, "Rays of each vertex")
        ->check(within(jobs::bounds::transferRays))
        ->capture_default_str();
    command.add_option("--order", options.order, "Bands of light")
        ->check(within(jobs::bounds::transferOrder))
        ->capture_default_str();
    command
        .add_option("--local-order", options.localOrder,
                    "Bands of hemispherical harmonics above each vertex: matrices, for glossy "
                    "materials; 0: vectors alone")
        ->check(within(jobs::bounds::localOrder))
        ->capture_default_str();
    addCompression(command, options);
    addMesh(command, arguments);
    command.add_option("--seed", options.seed, "Seed of the rays")->capture_default_str();
    command.add_option("--memory", arguments->memory, "The most memory that may be needed, MB")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command.add_option("--light", options.lights,
                       "Lights of the pictures and the page beside the scene's");
    command
        .add_option("--reference-samples", options.referenceSamples,
                    "Pictures by transfer and by this many paths a pixel, and their difference by "
                    "order; 0: none")
        ->check(within(jobs::bounds::referenceSamples))
        ->capture_default_str();
    command.add_option("--material", options.swaps,
                       "BRDFs that the page can put in the place of the scene's");
    command.add_option("--camera", options.camera, "Of the pictures (default: all)");
    command.add_flag("--resume", options.resume,
                     "Keep finished vertices and passes in OUTPUT/.hshfit-transfer.partial until "
                     "all is written, and go on from those of a run that was stopped");
    command.add_flag("--force", options.force, "Replace existing files");
    command.callback([arguments, &command, &globals] {
        arguments->options.kind = numbered<jobs::TransferKind>(kindNames, arguments->kind);
        arguments->options.mesh.sides = numbered<Sides>(sidesNames, arguments->sides);
        if (command.count("--edge") > 0) arguments->options.mesh.edge = arguments->edge;
        std::erase(arguments->options.clusters, 0U);
        arguments->options.memory = static_cast<std::size_t>(arguments->memory * 1e6);
        runTransfer(*arguments, globals);
    });
}

}  // namespace hshfit::cli
