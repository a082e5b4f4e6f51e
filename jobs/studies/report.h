#pragma once

#include <jobs/common/inputs.h>
#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <hshfit/pages/report.h>
#include <hshfit/projection/projection.h>

#include <string>
#include <vector>

namespace hshfit::jobs {

struct ReportOptions {
    std::string bases = "all";  ///< or names, separated by commas
    int maxOrder = 12;          ///< orders 1 to this one, or to the largest that a basis has
    std::string outgoing;       ///< as in outgoingOrDefault
    bool cosine = false;        ///< f cos(theta_i) instead of f
    bool rgb = false;           ///< wavelengths as linear Rec. 709
    bool wavelets = false;      ///< a curve of the best terms of spherical wavelets as well
    double tolerance = 0;       ///< as in ProjectionOptions
    double maxEvaluations = static_cast<double>(ProjectionOptions{}.maxEvaluations);
};
OptionRows<ReportOptions> reportOptions();

struct Reported {
    std::vector<std::string> specs;  ///< with folders expanded
    Report report;                   ///< of those that did not fail, in their order
    std::vector<InputFailure> failures;
};

/// Captured energy by order of every basis, for each BRDF. A BRDF without finite energy has an
/// entry with the reason. The error of a single SPEC is thrown; with several, errors are in
/// `failures`.
Reported report(const std::vector<std::string>& specs, const ReportOptions& options,
                const Listener& listener = {});

/// The entry of a BRDF that is open; `rgb` is not used.
ReportEntry reportOf(const Brdf& brdf, const ReportOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
