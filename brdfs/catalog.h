#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/sampling/sampler.h>
#include <hshfit/specification/parameters.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

using hshfit::FitRange;
using hshfit::Parameter;
using hshfit::Parameters;

class ModelColumns;
struct ColumnRequest;

/// An optional part of a model: parameters whose defaults together leave it out.
struct ModelPart {
    std::string_view name;
    std::string_view help;
    std::vector<std::string_view> parameters;
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
    /// The densities of its lobes (hshfit/sampling), for drawing directions. None: f is tabulated.
    HasSamplers::Known (*sampling)(const Parameters& parameters) = nullptr;
    /// Parts that a fit may add or leave out (fit/choose_parts.h).
    std::vector<ModelPart> parts = {};
};

/// One row of the table of measured formats.
struct Format {
    std::string_view name;
    std::string_view help;
    std::string_view extension;  ///< with the dot; used only for unrecognised content
    /// Whether the first bytes and the size look like this format.
    bool (*recognises)(std::span<const unsigned char> head, std::uint64_t fileSize);
    std::vector<Parameter> parameters;  ///< options after the path: PATH:key=value
    std::unique_ptr<Brdf> (*open)(const std::string& path, const Parameters& parameters);
};

struct WriteOptions {
    bool force = false;  ///< replace an existing file
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// One row of the table of formats that can be written.
struct Writer {
    std::string_view name;  ///< that of the format which reads it back, if there is one
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

/// The catalogs, in the order in which they are listed.
std::span<const Model> models();
std::span<const Format> formats();
std::span<const Writer> writers();

/// Opens "model[:key=value,…]". Throws UsageError as `open` does.
std::unique_ptr<Brdf> openModel(std::string_view spec);

/// Opens a BRDF specification:
///     model[:key=value,…] | path of a measured file[:key=value,…] | path of a preset .json |
///     preset:NAME | a sum of these, "SPEC + WEIGHT * SPEC" (sum.h) |
///     rgb:SPEC, a spectral one as linear Rec. 709 (hshfit/colour.h)
/// Throws UsageError for an unknown model, key or value (naming the valid ones) and InputError for
/// a file that is absent, of no known format, or invalid.
std::unique_ptr<Brdf> open(std::string_view spec);

}  // namespace hshfit::brdfs
