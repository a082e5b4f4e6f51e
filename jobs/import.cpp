#include "import.h"

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

namespace hshfit::jobs {

Imported importCoefficients(const std::string& input, const std::string& output,
                            const ImportOptions& options) {
    std::error_code error;
    if (!options.force && std::filesystem::is_regular_file(output, error)) {
        throw OutputError(fmt::format("'{}' exists; nothing is written without {}", output,
                                      Setting{"ImportOptions::force"}));
    }
    Imported imported{.read = gpu::readPayload(input)};
    writeCoefficients(gpu::unpack(imported.read.payload), output);
    imported.bytes = std::filesystem::file_size(output);
    return imported;
}

}  // namespace hshfit::jobs
