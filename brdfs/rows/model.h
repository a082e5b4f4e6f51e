#pragma once

#include <brdfs/rows/spec.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/sampling/sampler.h>

#include <memory>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

class ModelColumns;
struct ColumnRequest;

/// An optional part of a model: parameters whose defaults together leave it out.
struct ModelPart {
    std::string_view name;
    std::string_view help;
    std::vector<std::string_view> parameters;
    /// Stated by a fit that adds the part, "key=value"; empty: leaving its parameters open adds it.
    std::string_view with = {};
};

/// One row of the table of analytic models.
struct Model {
    std::string_view name;
    std::string_view help;
    std::string_view source;  ///< author, year, DOI
    std::vector<Parameter> parameters;
    /// Laws that every member of this model keeps; the instance's laws() may claim more (Ward
    /// with ax = ay is isotropic), never less.
    Laws laws;
    std::unique_ptr<Brdf> (*make)(const Parameters& parameters);
    /// The columns of fits (brdfs/analytic/model_columns.h), from the formula of `make`.
    std::unique_ptr<ModelColumns> (*columns)(const ColumnRequest& request) = nullptr;
    /// Whether f has functions of its own in each of R, G and B, in which it is not linear in its
    /// colours, given what is stated. None: never.
    bool (*channelwise)(const Parameters& stated) = nullptr;
    /// The densities of its lobes (hshfit/sampling), for drawing directions. None: f is tabulated.
    HasSamplers::Known (*sampling)(const Parameters& parameters) = nullptr;
    /// Parts that a fit may add or leave out (fit/choose_parts.h).
    std::vector<ModelPart> parts = {};
};

}  // namespace hshfit::brdfs
