#include <hshfit/bases/catalog.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/pages/report.h>
#include <hshfit/version.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include <nlohmann/json.hpp>

namespace hshfit::inline pages {
namespace {

using Json = nlohmann::ordered_json;

Json outgoingJson(const OutgoingSet& set) {
    switch (set.map) {
        case OutgoingSet::Map::parabolic:
            return {{"map", "parabolic"}, {"width", set.width}, {"height", set.height}};
        case OutgoingSet::Map::elevations:
            return {{"map", "elevations"}, {"count", set.width}};
        case OutgoingSet::Map::direction:
            break;
    }
    // spec() rounds to the digits that survive the way through a unit vector.
    const std::string spec = set.spec();
    const std::size_t comma = spec.find(',');
    return {{"theta", Json::parse(spec.substr(0, comma))},
            {"phi", Json::parse(spec.substr(comma + 1))}};
}

Json energyJson(const Energy& energy) {
    const bool exists = energy.finite && std::isfinite(energy.value);
    Json json = {{"value", exists ? Json(energy.value) : Json(nullptr)},
                 {"error", exists ? finiteOrNull(energy.error) : Json(nullptr)},
                 {"finite", exists}};
    if (!exists) json["reason"] = energy.reason;
    return json;
}

Json curveJson(const ReportCurve& curve) {
    Json points = Json::array();
    for (const ReportPoint& point : curve.points) {
        points.push_back({{"order", point.order},
                          {"coefficients", point.coefficients},
                          {"slots", point.slots},
                          {"accuracy", finiteOrNull(point.accuracy)}});
    }
    Json json = {{"basis", curve.basis}};
    if (curve.bestTerms) json["selection"] = "best_terms";
    if (curve.error) json["error"] = finiteOrNull(*curve.error);
    if (curve.energy) {
        json["inner_product"] = "projected_solid_angle";
        json["energy"] = energyJson(*curve.energy);
    }
    json["points"] = std::move(points);
    return json;
}

Json entryJson(const ReportEntry& entry) {
    Json curves = Json::array();
    for (const ReportCurve& curve : entry.curves) curves.push_back(curveJson(curve));
    Json json = {{"brdf", entry.brdf},
                 {"quantity", quantityName(entry.quantity)},
                 {"outgoing", outgoingJson(entry.outgoing)},
                 {"channels", entry.channels.names()},
                 {"condon_shortley", entry.condonShortley},
                 {"energy", energyJson(entry.energy)},
                 {"error", finiteOrNull(entry.error)},
                 {"tolerance", finiteOrNull(entry.tolerance)},
                 {"evaluations", entry.evaluations},
                 {"curves", std::move(curves)}};
    if (!entry.better.empty()) json["better"] = entry.better;
    return json;
}

ReportCurve curveOf(const Projection& projection, const Energy& reference) {
    const Coefficients& c = projection.coefficients;
    const auto basis = bases::make(c.basis, c.order);
    ReportCurve curve{.basis = c.basis, .points = {}, .energy = {}, .error = {}};
    const Energy* energy = &reference;
    if (basis->inner() != Basis::Inner::solidAngle) {
        curve.energy = c.energy;
        energy = &c.energy;
    }
    for (int order = 1; order <= c.order; ++order) {
        ReportPoint point{.order = order,
                          .coefficients = basis->functionCount(order),
                          .slots = order * order,
                          .accuracy = {}};
        const double accuracy =
            projection.captured.at(static_cast<std::size_t>(order) - 1) / energy->value;
        if (energy->finite && std::isfinite(accuracy)) point.accuracy = accuracy;
        curve.points.push_back(point);
    }
    return curve;
}

}  // namespace

ReportEntry reportEntry(std::span<const Projection> projections) {
    assert(!projections.empty());
    const auto solidAngle = [](const Projection& projection) {
        const Coefficients& c = projection.coefficients;
        return bases::make(c.basis, c.order)->inner() == Basis::Inner::solidAngle;
    };
    const auto found = std::find_if(projections.begin(), projections.end(), solidAngle);
    // Without such a basis the energy shown is the first projection's, which its own curve then
    // repeats.
    const Projection& first = found != projections.end() ? *found : projections.front();
    const Coefficients& c = first.coefficients;
    ReportEntry entry{.brdf = c.source,
                      .quantity = c.quantity,
                      .outgoing = c.outgoing,
                      .channels = c.channels,
                      .condonShortley = c.condonShortley,
                      .energy = c.energy,
                      .curves = {},
                      .error = c.error,
                      .tolerance = c.tolerance,
                      .evaluations = first.evaluations};
    for (const Projection& projection : projections) {
        if (projections.size() > 1 && projection.coefficients.error >= entry.error)
            entry.errorOf = projection.coefficients.basis;
        entry.error = std::max(entry.error, projection.coefficients.error);
        entry.evaluations = std::max(entry.evaluations, projection.evaluations);
        entry.curves.push_back(curveOf(projection, entry.energy));
    }
    return entry;
}

ReportCurve waveletCurve(const wavelets::SliceCurve* slices, const Energy& energy, int maxOrder) {
    ReportCurve curve{.basis = std::string(wavelets::sohoName),
                      .points = {},
                      .energy = {},
                      .bestTerms = true,
                      .error = {}};
    if (slices) curve.error = slices->error;
    for (int order = 1; order <= maxOrder; ++order) {
        const int terms = order * order;
        ReportPoint point{.order = order, .coefficients = terms, .slots = terms, .accuracy = {}};
        if (slices && energy.finite && energy.value > 0) {
            point.accuracy = slices->captured.at(static_cast<std::size_t>(terms)) / energy.value;
        }
        curve.points.push_back(point);
    }
    return curve;
}

std::optional<ReportPoint> firstReaching(const ReportCurve& curve, double accuracy) {
    for (const ReportPoint& point : curve.points) {
        if (point.accuracy && *point.accuracy >= accuracy) return point;
    }
    return std::nullopt;
}

bool suffices(const ReportEntry& entry) {
    return std::ranges::any_of(entry.curves, [](const ReportCurve& curve) {
        return !curve.energy && !curve.bestTerms && firstReaching(curve, leastOfNeeds);
    });
}

std::string reportJson(const Report& report) {
    Json entries = Json::array();
    for (const ReportEntry& entry : report.reports) entries.push_back(entryJson(entry));
    const Json json = {{"format", "hshfit-report"},
                       {"version", 1},
                       {"generator", std::string("hshfit ") + version},
                       {"conventions",
                        {{"order", "bands 0 to order - 1"},
                         {"coefficients", "functions of the basis that can be non-zero"},
                         {"slots", "order^2"},
                         {"accuracy", "captured energy / energy (Gautron et al. 2004, Eq. 15)"},
                         {"channels", "summed"},
                         {"outgoing", "summed with the solid angles of the directions"}}},
                       {"reports", std::move(entries)}};
    return jsonText(json, 2) + "\n";
}

}  // namespace hshfit::inline pages
