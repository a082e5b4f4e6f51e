#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

template class nlohmann::basic_json<>;
template class nlohmann::basic_json<nlohmann::ordered_map>;

namespace hshfit::inline files {

using Json = nlohmann::json;

std::string jsonText(const nlohmann::json& value, int indent) {
    return printableJson(value.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string jsonText(const nlohmann::ordered_json& value, int indent) {
    return printableJson(
        value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

nlohmann::ordered_json finiteOrNull(std::optional<double> value) {
    if (!value || !std::isfinite(*value)) return nullptr;
    return *value;
}

Json parseJson(std::string_view text, const std::string& file, int maxDepth,
               const JsonFilter& filter) {
    std::vector<std::set<std::string>> keys;
    const auto check = [&](int depth, Json::parse_event_t event, Json& parsed) {
        using Event = Json::parse_event_t;
        if (depth > maxDepth) throw InputError(fmt::format("{}: is nested too deeply", file));
        if (event == Event::object_start) keys.emplace_back();
        if (event == Event::object_end) keys.pop_back();
        if (event == Event::key && !keys.back().insert(parsed.get<std::string>()).second) {
            throw InputError(fmt::format("{}: the key '{}' appears twice", file,
                                         printable(parsed.get<std::string>().substr(0, 40))));
        }
        return !filter || filter(depth, event, parsed);
    };
    try {
        return Json::parse(text, check);
    } catch (const Json::exception& error) {
        // "[json.exception.parse_error.101] parse error at line 1, …", in bounds
        std::string reason = error.what();
        if (const auto end = reason.find("] "); end != std::string::npos) reason.erase(0, end + 2);
        if (reason.size() > 160) reason = reason.substr(0, 160) + "…";
        throw InputError(fmt::format("{}: not valid JSON: {}", file, printable(reason)));
    }
}

JsonFields::JsonFields(const Json& object, std::string path, const std::string& file)
    : object_(object), path_(std::move(path)), file_(file) {
    if (!object_.is_object()) fail("has to be an object");
}

void JsonFields::fail(std::string_view what, std::string_view key) const {
    std::string name = path_;
    if (!name.empty() && !key.empty()) name += '.';
    name += key;
    if (name.empty()) throw InputError(fmt::format("{}: the content {}", file_, printable(what)));
    throw InputError(fmt::format("{}: '{}' {}", file_, name, printable(what)));
}

const Json& JsonFields::at(const char* key) const {
    if (!has(key)) fail("is missing", key);
    return object_.at(key);
}

JsonFields JsonFields::object(const char* key) const {
    return {at(key), path_.empty() ? key : path_ + '.' + key, file_};
}

std::vector<JsonFields> JsonFields::objects(const char* key) const {
    if (!at(key).is_array()) fail("has to be an array of objects", key);
    std::vector<JsonFields> result;
    for (const Json& element : at(key)) {
        const std::string name = fmt::format("{}[{}]", key, result.size());
        result.push_back({element, path_.empty() ? name : path_ + '.' + name, file_});
    }
    return result;
}

std::string JsonFields::word(const char* key) const {
    if (!at(key).is_string()) fail("has to be a string", key);
    return at(key).get<std::string>();
}

std::string JsonFields::fileName(const char* key) const {
    std::string name = word(key);
    if (name.empty() || name == "." || name == ".." ||
        name.find_first_of(std::string_view("/\\\0", 3)) != std::string::npos) {
        fail("has to be a plain file name, of a file beside this one", key);
    }
    return name;
}

std::vector<std::string> JsonFields::words(const char* key) const {
    const auto isWord = [](const Json& element) { return element.is_string(); };
    if (!at(key).is_array() || !std::all_of(at(key).begin(), at(key).end(), isWord)) {
        fail("has to be an array of strings", key);
    }
    return at(key).get<std::vector<std::string>>();
}

bool JsonFields::flag(const char* key) const {
    if (!at(key).is_boolean()) fail("has to be true or false", key);
    return at(key).get<bool>();
}

double JsonFields::number(const char* key) const {
    if (!at(key).is_number()) fail("has to be a number", key);
    return finite(at(key), key);
}

double JsonFields::number(const char* key, double min, double max) const {
    const double value = number(key);
    if (!(value >= min && value <= max)) {
        fail(fmt::format("is {:g}; it has to be from {:g} to {:g}", value, min, max), key);
    }
    return value;
}

std::optional<double> JsonFields::numberOrNull(const char* key) const {
    if (at(key).is_null()) return std::nullopt;
    if (!at(key).is_number()) fail("has to be a number or null", key);
    return finite(at(key), key);
}

int JsonFields::integer(const char* key, int min, int max) const {
    const double value = number(key);
    if (value != std::floor(value) || value < min || value > max) {
        fail(fmt::format("is {}; it has to be an integer from {} to {}", value, min, max), key);
    }
    return static_cast<int>(value);
}

std::vector<double> JsonFields::numbers(const char* key) const {
    return numbersOf(at(key), key);
}

std::vector<double> JsonFields::numbers(const char* key, std::size_t count) const {
    std::vector<double> values = numbers(key);
    if (values.size() != count) {
        fail(fmt::format("has {} numbers; it has to have {}", values.size(), count), key);
    }
    return values;
}

std::vector<std::vector<double>> JsonFields::table(const char* key, std::size_t rows,
                                                   std::size_t columns) const {
    const Json& array = at(key);
    const auto wrong = [&] {
        fail(fmt::format("has to be an array of {} arrays of {} numbers", rows, columns), key);
    };
    if (!array.is_array() || array.size() != rows) wrong();
    std::vector<std::vector<double>> values;
    for (const Json& row : array) {
        values.push_back(numbersOf(row, key));
        if (values.back().size() != columns) wrong();
    }
    return values;
}

std::vector<double> JsonFields::numbersOf(const Json& array, const char* key) const {
    if (!array.is_array()) fail("has to be an array of numbers", key);
    std::vector<double> values;
    for (const Json& value : array) {
        if (!value.is_number()) fail("has to be an array of numbers", key);
        values.push_back(finite(value, key));
    }
    return values;
}

double JsonFields::finite(const Json& value, const char* key) const {
    const double number = value.get<double>();
    if (!(std::abs(number) <= largestNumber)) {
        fail(std::isfinite(number) ? fmt::format("is {:g}; numbers are at most {:g} in magnitude",
                                                 number, largestNumber)
                                   : "is not finite",
             key);
    }
    return number;
}

}  // namespace hshfit::inline files
