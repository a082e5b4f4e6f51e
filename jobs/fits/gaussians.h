#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>
#include <jobs/source/quality.h>

#include <hshfit/accuracy/metrics.h>
#include <hshfit/pictures/picture_error.h>

#include <brdfs/fit/gaussian_mixture_fit.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct GaussianOptions {
    /// Without `loss`; its `progress` is not called: the listener is.
    brdfs::GaussianFitOptions fit = {};
    std::string loss = "cube-root";  ///< brdfs::losses() but `picture`
    std::string outgoing = "16";     ///< OutgoingSet::parse; elevations or one direction
    std::string metrics = {};        ///< names separated by commas, or "all"; empty: none
    bool rgb = false;                ///< wavelengths as linear Rec. 709
};
OptionRows<GaussianOptions> gaussianOptions();

struct FittedGaussians {
    std::string brdf;
    brdfs::GaussianMixture mixture;
    OutgoingSet outgoing;
    double meanError = 0;           ///< relative, over the outgoing directions
    double largestEnergyError = 0;  ///< of the albedo, relative
    std::size_t unsettled = 0;      ///< outgoing directions whose fit did not converge
    std::vector<MetricValue> metrics = {};
    std::optional<PictureError> picture = {};  ///< pictureErrorOf
    std::optional<Poor> poor = {};             ///< the energy captured is 1 - meanError^2
};

/// Gaussians over wi for every outgoing direction of a BRDF (fitGaussians), written to `output` as
/// a mixture, .json. Throws UsageError, InputError, NumericError and OutputError.
FittedGaussians fitGaussians(const std::string& spec, const std::string& output,
                             const GaussianOptions& options, const Listener& listener = {});

/// The answer of the command, for what was written to `output`.
nlohmann::ordered_json gaussiansJson(const FittedGaussians& fitted, const std::string& output,
                                     const GaussianOptions& options);

}  // namespace hshfit::jobs
