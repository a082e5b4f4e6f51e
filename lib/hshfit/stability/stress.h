#pragma once

#include <hshfit/bases/catalog.h>
#include <hshfit/bases/lsosh.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/stability/basis_errors.h>
#include <hshfit/stability/error_trials.h>

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::stability {

/// The projection of one lobe for one outgoing direction onto HSH, order 7, f cos(theta_i).
struct LobeProjection {
    std::string brdf;
    double thetaDegrees = 0;
    bool converged = false;
    double error = 0;     ///< relative, estimated from the levels of quadrature
    double captured = 0;  ///< share of the energy, Eq. 15
    std::size_t evaluations = 0;
    std::string reason = {};  ///< the reason why it did not converge
};

/// The Gram system of least-squares harmonics of one order.
struct GramPoint {
    int order = 0;
    bases::LsoshGram gram;
};

/// The accuracy of each computation by degree, order and width, as `hshfit stress` reports it.
struct StressReport {
    int maxOrder = 0;
    std::vector<DegreeErrors> evaluation = {}, orthonormality = {};
    std::vector<DegreeErrors> rotation = {};     ///< rotation_errors.h
    std::vector<DegreeErrors> basisChange = {};  ///< from SH, and from HSH to SH
    std::vector<GramPoint> gram = {};            ///< of least-squares SH
    std::vector<LobeProjection> projection = {};
    std::vector<ErrorTrialSummary> statedErrors = {};  ///< of trials (error_trials.h), if any
    double triedTolerance = 0;                         ///< of the trials; 0: each BRDF's default
};

/// The range of the study: the largest degree, and the elevations of outgoing directions.
struct StressOptions {
    int maxOrder = 1000;
    std::vector<double> thetaDegrees = {0, 30, 60, 80, 89, 89.9, 89.99};
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// In float and double: evaluation and orthonormality of the bases in `bases` that have degrees,
/// rotation, and change of basis between SH and each of these bases. Also the
/// Gram systems of lsosh if it is among them; the projection of every lobe of `lobes`.
/// Results do not depend on the number of threads.
StressReport stress(std::span<const bases::Entry* const> bases, std::span<const Brdf* const> lobes,
                    const StressOptions& options = {});

/// The document of docs/schemas/stress.schema.json.
std::string stressJson(const StressReport& report);
/// The Markdown tables of docs/results/stability.md.
std::string stressMarkdown(const StressReport& report);
/// degree,basis,quantity,precision,error
std::string stressCsv(const StressReport& report);

/// stress.json, stress.md and stress.csv into a folder, made if absent. Throws OutputError.
void writeStress(const StressReport& report, const std::string& folder);

}  // namespace hshfit::stability
