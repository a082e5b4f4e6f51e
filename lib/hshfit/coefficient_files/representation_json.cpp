#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/named_arrays.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::inline coefficient_files {
namespace {

using Json = nlohmann::json;
using Ordered = nlohmann::ordered_json;
using Kind = Representation::Kind;

constexpr int maxSide = 1 << 28;

Ordered describe(const std::string& name, const StoredArray& array) {
    const std::vector<std::byte> bytes = packed(array);
    return {{"name", name},
            {"shape", array.shape},
            {"precision", precisionName(array.precision)},
            {"masked", !array.kept.empty()},
            {"bytes", bytes.size()},
            {"base64", base64(bytes)}};
}

Ordered describe(const Representation& r) {
    Ordered out = {{"kind", kindName(r.kind())}};
    if (r.kind() == Kind::outgoing) out["slots"] = r.slots;
    if (r.kind() == Kind::halfway) {
        out["orders"] = {{"half", r.halfway.half},
                         {"difference", r.halfway.difference},
                         {"azimuth", r.halfway.azimuth}};
        const auto& content = *r.as<HalfwayArray>();
        out["lobe"] = {{"along", content.lobe.along},
                       {"across", content.lobe.across},
                       {"turn", content.lobe.turn},
                       {"shelf", content.lobe.shelf}};
        if (content.lobe.masked) out["lobe"]["masked"] = true;
        Ordered& ceilings = out["ceilings"] = Ordered::array();
        for (const HalfwayCeiling& each : content.ceilings)
            ceilings.push_back({{"smooth", each.smooth}, {"lobe", each.lobe}, {"top", each.top}});
    }
    if (!r.added.empty()) out["added"] = r.added;
    out["bytes"] = r.bytes();
    out["entropy_bytes"] = r.entropyBytes();
    Ordered steps = Ordered::array();
    for (const RepresentationStep& step : r.steps) {
        steps.push_back({{"what", step.what}, {"change", finiteOrNull(step.change)}});
    }
    out["steps"] = steps;
    out["arrays"] = Ordered::array();
    for (const auto& [name, array] : namedArrays(r))
        out["arrays"].push_back(describe(name, *array));
    return out;
}

Named<StoredArray> readArray(const JsonFields& fields, const std::string& file) {
    const std::string name = fields.word("name");
    StoredArray array;
    for (double side : fields.numbers("shape")) {
        if (!(side >= 0) || side > maxSide || side != std::floor(side)) {
            fields.fail("has to hold whole numbers from 0", "shape");
        }
        array.shape.push_back(static_cast<std::size_t>(side));
    }
    if (array.shape.empty() || array.shape.size() > 3) {
        fields.fail("has to have one to three sides", "shape");
    }
    const std::string precision = fields.word("precision");
    try {
        array.precision = parsePrecision(precision);
    } catch (const UsageError& error) {
        fields.fail(error.what(), "precision");
    }
    const auto bytes = static_cast<std::size_t>(fields.integer("bytes", 0, maxSide));
    const std::string text = fields.word("base64");
    const std::vector<std::byte> data = fromBase64(text, bytes);
    if (data.size() != bytes) {
        fields.fail(fmt::format("has to be base64 of {} bytes", bytes), "base64");
    }
    unpackInto(array, data, fields.flag("masked"),
               fmt::format("{}: array '{}'", file, printable(name.substr(0, 40))));
    return {name, std::move(array)};
}

/// Rows and columns of the arrays against what kind, basis, channels and slots call for.
class ShapeCheck {
public:
    ShapeCheck(const Representation& r, const JsonFields& fields) : r_(r), fields_(fields) {}

    void outgoing(std::size_t directions) const {
        const std::size_t rows = directions * r_.head.channels.count(), columns = r_.slots.size();
        if (const auto* factors = r_.as<CoefficientFactors>()) {
            const std::size_t rank = factors->left.columns();
            require(factors->left, "left", {rows, rank});
            require(factors->right, "right", {rank, columns});
            return;
        }
        require(r_.as<CoefficientArray>()->coefficients, "coefficients",
                {directions, r_.head.channels.count(), columns});
    }
    /// One value for each term and channel; the order alone says how many that are.
    void basis() const {
        constexpr std::size_t most = std::size_t{1} << 26;
        const auto functions = bases::make(r_.head.basis, r_.head.order);
        const std::size_t terms = productTermCount(*functions, symmetryOf(r_));
        const std::size_t channels = r_.head.channels.count();
        if (const auto* whole = r_.as<MatrixArray>()) {
            require(whole->matrix, "matrix", {channels, terms});
        } else if (terms > most / channels) {
            fields_.fail(fmt::format("are factors of a matrix of {} terms; at most {} are read",
                                     terms, most / channels),
                         "arrays");
        }
    }
    void slots() const {
        const auto all = static_cast<int>(r_.head.slots());
        const bool ascending =
            std::is_sorted(r_.slots.begin(), r_.slots.end(), std::less_equal<>());
        if (!ascending || (!r_.slots.empty() && (r_.slots.front() < 0 || r_.slots.back() >= all))) {
            fields_.fail(fmt::format("has to hold ascending slots below {}", all), "slots");
        }
    }

private:
    void require(const StoredArray& array, const char* name,
                 const std::vector<std::size_t>& shape) const {
        if (array.shape == shape) return;
        std::string text;
        for (std::size_t side : shape) text += fmt::format("{}{}", text.empty() ? "" : " x ", side);
        fields_.fail(fmt::format("'{}' has to be {}", name, text), "arrays");
    }

    const Representation& r_;
    const JsonFields& fields_;
};

/// Directions that the content speaks of; 0 for the forms without.
std::size_t directionsIn(const Content& content, std::size_t channels) {
    if (const auto* whole = std::get_if<CoefficientArray>(&content)) {
        return whole->coefficients.shape[0];
    }
    const auto* factors = std::get_if<CoefficientFactors>(&content);
    return factors && channels > 0 ? factors->left.shape[0] / channels : 0;
}

Content readContent(Kind kind, const JsonFields& part, const std::string& file) {
    std::vector<Named<StoredArray>> arrays;
    for (const JsonFields& array : part.objects("arrays")) arrays.push_back(readArray(array, file));
    try {
        return contentOf(kind, std::move(arrays));
    } catch (const InputError& error) {
        part.fail(printable(error.what()), "arrays");
    }
}

}  // namespace

std::string representationToJson(const Representation& r) {
    std::string out = "{\n";
    for (const auto& [key, text] : metadataOf(r.head))
        out += fmt::format("  \"{}\": {},\n", key, text);
    const std::string body = jsonText(Ordered(describe(r)), 2);
    out += "  \"representation\": " + body + "\n}\n";
    return out;
}

bool hasRepresentation(std::string_view text) {
    // A parser that keeps nothing but the top-level keys; what does not parse has none.
    bool found = false;
    const auto keys = [&](int depth, Json::parse_event_t event, Json& parsed) {
        if (depth == 1 && event == Json::parse_event_t::key) found |= parsed == "representation";
        return depth == 0;
    };
    const Json ignored = Json::parse(text.begin(), text.end(), keys, false);
    return found && !ignored.is_discarded();
}

Representation representationFromJson(std::string_view text, const std::string& file) {
    const Json root = parseJson(text, file, deepestJson);
    const JsonFields fields(root, "", file);
    const JsonFields part = fields.object("representation");
    Representation r;
    const std::string kind = part.word("kind");
    const auto kinds = {Kind::outgoing, Kind::basis, Kind::halfway};
    const auto known = std::find_if(kinds.begin(), kinds.end(),
                                    [&](Kind candidate) { return kindName(candidate) == kind; });
    if (known == kinds.end()) part.fail("has to be 'outgoing', 'basis' or 'halfway'", "kind");
    r.content = readContent(*known, part, file);
    r.head =
        readHead(fields, directionsIn(r.content, root.value("channels", Json::array()).size()));
    if (part.has("added")) r.added = part.word("added");
    for (const JsonFields& step : part.objects("steps")) {
        r.steps.push_back({step.word("what"), step.numberOrNull("change").value_or(
                                                  std::numeric_limits<double>::quiet_NaN())});
    }
    if (r.kind() == Kind::outgoing) {
        for (double slot : part.numbers("slots")) r.slots.push_back(static_cast<int>(slot));
        const ShapeCheck check(r, part);
        check.slots();
        check.outgoing(r.head.outgoing.size());
    }
    if (r.kind() == Kind::halfway) {
        const JsonFields orders = part.object("orders");
        r.halfway = {.half = orders.integer("half", 1, 256),
                     .difference = orders.integer("difference", 1, 256),
                     .azimuth = orders.integer("azimuth", 1, 256)};
        auto& content = *r.as<HalfwayArray>();
        if (!part.has("lobe")) {
            part.fail(
                "is missing: files of versions before 2 hold another halfway form; project "
                "the material again",
                "lobe");
        }
        const JsonFields lobe = part.object("lobe");
        content.lobe = {lobe.number("along"), lobe.number("across"), lobe.number("turn"),
                        lobe.number("shelf"), lobe.has("masked") && lobe.flag("masked")};
        for (const JsonFields& each : part.objects("ceilings")) {
            content.ceilings.push_back(
                {each.number("smooth"), each.number("lobe"), each.number("top")});
        }
        if (content.ceilings.size() != r.head.channels.count())
            part.fail("has to have one object a channel", "ceilings");
    }
    if (r.kind() != Kind::halfway && r.head.basis.empty()) fields.fail("is missing", "basis");
    if (r.kind() == Kind::basis) ShapeCheck(r, part).basis();
    return r;
}

}  // namespace hshfit::inline coefficient_files
