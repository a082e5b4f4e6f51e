#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>

#include <cmath>
#include <functional>

#include <fmt/compile.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::inline coefficient_files {
namespace {

using Json = nlohmann::json;

/// Takes the coefficients out of the parser's stream, so that they never become a tree of JSON
/// values, and holds their shape to the rules as they come.
class Collector {
public:
    explicit Collector(const std::string& file) : file_(file) {}

    /// A JsonFilter; false drops the value from the tree.
    bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
        using Event = Json::parse_event_t;
        switch (event) {
            case Event::object_start:
                if (level_ > 0 || awaited_) failShape();
                return true;
            case Event::object_end:
                return true;
            case Event::key:
                if (depth == 1 && parsed == "coefficients") awaited_ = true;
                return true;
            case Event::array_start:
                if (level_ == 0 && !awaited_) return true;
                awaited_ = false;
                if (++level_ > 3) failShape();
                if (level_ == 3) countInRow_ = 0;
                return true;
            case Event::array_end:
                return level_ == 0 || endArray();
            case Event::value:
                break;
        }
        if (level_ == 0 && !awaited_) return true;
        if (level_ != 3) failShape();
        if (!parsed.is_number()) fail(fmt::format("{} is not a number", position()));
        values.push_back(parsed.get<double>());
        if (!std::isfinite(values.back())) fail(fmt::format("{} is not finite", position()));
        ++countInRow_;
        return false;
    }

    void requireShape(const Coefficients& c) const {
        if (channels_ != c.channels.count()) {
            fail(
                fmt::format("'coefficients' has {} channels for each outgoing direction; "
                            "'channels' names {}",
                            channels_, c.channels.count()));
        }
        if (slots_ != c.slots()) {
            fail(fmt::format("'coefficients' has {} values for each channel; order {} needs {}",
                             slots_, c.order, c.slots()));
        }
    }

    [[noreturn]] void refuseMissing() const { fail("'coefficients' is missing or empty"); }

    std::vector<double> values;
    std::size_t outgoing() const { return outgoing_; }

private:
    [[noreturn]] void fail(std::string_view what) const {
        throw InputError(fmt::format("{}: {}", file_, printable(what)));
    }
    [[noreturn]] void failShape() const {
        fail("'coefficients' has to be [outgoing][channel][slot], arrays of numbers");
    }
    std::string position() const {
        return fmt::format("coefficients[{}][{}][{}]", outgoing_, rows_, countInRow_);
    }

    /// Rows and channels have to be as many everywhere as in the first place.
    bool endArray() {
        if (level_ == 3) {
            if (outgoing_ == 0 && rows_ == 0) slots_ = countInRow_;
            if (countInRow_ != slots_) {
                fail(fmt::format("coefficients[{}][{}] has {} values, those before it {}",
                                 outgoing_, rows_, countInRow_, slots_));
            }
            ++rows_;
        } else if (level_ == 2) {
            if (outgoing_ == 0) channels_ = rows_;
            if (rows_ != channels_) {
                fail(fmt::format("coefficients[{}] has {} channels, those before it {}", outgoing_,
                                 rows_, channels_));
            }
            rows_ = 0;
            ++outgoing_;
        }
        --level_;
        return level_ == 0;  // one empty array stays in the tree
    }

    const std::string& file_;
    bool awaited_ = false;
    int level_ = 0;
    std::size_t outgoing_ = 0, rows_ = 0, countInRow_ = 0, channels_ = 0, slots_ = 0;
};

/// The coefficients in a file of another form, if it holds coefficients per outgoing direction and
/// nothing else; throws InputError otherwise.
Coefficients decodedOrRefused(std::string_view text, const std::string& file) {
    const Representation r = representationFromJson(text, file);
    if (r.kind() == Representation::Kind::outgoing && r.added.empty()) return decoded(r);
    throw InputError(fmt::format(
        "{}: holds the form '{}'{}, not coefficients per outgoing direction alone; project it to a "
        "file of its own first",
        file, kindName(r.kind()), r.added.empty() ? "" : fmt::format(" with {} added", r.added)));
}

constexpr std::size_t longestNumber = sizeof("-1.7976931348623157e+308");  // and the comma

}  // namespace

/// Straight into memory of the largest size that they can have, with a format known when this is
/// compiled: less than half the time of an appending iterator.
void appendJsonNumbers(std::span<const double> values, std::string& out) {
    const std::size_t start = out.size();
    out.resize(start + values.size() * longestNumber);
    char* at = out.data() + start;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (k > 0) *at++ = ',';
        // "-0" would come back as the integer 0.
        if (values[k] == 0 && std::signbit(values[k])) {
            at = fmt::format_to(at, FMT_COMPILE("-0.0"));
        } else {
            at = fmt::format_to(at, FMT_COMPILE("{}"), values[k]);
        }
    }
    out.resize(static_cast<std::size_t>(at - out.data()));
}

std::string coefficientsToJson(const Coefficients& c) {
    requireFinite(c);
    std::string out = "{\n";
    for (const auto& [key, text] : metadataOf(c)) {
        out += fmt::format("  \"{}\": {},\n", key, text);
    }
    out += "  \"coefficients\": [\n";
    // Pages that the numbers do not reach are never touched.
    out.reserve(out.size() + c.values.size() * longestNumber + c.outgoing.size() * 64);
    for (std::size_t o = 0; o < c.outgoing.size(); ++o) {
        for (std::size_t channel = 0; channel < c.channels.count(); ++channel) {
            out += channel == 0 ? "    [[" : ",\n     [";
            appendJsonNumbers({c.at(o, channel), c.slots()}, out);
            out += ']';
        }
        out += o + 1 < c.outgoing.size() ? "],\n" : "]\n";
    }
    out += "  ]\n}\n";
    return out;
}

Coefficients coefficientsFromJson(std::string_view text, const std::string& file) {
    Collector collector(file);
    const Json tree = parseJson(text, file, deepestJson, std::ref(collector));
    if (tree.contains("representation")) return decodedOrRefused(text, file);
    Coefficients result{readHead(JsonFields(tree, "", file), collector.outgoing())};
    if (collector.outgoing() == 0) collector.refuseMissing();
    collector.requireShape(result);
    result.values = std::move(collector.values);
    return result;
}

}  // namespace hshfit::inline coefficient_files
