#pragma once

#include <hshfit/brdf/brdf.h>

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

/// The range of a parameter in fits (docs/fit.md), within the parameter's bounds.
struct FitRange {
    enum class Data { any, isotropic, anisotropic };
    double low = 0, high = 0;       ///< range of starting values; equal: held there
    bool logarithmic = false;       ///< fitted on a logarithmic scale
    Data data = Data::any;          ///< fitted to such data only
    std::string_view choice = {};   ///< fitted with this choice only, "key=word"; empty: any
    std::string_view unless = {};   ///< not fitted if this parameter is stated instead
    std::string_view follows = {};  ///< equal to this parameter for isotropic data
};

class Parameters;

/// One parameter of an analytic model, as listed, parsed, checked and documented.
struct Parameter {
    enum class Kind {
        number,  ///< one value in [min, max]
        colour,  ///< one value, or three as r/g/b; each in [min, max]
        choice,  ///< one of `choices`
    };
    std::string_view name;
    std::string_view help;
    Kind kind = Kind::number;
    /// None: the parameter has to be given. Outside [min, max]: the default is described in the
    /// help.
    std::optional<double> fallback = {};
    double min = 0, max = 0;
    std::vector<std::string_view> choices = {};  ///< the first is the default
    /// The first applicable range counts. None: fits keep the stated value, or the default.
    std::vector<FitRange> fit = {};
    /// Colours with a least value of 0: whether f is linear in it, each channel by itself, jointly
    /// with all free parameters for which this holds, given what is stated. None: it is not.
    bool (*linear)(const Parameters& stated) = nullptr;
};

/// Checked parameter values, defaults filled in. A request for an undeclared name is our bug.
class Parameters {
public:
    double number(std::string_view name) const;
    std::vector<double> colour(std::string_view name) const;  ///< 1 or 3 values
    std::string choice(std::string_view name) const;
    bool given(std::string_view name) const;  ///< stated rather than left to its default
    /// "key=value,…" in the order of the table, without values equal to the default.
    std::string canonical() const;
    /// States a number or a colour; three equal values become one, so that grey stays grey.
    void set(std::string_view name, std::vector<double> values);

    std::map<std::string, std::vector<double>, std::less<>> numbers;
    std::map<std::string, std::string, std::less<>> words;
    std::set<std::string, std::less<>> stated;
    std::string text;
};

class ModelColumns;
struct ColumnRequest;

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
