#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/printable.h>

#include <cmath>
#include <set>

#include <fmt/compile.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::inline coefficient_files {
namespace {

using Json = nlohmann::json;

/// Takes the coefficients out of the parser's stream, so that they never become a tree of JSON
/// values, and holds their shape, nesting and keys to the rules as they come.
class Collector {
public:
    explicit Collector(const std::string& file) : file_(file) {}

    /// nlohmann's parser callback; false drops the value from the tree.
    bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
        using Event = Json::parse_event_t;
        if (depth > maxDepth) fail("is nested too deeply");
        switch (event) {
            case Event::object_start:
                if (level_ > 0 || awaited_) failShape();
                keys_.emplace_back();
                return true;
            case Event::object_end:
                keys_.pop_back();
                return true;
            case Event::key:
                return takeKey(depth, parsed.get_ref<const std::string&>());
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
    static constexpr int maxDepth = 8;

    [[noreturn]] void fail(std::string_view what) const {
        throw InputError(fmt::format("{}: {}", file_, printable(what)));
    }
    [[noreturn]] void failShape() const {
        fail("'coefficients' has to be [outgoing][channel][slot], arrays of numbers");
    }
    std::string position() const {
        return fmt::format("coefficients[{}][{}][{}]", outgoing_, rows_, countInRow_);
    }

    bool takeKey(int depth, const std::string& key) {
        if (!keys_.back().insert(key).second) {
            fail(fmt::format("the key '{}' appears twice", key.substr(0, 40)));
        }
        if (depth == 1 && key == "coefficients") awaited_ = true;
        return true;
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
    std::vector<std::set<std::string>> keys_;
    bool awaited_ = false;
    int level_ = 0;
    std::size_t outgoing_ = 0, rows_ = 0, countInRow_ = 0, channels_ = 0, slots_ = 0;
};

/// Coefficients of a file in another form, where it holds those and nothing else.
Coefficients decodedOrRefused(std::string_view text, const std::string& file) {
    const Representation r = representationFromJson(text, file);
    if (r.kind == Representation::Kind::outgoing && r.added.empty()) return decoded(r);
    throw InputError(fmt::format(
        "{}: holds the form '{}'{}, not coefficients per outgoing direction alone; project it to a "
        "file of its own first",
        file, kindName(r.kind), r.added.empty() ? "" : fmt::format(" with {} added", r.added)));
}

/// "[json.exception.parse_error.101] parse error at line 1, …" without the bracket and in bounds.
std::string reasonOf(const Json::exception& error) {
    std::string reason = error.what();
    if (const auto end = reason.find("] "); end != std::string::npos) reason.erase(0, end + 2);
    if (reason.size() > 160) reason = reason.substr(0, 160) + "…";
    return reason;
}

constexpr std::size_t longestNumber = sizeof("-1.7976931348623157e+308");  // and the comma

/// Straight into memory of the largest size that they can have, with a format known when this is
/// compiled: less than half the time of an appending iterator.
void appendNumbers(const double* values, std::size_t count, std::string& out) {
    const std::size_t start = out.size();
    out.resize(start + count * longestNumber);
    char* at = out.data() + start;
    for (std::size_t k = 0; k < count; ++k) {
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

}  // namespace

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
            appendNumbers(c.at(o, channel), c.slots(), out);
            out += ']';
        }
        out += o + 1 < c.outgoing.size() ? "],\n" : "]\n";
    }
    out += "  ]\n}\n";
    return out;
}

Coefficients coefficientsFromJson(std::string_view text, const std::string& file) {
    Collector collector(file);
    Json tree;
    try {
        tree = Json::parse(text.begin(), text.end(), std::ref(collector));
    } catch (const Json::exception& error) {
        throw InputError(fmt::format("{}: not valid JSON: {}", file, printable(reasonOf(error))));
    }
    const std::string metadata = tree.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (tree.contains("representation")) return decodedOrRefused(text, file);
    Coefficients result = coefficientsFromMetadata(metadata, collector.outgoing(), file);
    if (collector.outgoing() == 0) collector.refuseMissing();
    collector.requireShape(result);
    result.values = std::move(collector.values);
    return result;
}

}  // namespace hshfit::inline coefficient_files
