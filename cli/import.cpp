#include "command.h"

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/error.h>
#include <hshfit/gpu/containers/containers.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ImportArguments {
    std::string input, output;
    bool force = false;
};

Json describe(const gpu::ImportedPayload& read, const ImportArguments& arguments) {
    const gpu::Payload& payload = read.payload;
    return {{"format", "hshfit-import"},
            {"version", 1},
            {"input", arguments.input},
            {"container", read.container},
            {"file", read.file},
            {"sidecar", read.sidecar},
            {"output", arguments.output},
            {"bytes", std::filesystem::file_size(arguments.output)},
            {"brdf", payload.head.source},
            {"basis", payload.head.basis},
            {"order", payload.head.order},
            {"quantity", quantityName(payload.head.quantity)},
            {"channels", payload.head.channels.names()},
            {"outgoing", payload.head.outgoing.spec()},
            {"number", gpu::numberName(payload.coefficients.number)},
            {"packing", gpu::packingName(payload.packing)},
            {"layers", payload.coefficients.layers},
            {"tests", {{"count", read.tests}, {"largest_difference", read.testDifference}}}};
}

std::string importedText(const Json& document) {
    return fmt::format(
        "{}: {} order {}, {}, from {} ({}, {}); SHA-256 right, {} tests within {:.1g}\n",
        document["output"].get<std::string>(), document["basis"].get<std::string>(),
        document["order"].get<int>(), document["outgoing"].get<std::string>(),
        document["file"].get<std::string>(), document["container"].get<std::string>(),
        document["number"].get<std::string>(), document["tests"]["count"].get<std::size_t>(),
        document["tests"]["largest_difference"].get<double>());
}

void runImport(const ImportArguments& arguments, const Globals& globals) {
    std::error_code error;
    if (!arguments.force && std::filesystem::is_regular_file(arguments.output, error)) {
        throw OutputError(
            fmt::format("'{}' exists; nothing is written without --force", arguments.output));
    }
    const gpu::ImportedPayload read = gpu::readPayload(arguments.input);
    writeCoefficients(gpu::unpack(read.payload), arguments.output);
    const Json document = describe(read, arguments);
    if (globals.json) {
        printJson(document);
    } else {
        printText(importedText(document));
    }
}

}  // namespace

void addImport(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ImportArguments>();
    command
        .add_option("FILE", arguments->input,
                    "Sidecar (.hsh.json), .bin, .exr, .ktx2, .dds, .js, .h or .tensor of an export")
        ->required();
    command.add_option("-o,--output", arguments->output, "Coefficient file, .json or .exr")
        ->required();
    command.add_flag("--force", arguments->force, "Replace an existing file");
    command.callback([arguments, &globals] { runImport(*arguments, globals); });
}

}  // namespace hshfit::cli
