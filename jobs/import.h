#pragma once

#include <hshfit/gpu/containers/containers.h>

#include <cstdint>
#include <string>

namespace hshfit::jobs {

struct ImportOptions {
    bool force = false;  ///< replace an existing file
};

struct Imported {
    gpu::ImportedPayload read;
    std::uintmax_t bytes = 0;  ///< of the file written
};

/// The coefficients of a file of an export (gpu::readPayload), written to `output`, .json or .exr.
/// Throws InputError and OutputError.
Imported importCoefficients(const std::string& input, const std::string& output,
                            const ImportOptions& options);

}  // namespace hshfit::jobs
