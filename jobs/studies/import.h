#pragma once

#include <jobs/common/option_row.h>

#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/forms/form_files.h>
#include <hshfit/gpu/proposals/proposal_record.h>

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace hshfit::jobs {

struct ImportOptions {
    bool force = false;  ///< replace an existing file
};
OptionRows<ImportOptions> importOptions();

struct Imported {
    std::variant<gpu::ImportedPayload, gpu::ImportedForm> read;
    std::optional<gpu::ProposalRecord> proposal;  ///< for sampling, where the export keeps one
    std::uintmax_t bytes = 0;                     ///< of the file written
};

/// The coefficients of a file of an export (gpu::readPayload, gpu::readForm), written to `output`,
/// .json or .exr.
/// Throws InputError and OutputError.
Imported importCoefficients(const std::string& input, const std::string& output,
                            const ImportOptions& options);

}  // namespace hshfit::jobs
