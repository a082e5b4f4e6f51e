#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/version.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::inline coefficient_files {
namespace {

using Json = nlohmann::json;
using Ordered = nlohmann::ordered_json;  // what is written keeps the order of this source

constexpr int formatVersion = 1;
constexpr const char* slotRule = "l*(l+1)+m";
// The constants of OutgoingSet that a reader needs in order to rebuild the directions.
constexpr int insetTexels = 1;
constexpr double horizonRingDegrees = 1;
constexpr int maxMapSide = 1 << 16;

std::string text(const Ordered& value) {
    return jsonText(value);
}

Ordered describe(const OutgoingSet& set) {
    if (set.directions.empty()) return {{"map", "none"}};
    switch (set.map) {
        case OutgoingSet::Map::parabolic:
            return {{"map", "parabolic"},
                    {"width", set.width},
                    {"height", set.height},
                    {"inset_texels", insetTexels},
                    {"horizon_ring_degrees", horizonRingDegrees}};
        case OutgoingSet::Map::elevations:
            return {{"map", "elevations"},
                    {"count", set.width},
                    {"spacing", "tan(theta/2) = k/(count - 1/2)"},
                    {"horizon_ring_degrees", horizonRingDegrees}};
        case OutgoingSet::Map::direction:
            break;
    }
    const Direction& d = set.directions.at(0);
    return {{"map", "direction"},
            {"theta", tidyDegrees(polarAngle(d))},
            {"phi", tidyDegrees(azimuth(d))},
            {"direction", {d.x, d.y, d.z}}};
}

const char* kindName(Channels::Kind kind) {
    switch (kind) {
        case Channels::Kind::grey:
            return "grey";
        case Channels::Kind::rgb:
            return "rgb";
        case Channels::Kind::named:
            return "named";
        case Channels::Kind::spectral:
            break;
    }
    return "spectral";
}

using Fields = JsonFields;

std::vector<double> readWavelengths(const Fields& root) {
    std::vector<double> nm = root.numbers("wavelengths_nm");
    if (nm.empty() || nm.front() <= 0 ||
        !std::is_sorted(nm.begin(), nm.end(), std::less_equal<>())) {
        root.fail("has to hold positive wavelengths in ascending order", "wavelengths_nm");
    }
    return nm;
}

/// Letters and digits alone, because the names become names of picture channels.
std::vector<std::string> readQuantities(const Fields& root) {
    std::vector<std::string> quantities = root.words("quantities");
    const auto isName = [](const std::string& word) {
        constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyz0123456789";
        return !word.empty() && word.size() <= 32 &&
               word.find_first_not_of(allowed) == std::string::npos;
    };
    const std::set<std::string> different(quantities.begin(), quantities.end());
    if (quantities.empty() || different.size() < quantities.size() ||
        !std::all_of(quantities.begin(), quantities.end(), isName))
        root.fail("has to hold different names of small letters and digits", "quantities");
    return quantities;
}

Channels readChannels(const Fields& root) {
    const std::string kind = root.word("channel_kind");
    Channels channels;
    if (kind == "rgb") {
        channels = Channels::rgb();
    } else if (kind == "spectral") {
        channels = Channels::spectral(readWavelengths(root));
    } else if (kind == "named") {
        channels = Channels::named(readQuantities(root), root.has("wavelengths_nm")
                                                             ? readWavelengths(root)
                                                             : std::vector<double>{});
    } else if (kind != "grey") {
        root.fail("has to be 'grey', 'rgb', 'spectral' or 'named'", "channel_kind");
    }
    const Json& names = root.at("channels");
    if (!names.is_array() || names.size() != channels.count()) {
        root.fail(fmt::format("has to be an array of {} names", channels.count()), "channels");
    }
    // Wavelengths are told by their numbers; another order of R, G, B would swap colours unseen.
    if (channels.kind != Channels::Kind::spectral && names != Json(channels.names())) {
        root.fail(fmt::format("has to be {} for '{}'", text(channels.names()), kind), "channels");
    }
    return channels;
}

OutgoingSet readDirection(const Fields& fields) {
    const double theta = fields.number("theta"), phi = fields.number("phi");
    if (theta < 0 || theta >= 90) fields.fail("has to be at least 0 and less than 90", "theta");
    if (std::abs(phi) > 360) fields.fail("has to be from -360 to 360", "phi");
    OutgoingSet set;
    Direction d = directionFromAngles(radians(theta), radians(phi));
    if (fields.has("direction")) {
        const auto v = fields.numbers("direction");
        if (v.size() != 3) fields.fail("has to be [x, y, z]", "direction");
        const double off = std::hypot(v[0] - d.x, v[1] - d.y, v[2] - d.z);
        if (!(off < 1e-6) || v[2] <= 0) {
            fields.fail("has to be the unit vector of theta and phi, above the horizon",
                        "direction");
        }
        d = {v[0], v[1], v[2]};
    }
    set.directions = {d};
    set.solidAngles = {1};
    return set;
}

OutgoingSet readOutgoing(const Fields& fields, std::size_t present) {
    const std::string map = fields.word("map");
    const auto requireCount = [&](std::size_t stated) {
        if (stated == present) return;
        const std::string found = present == 0 ? "'coefficients' is missing or empty"
                                               : fmt::format("the file has {}", present);
        fields.fail(fmt::format("states {} outgoing directions, but {}", stated, found));
    };
    const auto requireRing = [&] {
        if (fields.number("horizon_ring_degrees") != horizonRingDegrees) {
            fields.fail(fmt::format("has to be {}", horizonRingDegrees), "horizon_ring_degrees");
        }
    };
    try {
        if (map == "parabolic") {
            const int width = fields.integer("width", 1, maxMapSide);
            const int height = fields.integer("height", 1, maxMapSide);
            requireCount(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
            requireRing();
            if (fields.number("inset_texels") != insetTexels) {
                fields.fail(fmt::format("has to be {}", insetTexels), "inset_texels");
            }
            return OutgoingSet::parabolic(width, height);
        }
        if (map == "elevations") {
            const int count = fields.integer("count", 1, maxMapSide);
            requireCount(static_cast<std::size_t>(count));
            requireRing();
            return OutgoingSet::elevations(count);
        }
    } catch (const UsageError& error) {  // a size that the set itself refuses
        fields.fail(fmt::format("is invalid: {}", error.what()));
    }
    if (map == "none" && present == 0) return {.directions = {}, .solidAngles = {}};
    if (map != "direction") {
        fields.fail("has to be 'parabolic', 'elevations' or 'direction'", "map");
    }
    requireCount(1);
    return readDirection(fields);
}

Energy readEnergy(const Fields& root) {
    Energy energy;
    const auto value = root.numberOrNull("energy");
    energy.finite = value.has_value();
    energy.value = value.value_or(nullNumber);
    energy.error = root.numberOrNull("energy_error").value_or(nullNumber);
    if (root.has("energy_reason")) energy.reason = root.word("energy_reason");
    return energy;
}

}  // namespace

void requireFormat(const JsonFields& root, std::string_view format, int newest) {
    if (const std::string named = root.word("format"); named != format) {
        root.fail(fmt::format("is '{}'; it has to be '{}'", named.substr(0, 40), format), "format");
    }
    const int version = root.integer("version", 1, std::numeric_limits<int>::max());
    if (version > newest) {
        root.fail(fmt::format("is {}: written by a newer hshfit; this one reads version {}",
                              version, newest),
                  "version");
    }
}

double tidyDegrees(double angle) {
    const double rounded = std::round(degrees(angle) * 1e10) / 1e10;
    return rounded == 0 ? 0 : rounded;
}

std::string basisText(const BasisName& basis) {
    return text({{"name", basis.name},
                 {"order", basis.order},
                 {"condon_shortley", basis.condonShortley},
                 {"index", slotRule}});
}

BasisName readBasisName(const Fields& basis) {
    BasisName result;
    result.name = basis.word("name");
    const auto known = bases::catalog();
    const auto entry = std::find_if(known.begin(), known.end(), [&](const bases::Entry& candidate) {
        return candidate.name == result.name;
    });
    if (entry == known.end()) {
        std::string names;
        for (const auto& candidate : known) names += fmt::format(" {}", candidate.name);
        basis.fail(fmt::format("is '{}'; known:{}", result.name.substr(0, 40), names), "name");
    }
    result.order = basis.integer("order", 1, entry->maxOrder);
    result.condonShortley = basis.flag("condon_shortley");
    if (basis.word("index") != slotRule) {
        basis.fail(fmt::format("has to be '{}'", slotRule), "index");
    }
    return result;
}

CoefficientMetadata metadataOf(const CoefficientHead& c) {
    CoefficientMetadata metadata;
    const auto add = [&](const char* key, const Ordered& value) {
        metadata.emplace_back(key, text(value));
    };
    add("format", coefficientFormat);
    add("version", formatVersion);
    add("generator", c.generator.empty() ? std::string("hshfit ") + version : c.generator);
    add("source", {{"brdf", c.source}});
    if (!c.basis.empty()) {
        metadata.emplace_back("basis", basisText({c.basis, c.order, c.condonShortley}));
    }
    add("quantity", quantityName(c.quantity));
    add("channels", c.channels.names());
    add("channel_kind", kindName(c.channels.kind));
    if (!c.channels.quantities.empty()) add("quantities", c.channels.quantities);
    if (!c.channels.wavelengths.empty()) add("wavelengths_nm", c.channels.wavelengths);
    add("outgoing", describe(c.outgoing));
    add("symmetry",
        {{"isotropic", c.isotropic}, {"bilateral", c.bilateral}, {"reciprocal", c.reciprocal}});
    const bool exists = c.energy.finite && std::isfinite(c.energy.value);
    add("energy", exists ? Ordered(c.energy.value) : Ordered(nullptr));
    add("energy_error", finiteOrNull(c.energy.error));
    if (!exists) add("energy_reason", c.energy.reason);
    add("error", finiteOrNull(c.error));
    add("tolerance", finiteOrNull(c.tolerance));
    if (c.leastSquares) {
        add("least_squares", {{"regularisation", c.leastSquares->regularisation},
                              {"kernel_degrees", c.leastSquares->kernelDegrees},
                              {"condition", c.leastSquares->condition},
                              {"residual", c.leastSquares->residual},
                              {"samples", c.leastSquares->samples}});
    }
    return metadata;
}

CoefficientHead readSharedHead(const Fields& root, std::size_t outgoingCount) {
    CoefficientHead result;
    result.generator = root.word("generator");
    result.source = root.object("source").word("brdf");
    // Without coefficients per outgoing direction there may be no basis.
    if (outgoingCount > 0 || root.has("basis")) {
        const BasisName basis = readBasisName(root.object("basis"));
        result.basis = basis.name;
        result.order = basis.order;
        result.condonShortley = basis.condonShortley;
    }
    const std::string quantity = root.word("quantity");
    result.quantity =
        quantity == quantityName(Quantity::brdfCosine) ? Quantity::brdfCosine : Quantity::brdf;
    if (quantity != quantityName(result.quantity)) {
        root.fail("has to be 'brdf' or 'brdf_cosine'", "quantity");
    }
    result.channels = readChannels(root);
    result.outgoing = readOutgoing(root.object("outgoing"), outgoingCount);
    const Fields symmetry = root.object("symmetry");
    result.isotropic = symmetry.flag("isotropic");
    result.bilateral = symmetry.flag("bilateral");
    result.reciprocal = symmetry.flag("reciprocal");
    result.energy = readEnergy(root);
    result.error = root.numberOrNull("error").value_or(nullNumber);
    return result;
}

CoefficientHead readHead(const Fields& root, std::size_t outgoingCount) {
    requireFormat(root, coefficientFormat, formatVersion);
    CoefficientHead result = readSharedHead(root, outgoingCount);
    result.tolerance = root.numberOrNull("tolerance").value_or(nullNumber);
    if (root.has("least_squares")) {
        const Fields fit = root.object("least_squares");
        result.leastSquares = LeastSquaresNote{.regularisation = fit.number("regularisation"),
                                               .kernelDegrees = fit.number("kernel_degrees"),
                                               .condition = fit.number("condition"),
                                               .residual = fit.number("residual"),
                                               .samples = static_cast<std::size_t>(fit.integer(
                                                   "samples", 0, std::numeric_limits<int>::max()))};
    }
    return result;
}

void requireFinite(const Coefficients& c) {
    const auto bad = std::find_if_not(c.values.begin(), c.values.end(),
                                      [](double value) { return std::isfinite(value); });
    if (bad == c.values.end()) return;
    const auto at = static_cast<std::size_t>(bad - c.values.begin());
    throw NumericError(fmt::format(
        "coefficient {} of channel {} at outgoing direction {} is not finite; nothing is written",
        at % c.slots(), at / c.slots() % c.channels.count(), at / c.slots() / c.channels.count()));
}

}  // namespace hshfit::inline coefficient_files
