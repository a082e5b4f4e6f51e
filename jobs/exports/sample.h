#pragma once

#include <jobs/common/number_text.h>
#include <jobs/common/option_row.h>

#include <hshfit/brdf/brdf.h>
#include <hshfit/sampling/efficiency.h>
#include <hshfit/sampling/make_sampler.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The densities that samples come from.
enum class SampleMethod { best, table, proposal, stored, cosine };
/// "auto" (the BRDF's own, or a fitted one and a table), "table", "proposal", "stored" (the
/// proposal of an export, as its shaders draw from it) or "cosine". Throws UsageError.
SampleMethod sampleMethod(const std::string& name);
std::string sampleMethodName(SampleMethod method);

struct SampleOptions {
    SampleMethod method = SampleMethod::best;
    Direction outgoing = Angles{45, 0}.direction();
    std::size_t count = 1000;  ///< directions that are kept
    std::uint64_t seed = 1;
    std::size_t elevations = 7;  ///< of the report, from 0 to 89 degrees; 0: none
    std::size_t trials = 20000;  ///< samples behind each row of the report
};
OptionRows<SampleOptions> sampleOptions();

/// A sample and its weight f cos(theta_i) / pdf, per channel.
struct DrawnDirection {
    Direction wi;
    double pdf = 0;
    std::vector<double> weights;
};

struct SampleRow {
    Efficiency efficiency;
    /// The directional albedo by quadrature, per channel; none if it did not converge to 1e-4.
    std::optional<std::vector<double>> albedo;
    std::vector<double> shares;  ///< the probability of each part
};

struct Sampled {
    std::string brdf;
    std::vector<std::string> channels;
    std::vector<std::string> parts;  ///< names
    bool reflects = true;            ///< false: f is 0 at `outgoing`, as far as was looked
    std::vector<DrawnDirection> drawn;
    SampleRow here;               ///< the report at `outgoing`
    std::vector<SampleRow> rows;  ///< by elevation, at the azimuth of `outgoing`
    bool stored = false;          ///< the proposal comes from the export, not from a fit
    double buildSeconds = 0, nanosecondsPerSample = 0;
};

/// Draws incident directions in proportion to f cos(theta_i), and reports the efficiency by
/// elevation. Unless `output` is empty, the directions are written there as CSV. The proposal that
/// an export keeps takes the place of a fit.
/// Throws UsageError for an outgoing direction that is not above the horizon and for the method
/// `stored` of what keeps no proposal, OutputError, and as openSource.
Sampled sample(const std::string& spec, const std::string& output, const SampleOptions& options);

}  // namespace hshfit::jobs
