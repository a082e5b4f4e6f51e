#include <hshfit/light/internal/hosek_wilkie_tables.h>

#include <hshfit/error.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>

namespace hshfit::inline light {
namespace {

constexpr std::size_t mostTableBytes = std::size_t{1} << 24;
constexpr std::string_view validTables =
    "ArHosekSkyModelData_RGB.h, ArHosekSkyModelData_CIEXYZ.h or ArHosekSkyModelData_Spectral.h, "
    "which the authors of the sky publish";

bool isWordCharacter(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.';
}

bool isIdentifier(std::string_view token) {
    return !token.empty() &&
           (std::isalpha(static_cast<unsigned char>(token[0])) || token[0] == '_');
}

/// The tokens of C text: words (names and numbers, with the sign in front) and single characters.
class CodeTokens {
public:
    CodeTokens(std::string_view text, const std::string& name) : text_(text), name_(name) {}

    /// The next token; empty at the end.
    std::string_view next() {
        passSpace();
        begin_ = at_;
        if (at_ == text_.size()) return {};
        if ((text_[at_] == '-' || text_[at_] == '+') && at_ + 1 < text_.size() &&
            isWordCharacter(text_[at_ + 1]))
            ++at_;
        if (!isWordCharacter(text_[at_])) return text_.substr(at_++, 1);
        while (at_ < text_.size() && (isWordCharacter(text_[at_]) || signOfExponent())) ++at_;
        return text_.substr(begin_, at_ - begin_);
    }

    [[noreturn]] void fail(const std::string& what) const {
        const auto line = 1 + std::count(text_.begin(), text_.begin() + at(begin_), '\n');
        throw InputError(fmt::format("{}, line {}: {}", name_, line, what));
    }

private:
    static std::ptrdiff_t at(std::size_t place) { return static_cast<std::ptrdiff_t>(place); }

    bool signOfExponent() const {
        const char c = text_[at_], before = text_[at_ - 1];
        return !isIdentifier(text_.substr(begin_)) && (c == '-' || c == '+') &&
               (before == 'e' || before == 'E');
    }

    /// Goes past white space, comments and the lines of the preprocessor.
    void passSpace() {
        while (at_ < text_.size()) {
            const std::string_view rest = text_.substr(at_);
            if (std::isspace(static_cast<unsigned char>(rest[0]))) {
                ++at_;
            } else if (rest[0] == '#' || rest.starts_with("//")) {
                at_ = std::min(text_.find('\n', at_), text_.size());
            } else if (rest.starts_with("/*")) {
                const std::size_t end = text_.find("*/", at_ + 2);
                at_ = end == std::string_view::npos ? text_.size() : end + 2;
            } else {
                return;
            }
        }
    }

    std::string_view text_;
    const std::string& name_;
    std::size_t at_ = 0, begin_ = 0;
};

/// The arrays of one kind of file, channel by channel: the coefficients, then the radiance.
struct ArrayLayout {
    HosekWilkieTables::Kind kind;
    std::vector<std::string> names;
};

const std::vector<ArrayLayout>& arrayLayouts() {
    static const std::vector<ArrayLayout> table = [] {
        std::vector<ArrayLayout> all{{HosekWilkieTables::Kind::rgb, {}},
                                     {HosekWilkieTables::Kind::xyz, {}},
                                     {HosekWilkieTables::Kind::spectral, {}}};
        for (const int channel : {1, 2, 3}) {
            for (const std::size_t k : {0U, 1U}) {
                const char* space = k == 0 ? "RGB" : "XYZ";
                all[k].names.push_back(fmt::format("dataset{}{}", space, channel));
                all[k].names.push_back(fmt::format("dataset{}Rad{}", space, channel));
            }
        }
        for (const double nanometres : hosekWilkieWavelengths) {
            all[2].names.push_back(fmt::format("dataset{}", nanometres));
            all[2].names.push_back(fmt::format("datasetRad{}", nanometres));
        }
        return all;
    }();
    return table;
}

bool isKnownArray(std::string_view name) {
    return std::ranges::any_of(arrayLayouts(), [&](const ArrayLayout& layout) {
        return std::ranges::find(layout.names, name) != layout.names.end();
    });
}

std::size_t arraySize(std::string_view name) {
    using Channel = HosekWilkieChannel;
    constexpr std::size_t blocks = Channel::albedos * Channel::turbidities * Channel::points;
    return name.find("Rad") == std::string_view::npos ? blocks * Channel::coefficients : blocks;
}

/// The numbers of an array after its opening brace.
std::vector<double> numbersOf(CodeTokens& tokens, const std::string& array) {
    std::vector<double> numbers;
    for (std::string_view token = tokens.next(); token != "}"; token = tokens.next()) {
        if (token.empty()) tokens.fail(fmt::format("the file ends within the array {}", array));
        if (token[0] == '+') token.remove_prefix(1);
        double value = 0;
        const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
        if (error != std::errc() || end != token.data() + token.size() || !std::isfinite(value))
            tokens.fail(fmt::format("'{}' in the array {} is no finite number",
                                    printable(shortened(token, 40)), array));
        numbers.push_back(value);
        token = tokens.next();
        if (token == "}") break;
        if (token.empty()) tokens.fail(fmt::format("the file ends within the array {}", array));
        if (token != ",")
            tokens.fail(fmt::format("'{}' in the array {} is in the place of a comma",
                                    printable(shortened(token, 40)), array));
    }
    if (numbers.size() != arraySize(array))
        tokens.fail(
            fmt::format("the array {} has {} numbers; valid: {} (2 albedos, 10 "
                        "turbidities, 6 control points{})",
                        array, numbers.size(), arraySize(array),
                        arraySize(array) > 120 ? ", 9 coefficients" : ""));
    return numbers;
}

using Arrays = std::map<std::string, std::vector<double>, std::less<>>;

/// The arrays that are known, of definitions "NAME[…] = {…}" in the text.
Arrays arraysIn(std::string_view text, const std::string& file) {
    CodeTokens tokens(text, file);
    Arrays arrays;
    std::string_view name, before;
    for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
        if (token == "[" && isIdentifier(before)) {
            name = before;
        } else if (token == ";") {
            name = {};
        } else if (token == "{" && before == "=" && isKnownArray(name)) {
            const std::string array(name);
            if (arrays.contains(array)) tokens.fail(fmt::format("a second array {}", array));
            arrays.emplace(array, numbersOf(tokens, array));
        }
        before = token;
    }
    return arrays;
}

const ArrayLayout& arrayLayoutOf(const Arrays& arrays, const std::string& file) {
    const ArrayLayout* found = nullptr;
    for (const ArrayLayout& layout : arrayLayouts()) {
        const auto has = [&](const std::string& name) { return arrays.contains(name); };
        if (std::ranges::none_of(layout.names, has)) continue;
        const auto absent = std::ranges::find_if_not(layout.names, has);
        if (absent != layout.names.end())
            throw InputError(fmt::format("{}: the array {} is missing; valid: {}", file, *absent,
                                         fmt::join(layout.names, ", ")));
        if (found)
            throw InputError(
                fmt::format("{}: has the arrays {} and {}; valid: the tables of one "
                            "kind in a file",
                            file, found->names[0], layout.names[0]));
        found = &layout;
    }
    if (!found)
        throw InputError(
            fmt::format("{}: has no tables of the Hosek-Wilkie sky, arrays such as "
                        "datasetXYZ1; valid: {}",
                        file, validTables));
    return *found;
}

}  // namespace

HosekWilkieTables hosekWilkieTablesIn(std::string_view text, const std::string& name) {
    Arrays arrays = arraysIn(text, name);
    const ArrayLayout& layout = arrayLayoutOf(arrays, name);
    HosekWilkieTables tables{.kind = layout.kind, .channels = {}};
    for (std::size_t k = 0; k < layout.names.size(); k += 2)
        tables.channels.push_back({.shape = std::move(arrays.at(layout.names[k])),
                                   .radiance = std::move(arrays.at(layout.names[k + 1]))});
    return tables;
}

HosekWilkieTables readHosekWilkieTables(const std::string& path) {
    const MappedFile file(path);
    if (file.size() > mostTableBytes)
        throw InputError(
            fmt::format("{}: has {} bytes; tables of the Hosek-Wilkie sky have at "
                        "most {}",
                        path, file.size(), mostTableBytes));
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    HosekWilkieTables tables = hosekWilkieTablesIn(text, path);
    file.checkIntact();
    return tables;
}

}  // namespace hshfit::inline light
