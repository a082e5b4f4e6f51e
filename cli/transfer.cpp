#include "command.h"
#include "command_rows.h"
#include "job_options.h"

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

struct TransferArguments {
    std::string scene, output;
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
        for (const std::string& file : picture.files) text += fmt::format("    {}\n", file);
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

constexpr ArgumentRow transferArguments[] = {
    required("SCENE", at<&TransferArguments::scene>, "Materials, objects and cameras, as JSON",
             {.files = Files::read}),
    requiredOutput(at<&TransferArguments::output>,
                   "Folder for transfer.tensor, transfer.json, the page and pictures",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows transferRows() {
    return {transferArguments, {jobs::transferOptions().rows}};
}

void addTransfer(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<TransferArguments>();
    addArguments(command, transferArguments, *arguments);
    addOptions(command, jobs::transferOptions(), arguments->options);
    command.callback([arguments, &globals] { runTransfer(*arguments, globals); });
}

}  // namespace hshfit::cli
