#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/many.h>
#include <jobs/common/option_row.h>
#include <jobs/source/quality.h>

#include <hshfit/accuracy/metrics.h>

#include <brdfs/repair.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct ConvertOptions {
    std::string format;    ///< a writer's NAME[:key=value,…]; empty: by the extension
    std::string repairs;   ///< names separated by commas, or "all"; empty: none
    std::string outgoing;  ///< of the loss, as in outgoingOrDefault
    bool rgb = false;      ///< wavelengths as linear Rec. 709
    bool measureLoss = false;
    bool force = false;  ///< replace an existing file
};
OptionRows<ConvertOptions> convertOptions();

/// Errors of the file as read back, against the BRDF that it was written from.
struct ConversionLoss {
    std::string outgoing;
    std::vector<MetricValue> metrics;
};

struct Repairs {
    std::uint64_t evaluated = 0;  ///< values
    std::vector<brdfs::RepairCount> counts;
};

struct Converted {
    std::string input;                 ///< name of the BRDF, repairs included
    std::string written;               ///< the writer
    std::vector<std::string> altered;  ///< what the format leaves out or changes, a sentence each
    std::uintmax_t bytes = 0;
    std::optional<Repairs> repairs;
    std::optional<ConversionLoss> loss;
    /// Relative L2 of f c between the file, read back, and the BRDF; none where nothing here reads
    /// the format, or the BRDF is 0.
    std::optional<double> error = {};
    std::string errorOver = {};                ///< the directions of `error`, in words
    std::optional<PictureError> picture = {};  ///< of the file, read back
    std::optional<Poor> poor = {};             ///< the energy captured is 1 - error^2
};

/// Writes a BRDF or a coefficient file to `output` in the format of another program. Throws
/// UsageError for a format that is unknown or cannot hold the data, InputError, NumericError
/// and OutputError.
Converted convert(const std::string& input, const std::string& output,
                  const ConvertOptions& options, const Listener& listener = {});

/// Converts many inputs, each to FOLDER/NAME with the extension of the format, which has to be
/// given. Folders stand for their measured files. Files that exist are refused before any is
/// written, unless `force` is set or, under a rule of the process (hshfit/files/output_rule.h),
/// they have the bytes of the result. Each new file appears when it is complete.
Many<Converted> convertMany(const std::vector<std::string>& specs, const std::string& folder,
                            const ConvertOptions& options, const Listener& listener = {});

/// Converts a BRDF that is open. Throws UsageError if `options` have repairs or `rgb`, which are
/// for BRDFs that convert() opens.
Converted convertBrdf(const Brdf& brdf, const std::string& output, const ConvertOptions& options,
                      const Listener& listener = {});

}  // namespace hshfit::jobs
