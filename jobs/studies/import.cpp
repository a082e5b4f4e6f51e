#include "import.h"

#include <jobs/source/source.h>

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

namespace hshfit::jobs {
namespace {

constexpr OptionRow importRows[] = {
    OptionRow{"force", options::at<&ImportOptions::force>, "Replace an existing file"},
};

}  // namespace

OptionRows<ImportOptions> importOptions() {
    return {importRows};
}

Imported importCoefficients(const std::string& input, const std::string& output,
                            const ImportOptions& options) {
    std::error_code error;
    if (!options.force && std::filesystem::is_regular_file(output, error)) {
        throw OutputError(fmt::format("'{}' exists; nothing is written without {}", output,
                                      Setting{"ImportOptions::force"}));
    }
    Imported imported;
    imported.proposal = gpu::readProposal(input);
    if (auto form = gpu::readIfForm(input, sourceOpener())) {
        writeRepresentation(form->payload.form, output);
        imported.read = std::move(*form);
    } else {
        gpu::ImportedPayload read = gpu::readPayload(input);
        writeCoefficients(gpu::unpack(read.payload), output);
        imported.read = std::move(read);
    }
    imported.bytes = std::filesystem::file_size(output);
    return imported;
}

}  // namespace hshfit::jobs
