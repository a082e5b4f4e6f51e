#include <brdfs/fit/contributions.h>

#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace hshfit::brdfs {
namespace {

using Kind = ActsOn::Kind;
constexpr ActsOn kinds[] = {{Kind::scale, "scale", "1"},
                            {Kind::linearity, "linearity", "1"},
                            {Kind::offset, "offset", "1/sr"},
                            {Kind::dark, "dark", "1/sr"},
                            {Kind::incidence, "incidence", "degrees"},
                            {Kind::detector, "detector", "degrees"}};
const ErrorDistribution distributions[] = {{"normal", 0},
                                           {"rectangular", std::sqrt(3.0)},
                                           {"triangular", std::sqrt(6.0)},
                                           {"u-shaped", std::numbers::sqrt2}};

constexpr std::array<std::string_view, 7> fieldNames{
    "name", "type", "distribution", "half_width", "standard_uncertainty", "degrees_of_freedom",
    "on"};

/// A number above 0, where allowed as a share with %; NaN for anything else.
double positiveNumber(std::string_view text, bool share) {
    double value = 0;
    if (!takeNumber(text, value) || !(value > 0) || !std::isfinite(value)) return nullNumber;
    if (share && text == "%") return value / 100;
    return text.empty() ? value : nullNumber;
}

/// One contribution as a file has it, and its place for messages.
struct Fields {
    std::string where;
    std::map<std::string, std::string, std::less<>> texts;

    [[noreturn]] void fail(std::string_view field, std::string_view what) const {
        throw InputError(fmt::format("{}: {} {}", where, field, what));
    }
    void set(const std::string& name, std::string text) {
        if (std::ranges::find(fieldNames, name) == fieldNames.end())
            throw InputError(fmt::format(
                "{}: {}", where, spelling::unknown("field", printable(name), fieldNames).what()));
        if (!text.empty()) texts[name] = std::move(text);
    }
    std::string text(std::string_view name, std::string_view otherwise = {}) const {
        const auto found = texts.find(name);
        return found == texts.end() ? std::string(otherwise) : found->second;
    }
    double number(std::string_view name, bool share) const {
        const double value = positiveNumber(text(name), share);
        if (std::isnan(value))
            fail(name, fmt::format("is '{}', expected a number above 0{}", printable(text(name)),
                                   share ? ", such as 0.8%" : ""));
        return value;
    }
    template <class Rows>
    auto rowOf(std::string_view name, const Rows& rows, std::string_view otherwise) const {
        const std::string own = text(name, otherwise);
        const auto row = std::ranges::find_if(rows, [&](const auto& r) { return r.name == own; });
        if (row == std::end(rows))
            throw InputError(fmt::format(
                "{}: {}", where,
                spelling::unknown(name, printable(own), spelling::namesOf(rows)).what()));
        return *row;
    }
};

Contribution contributionOf(const Fields& fields) {
    Contribution result;
    result.name = fields.text("name");
    if (result.name.empty()) fields.fail("name", "is missing");
    const std::string type = fields.text("type", "B");
    if (type != "A" && type != "B")
        fields.fail("type", fmt::format("is '{}', expected A or B", printable(type)));
    result.type = type.front();
    const ErrorDistribution distribution =
        fields.rowOf("distribution", distributions, distributions[0].name);
    result.distribution = distribution.name;
    if (fields.text("on").empty())
        fields.fail("on", "is missing; expected the quantity that has the error");
    result.on = fields.rowOf("on", kinds, "");
    const bool width = fields.texts.contains("half_width"), share = result.on.unit == "1";
    if (width == fields.texts.contains("standard_uncertainty"))
        fields.fail("half_width", "and standard_uncertainty: expected one of the two");
    if (width && !(distribution.divisor > 0))
        fields.fail("half_width",
                    "says nothing of a normal distribution; expected standard_uncertainty");
    result.standard = width ? fields.number("half_width", share) / distribution.divisor
                            : fields.number("standard_uncertainty", share);
    if (fields.texts.contains("degrees_of_freedom") && fields.text("degrees_of_freedom") != "inf")
        result.degrees = fields.number("degrees_of_freedom", false);
    return result;
}

std::vector<Fields> fieldsOfJson(std::string_view text, const std::string& where) {
    constexpr int deepest = 4;
    const nlohmann::json json = parseJson(text, where, deepest);
    const JsonFields root(json, "", where);
    if (root.word("format") != "hshfit-budget") root.fail("has to be hshfit-budget", "format");
    root.integer("version", 1, 1);
    std::vector<Fields> result;
    for (const JsonFields& own : root.objects("contributions")) {
        result.push_back({fmt::format("{}: contribution {}", where, result.size() + 1), {}});
        for (const auto& [name, value] : own.json().items()) {
            if (!value.is_string() && !value.is_number())
                result.back().fail(printable(name), "has to be a word or a number");
            result.back().set(name, value.is_string() ? value.template get<std::string>()
                                                      : fmt::format("{}", value.get<double>()));
        }
    }
    return result;
}

std::vector<std::string> cellsOf(std::string_view line) {
    std::vector<std::string> cells;
    for (std::size_t first = 0; first <= line.size();) {
        const std::size_t last = std::min(line.find(',', first), line.size());
        cells.emplace_back(withoutBlanks(line.substr(first, last - first)));
        first = last + 1;
    }
    return cells;
}

std::vector<Fields> fieldsOfCsv(std::string_view text, const std::string& where) {
    TextReader reader(text, where);
    if (!reader.next()) throw reader.error("expected a line with the names of the columns");
    const std::vector<std::string> names = cellsOf(reader.line());
    std::vector<Fields> result;
    const auto here = [&] { return fmt::format("{}: line {}", where, reader.lineNumber()); };
    for (const std::string& name : names) Fields{here(), {}}.set(name, "");
    while (reader.next()) {
        if (reader.blank()) continue;
        const std::vector<std::string> cells = cellsOf(reader.line());
        if (cells.size() != names.size())
            throw reader.error(fmt::format("{} cells, but the first line names {} columns",
                                           cells.size(), names.size()));
        result.push_back({here(), {}});
        for (std::size_t i = 0; i < names.size(); ++i) result.back().set(names[i], cells[i]);
    }
    return result;
}

}  // namespace

std::span<const ActsOn> contributionKinds() {
    return kinds;
}

std::span<const ErrorDistribution> errorDistributions() {
    return distributions;
}

Contribution parseCalibration(std::string_view text) {
    Contribution result;
    result.name = "calibration";
    result.standard = positiveNumber(text, true);
    if (!(result.standard < 1))
        throw UsageError(fmt::format(
            "'{}' is no uncertainty of a calibration; valid: a relative standard uncertainty above "
            "0 and below 100 %, such as 0.8%",
            text));
    return result;
}

std::vector<Contribution> readContributions(const std::string& path) {
    std::vector<Contribution> result;
    withTextFile(path, [&](std::string_view text, const std::string& where) {
        const std::size_t first = text.find_first_not_of(" \t\r\n");
        const bool json = first != std::string_view::npos && text[first] == '{';
        for (const Fields& own : json ? fieldsOfJson(text, where) : fieldsOfCsv(text, where))
            result.push_back(contributionOf(own));
        if (result.empty()) throw InputError(fmt::format("{}: has no contribution", where));
    });
    return result;
}

}  // namespace hshfit::brdfs
