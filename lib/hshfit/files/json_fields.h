#pragma once

// Numbers into JSON, and checked access to JSON that somebody else wrote. Only for sources that use
// nlohmann-json.

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

// Compiled once, in json_fields.cpp.
extern template class nlohmann::basic_json<>;
extern template class nlohmann::basic_json<nlohmann::ordered_map>;

namespace hshfit::inline files {

/// The largest magnitude that JsonFields takes: products of three such numbers are finite.
inline constexpr double largestNumber = 1e100;

/// The number that null stands for.
inline constexpr double nullNumber = std::numeric_limits<double>::quiet_NaN();

/// A number as JSON can hold it: null where there is none or it is not finite.
nlohmann::ordered_json finiteOrNull(std::optional<double> value);

/// JSON as text, on one line or indented. Strings that are no UTF-8 get replacement characters,
/// control characters are escaped (printable.h).
std::string jsonText(const nlohmann::json& value, int indent = -1);
std::string jsonText(const nlohmann::ordered_json& value, int indent = -1);

/// Sees what the parser finds, after the checks of `parseJson`; false drops a value from the tree.
using JsonFilter =
    std::function<bool(int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed)>;

/// Throws InputError that starts with `file` for what is no JSON, is nested more deeply than
/// `maxDepth`, or holds a key twice in one object.
nlohmann::json parseJson(std::string_view text, const std::string& file, int maxDepth,
                         const JsonFilter& filter = {});

/// One object of a file, with messages that name the field: every member but `has` and `json`
/// throws InputError. Numbers are at most `largestNumber` in magnitude.
class JsonFields {
public:
    /// `path` is what leads to the object, "" for the root; both references have to outlive this.
    JsonFields(const nlohmann::json& object, std::string path, const std::string& file);

    [[noreturn]] void fail(std::string_view what, std::string_view key = {}) const;
    bool has(const char* key) const { return object_.contains(key); }
    const nlohmann::json& json() const { return object_; }
    const nlohmann::json& at(const char* key) const;
    JsonFields object(const char* key) const;
    /// Each element of an array of objects.
    std::vector<JsonFields> objects(const char* key) const;
    std::string word(const char* key) const;
    std::vector<std::string> words(const char* key) const;
    /// The name of a file beside the one with this object: of one part, and neither "." nor "..".
    std::string fileName(const char* key) const;
    bool flag(const char* key) const;
    double number(const char* key) const;
    double number(const char* key, double min, double max) const;
    std::optional<double> numberOrNull(const char* key) const;
    int integer(const char* key, int min, int max) const;
    std::vector<double> numbers(const char* key) const;
    /// `count` of them.
    std::vector<double> numbers(const char* key, std::size_t count) const;
    /// An array of `rows` arrays of `columns` numbers.
    std::vector<std::vector<double>> table(const char* key, std::size_t rows,
                                           std::size_t columns) const;

private:
    double finite(const nlohmann::json& value, const char* key) const;
    std::vector<double> numbersOf(const nlohmann::json& array, const char* key) const;

    const nlohmann::json& object_;
    std::string path_;
    const std::string& file_;
};

}  // namespace hshfit::inline files
