#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <jobs/studies/import.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <variant>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ImportArguments {
    std::string input, output;
    jobs::ImportOptions options;
};

/// The facts of the coefficients in an export.
Json contentOf(const gpu::Payload& payload) {
    return {{"brdf", payload.head.source},
            {"basis", payload.head.basis},
            {"order", payload.head.order},
            {"quantity", quantityName(payload.head.quantity)},
            {"channels", payload.head.channels.names()},
            {"outgoing", payload.head.outgoing.spec()},
            {"number", gpu::numberName(payload.coefficients.number)},
            {"packing", gpu::packingName(payload.packing)},
            {"layers", payload.coefficients.layers}};
}

Json contentOf(const gpu::FormPayload& payload) {
    return {{"brdf", payload.form.head.source},
            {"form", kindName(payload.form.kind())},
            {"channels", payload.form.head.channels.names()},
            {"number", gpu::numberName(payload.texels.number)},
            {"numbers", payload.form.numbers()}};
}

/// `read`: gpu::ImportedPayload or gpu::ImportedForm.
Json answer(const auto& read, std::uintmax_t bytes, const ImportArguments& arguments) {
    Json document = {{"format", "hshfit-import"},   {"version", 1},      {"input", arguments.input},
                     {"container", read.container}, {"file", read.file}, {"sidecar", read.sidecar},
                     {"output", arguments.output},  {"bytes", bytes}};
    document.update(contentOf(read.payload));
    document["tests"] = {{"count", read.tests}, {"largest_difference", read.testDifference}};
    return document;
}

std::string importedText(const Json& document) {
    const auto text = [&](const char* key) { return document[key].get<std::string>(); };
    const std::string content = document.contains("form")
                                    ? fmt::format("form {}, {} numbers", text("form"),
                                                  document["numbers"].get<std::size_t>())
                                    : fmt::format("{} order {}, {}", text("basis"),
                                                  document["order"].get<int>(), text("outgoing"));
    return fmt::format("{}: {}, from {} ({}, {}); SHA-256 right, {} tests within {:.1g}{}\n",
                       text("output"), content, text("file"), text("container"), text("number"),
                       document["tests"]["count"].get<std::size_t>(),
                       document["tests"]["largest_difference"].get<double>(),
                       document.contains("proposal") ? "; the proposal draws as it did" : "");
}

void runImport(const ImportArguments& arguments, const Globals& globals) {
    const jobs::Imported imported =
        jobs::importCoefficients(arguments.input, arguments.output, arguments.options);
    Json document = std::visit(
        [&](const auto& read) { return answer(read, imported.bytes, arguments); }, imported.read);
    if (imported.proposal)
        document["proposal"] = {{"rows", imported.proposal->proposal.rows.size()},
                                {"bytes", imported.proposal->proposal.bytes()}};
    if (globals.json) {
        printJson(document);
    } else {
        printText(importedText(document));
    }
}

constexpr ArgumentRow importArguments[] = {
    required("FILE", at<&ImportArguments::input>,
             "Sidecar (.hsh.json), .bin, .exr, .ktx2, .dds, .js, .h or .tensor of an export",
             {.files = Files::read, .dash = ""}),
    requiredOutput(at<&ImportArguments::output>, "Coefficient file, .json or .exr", jsonWritten),
};

}  // namespace

CommandRows importRows() {
    return {importArguments, {jobs::importOptions().rows}};
}

void addImport(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ImportArguments>();
    addArguments(command, importArguments, *arguments);
    addOptions(command, jobs::importOptions(), arguments->options);
    command.callback([arguments, &globals] { runImport(*arguments, globals); });
}

}  // namespace hshfit::cli
