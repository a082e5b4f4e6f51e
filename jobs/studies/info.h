#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <hshfit/accuracy/health.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/forms/form_files.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_health.h>
#include <hshfit/representation/representation.h>

#include <brdfs/measured/measured_brdf.h>

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

struct InfoOptions {
    bool rgb = false;  ///< wavelengths as linear Rec. 709
};
OptionRows<InfoOptions> infoOptions();

struct SuggestedRepair {
    std::string_view name;  ///< brdfs::repairs
    std::string reason;
};

/// Facts about a source and a report on its health.
struct BrdfInfo {
    std::unique_ptr<Brdf> brdf;  ///< which has the name, the channels, the laws and the facts
    /// Parts of `brdf`: the head of any coefficients, and the form of those that are not plain.
    const CoefficientHead* coefficients = nullptr;
    const Representation* representation = nullptr;
    std::optional<gpu::ImportedPayload> exported = {};   ///< of a file of an export
    std::optional<gpu::ImportedForm> exportedForm = {};  ///< of one of a form as it is
    std::optional<brdfs::Census> census = {};            ///< these three of a measured BRDF
    std::vector<brdfs::Axis> axes = {};
    std::optional<brdfs::BothOrders> bothOrders = {};
    std::optional<Health> health = {};  ///< of the channels that are a reflectance, if any are
    std::vector<SuggestedRepair> repairs = {};
    /// f over 12 outgoing directions and the grid that quadrature would use.
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    std::vector<std::string> warnings = {};  ///< a sentence each, where values contradict the kind
};

/// Facts of a source as in openSource. Stored values that are not finite are counted, not refused.
/// Throws UsageError and InputError.
BrdfInfo describeSource(const std::string& source, const InfoOptions& options = {},
                        const Listener& listener = {});

struct LightInfo {
    std::vector<Light> lights;
    LightHealth health = {};
    std::vector<std::string> warnings = {};
};

/// Facts of a sum of lights (parseLights). Invalid pixels are counted, not refused. Throws
/// UsageError and InputError.
LightInfo describeLight(const std::string& specification);

}  // namespace hshfit::jobs
