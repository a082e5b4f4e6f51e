#pragma once

#include <brdfs/rows/spec.h>
#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

struct WriteOptions {
    bool force = false;  ///< replace an existing file
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// One row of the table of formats that can be written.
struct Writer {
    std::string_view name;  ///< the reading format's, if there is one
    std::string_view help;
    std::string_view extension;         ///< with the dot; `convert` chooses by it
    std::vector<Parameter> parameters;  ///< options: --to NAME:key=value
    /// Samples a BRDF at the nodes of the format and writes them through an AtomicFile. Returns
    /// a sentence for each loss other than sampling. Throws UsageError for a BRDF that the
    /// format cannot hold, NumericError for values that it cannot hold, and OutputError.
    std::vector<std::string> (*write)(const Brdf& brdf, const std::string& path,
                                      const Parameters& parameters, const WriteOptions& options);
    bool readBack = true;  ///< `open` opens what was written
};

}  // namespace hshfit::brdfs
