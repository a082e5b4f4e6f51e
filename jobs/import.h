#pragma once

#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/forms/form_files.h>

#include <cstdint>
#include <string>
#include <variant>

namespace hshfit::jobs {

struct ImportOptions {
    bool force = false;  ///< replace an existing file
};

struct Imported {
    std::variant<gpu::ImportedPayload, gpu::ImportedForm> read;
    std::uintmax_t bytes = 0;  ///< of the file written
};

/// The coefficients of a file of an export (gpu::readPayload, gpu::readForm), written to `output`,
/// .json or .exr.
/// Throws InputError and OutputError.
Imported importCoefficients(const std::string& input, const std::string& output,
                            const ImportOptions& options);

}  // namespace hshfit::jobs
