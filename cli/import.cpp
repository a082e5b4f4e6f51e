#include "command.h"

#include <jobs/import.h>

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

Json answer(const gpu::ImportedPayload& read, std::uintmax_t bytes,
            const ImportArguments& arguments) {
    const gpu::Payload& payload = read.payload;
    return {{"format", "hshfit-import"},
            {"version", 1},
            {"input", arguments.input},
            {"container", read.container},
            {"file", read.file},
            {"sidecar", read.sidecar},
            {"output", arguments.output},
            {"bytes", bytes},
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

Json answer(const gpu::ImportedForm& read, std::uintmax_t bytes, const ImportArguments& arguments) {
    const Representation& form = read.payload.form;
    return {{"format", "hshfit-import"},
            {"version", 1},
            {"input", arguments.input},
            {"container", read.container},
            {"file", read.file},
            {"sidecar", read.sidecar},
            {"output", arguments.output},
            {"bytes", bytes},
            {"brdf", form.head.source},
            {"form", kindName(form.kind())},
            {"channels", form.head.channels.names()},
            {"number", gpu::numberName(read.payload.texels.number)},
            {"numbers", form.numbers()},
            {"tests", {{"count", read.tests}, {"largest_difference", read.testDifference}}}};
}

std::string importedFormText(const Json& document) {
    return fmt::format(
        "{}: form {}, {} numbers, from {} ({}, {}); SHA-256 right, {} tests within "
        "{:.1g}\n",
        document["output"].get<std::string>(), document["form"].get<std::string>(),
        document["numbers"].get<std::size_t>(), document["file"].get<std::string>(),
        document["container"].get<std::string>(), document["number"].get<std::string>(),
        document["tests"]["count"].get<std::size_t>(),
        document["tests"]["largest_difference"].get<double>());
}

void runImport(const ImportArguments& arguments, const Globals& globals) {
    const jobs::Imported imported =
        jobs::importCoefficients(arguments.input, arguments.output, arguments.options);
    const Json document = std::visit(
        [&](const auto& read) { return answer(read, imported.bytes, arguments); }, imported.read);
    const bool form = std::holds_alternative<gpu::ImportedForm>(imported.read);
    if (globals.json) {
        printJson(document);
    } else {
        printText(form ? importedFormText(document) : importedText(document));
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
    command.add_flag("--force", arguments->options.force, "Replace an existing file");
    command.callback([arguments, &globals] { runImport(*arguments, globals); });
}

}  // namespace hshfit::cli
