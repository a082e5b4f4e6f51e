#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline specification {

/// The range of a parameter in fits (docs/reference/fit.md), within the parameter's bounds.
struct FitRange {
    enum class Data { any, isotropic, anisotropic };
    double low = 0, high = 0;       ///< range of starting values; equal: held there
    bool logarithmic = false;       ///< fitted on a logarithmic scale
    Data data = Data::any;          ///< fitted to such data only
    std::string_view choice = {};   ///< only with this choice, "key=word", or number but 0, "key"
    std::string_view unless = {};   ///< not fitted if this parameter is stated instead
    std::string_view follows = {};  ///< equal to this parameter for isotropic data
};

class Parameters;

/// One parameter of a BRDF or a light, as listed, parsed, checked and documented.
struct Parameter {
    enum class Kind {
        number,  ///< one value in [min, max]
        colour,  ///< one value, or three as r/g/b; each in [min, max]
        choice,  ///< one of `choices`
        text,    ///< any text without a comma; `choices` has an example, the default is ""
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
    /// The part of a lobe of microfacets, f = sum of weights times terms, that it changes
    /// (FacetNormals).
    enum class Role {
        shape,   ///< the terms or the distribution of normals, and no weight
        weight,  ///< the weights alone, which are affine in it while the others stay
        both,    ///< terms and weights
        turn,    ///< the axes of the distribution
    };
    Role role = Role::shape;
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

/// Parses "key=value,key=value" (may be empty) against the table's parameters: every key declared
/// and given once, every value finite and in range, every parameter without a default given. Three
/// equal colour values become one, so that grey stays grey.
///
/// `owner` ("ward") starts every message. Throws UsageError that names the key, the value and
/// the valid values.
Parameters parseParameters(std::string_view owner, std::span<const Parameter> declared,
                           std::string_view text);

/// The two halves of parseParameters: `readParameters` gives what the text states, and `completed`
/// adds defaults and the canonical text.
Parameters readParameters(std::string_view owner, std::span<const Parameter> declared,
                          std::string_view text);
Parameters completed(std::string_view owner, std::span<const Parameter> declared,
                     Parameters stated);

/// The path in a specification of a file: all of it where that exists, else the longest part before
/// a ':' that does, so that the path, the options and the names after it may hold colons; "" where
/// there is none.
std::string_view pathIn(std::string_view spec);

/// The valid values of a parameter, for messages and listings: "0 to 1, or r/g/b", "1992|duer".
std::string validValues(const Parameter& parameter);

/// The least number of insertions, deletions and replacements that turns one into the other.
std::size_t editDistance(std::string_view a, std::string_view b);

/// " (did you mean 'ggx'?)" if one of `known` starts with `word` or is within two edits of it, else
/// "".
std::string suggestion(std::string_view word, std::span<const std::string_view> known);

/// "a, b, c".
std::string joined(std::span<const std::string_view> words);

}  // namespace hshfit::inline specification
