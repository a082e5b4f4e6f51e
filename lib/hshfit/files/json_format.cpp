#include <hshfit/files/json_format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

namespace hshfit::inline files {
namespace {

using Json = nlohmann::json;

/// Ends the parser, by false, at the string that is looked for.
class FormatFinder final : public nlohmann::json_sax<Json> {
public:
    std::string found;

    bool null() override { return other(); }
    bool boolean(bool) override { return other(); }
    bool number_integer(number_integer_t) override { return other(); }
    bool number_unsigned(number_unsigned_t) override { return other(); }
    bool number_float(number_float_t, const string_t&) override { return other(); }
    bool binary(binary_t&) override { return other(); }
    bool string(string_t& value) override {
        if (expected_) found = value;
        return !expected_;
    }
    bool key(string_t& name) override {
        expected_ = depth_ == 1 && name == "format";
        return true;
    }
    bool start_object(std::size_t) override { return open(true); }
    bool start_array(std::size_t) override { return open(false); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }
    bool parse_error(std::size_t, const std::string&, const Json::exception&) override {
        return false;
    }

private:
    bool other() const { return depth_ > 0 && !expected_; }
    bool open(bool object) {
        ++depth_;
        return !expected_ && (depth_ > 1 || object);
    }
    bool close() { return --depth_ > 0; }

    int depth_ = 0;
    bool expected_ = false;  ///< the value of "format" comes next
};

constexpr std::string_view blanks = " \t\r\n";

std::string_view withoutBlanks(std::string_view text) {
    return text.substr(std::min(text.find_first_not_of(blanks), text.size()));
}

template <class Input>
std::string formatIn(Input&& input) {
    FormatFinder finder;
    Json::sax_parse(std::forward<Input>(input), &finder);
    return finder.found;
}

}  // namespace

std::string jsonFormat(std::string_view text) {
    return formatIn(text);
}

bool beginsAsJson(std::string_view bytes) {
    const std::string_view head = withoutBlanks(bytes.substr(0, jsonStartBytes));
    if (!head.starts_with('{')) return false;
    const std::string_view first = withoutBlanks(head.substr(1));
    return (first.empty() || first.starts_with('"') || first.starts_with('}')) &&
           std::ranges::none_of(head, [](unsigned char c) {
               return c < ' ' && blanks.find(static_cast<char>(c)) == blanks.npos;
           });
}

std::string jsonFormatOf(const std::string& path) {
    std::error_code error;  // what a pipe holds can be read only once
    if (!std::filesystem::is_regular_file(path, error)) return {};
    std::ifstream file(path, std::ios::binary);
    return formatIn(file);
}

}  // namespace hshfit::inline files
