#include "command.h"

#include <hshfit/albedo.h>
#include <hshfit/error.h>
#include <hshfit/quadrature.h>
#include <hshfit/reconstruction.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double albedoAngles[] = {0, 30, 60, 80};

/// Smallest and largest f over 12 outgoing directions and the grid that quadrature would use.
Json rangeJson(const Brdf& brdf) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    std::vector<double> values;
    for (double theta : {0.0, 30.0, 60.0, 80.0}) {
        for (double phi : {0.0, 40.0, 90.0}) {
            const Direction wo = directionFromAngles(radians(theta), radians(phi));
            const HemisphereGrid grid = gridFor(brdf.lobes(wo), wo, {.order = 8, .level = 1});
            for (const auto& panel : grid.panels) {
                for (std::size_t r = 0; r < panel.rings; ++r) {
                    const std::size_t ring = panel.firstRing + r;
                    for (int j = 0; j < 64; ++j) {
                        const double angle = azimuth(wo) + 2 * pi * (j + 0.5) / 64;
                        const Direction wi{grid.sines[ring] * std::cos(angle),
                                           grid.sines[ring] * std::sin(angle),
                                           grid.elevations[ring].mu};
                        values = evaluate(brdf, wi, wo);
                        for (double f : values) {
                            low = std::min(low, f);
                            high = std::max(high, f);
                        }
                    }
                }
            }
        }
    }
    return {{"min", std::isfinite(low) ? Json(low) : Json(nullptr)},
            {"max", std::isfinite(high) ? Json(high) : Json(nullptr)}};
}

Json albedoJson(const Brdf& brdf) {
    Json rows = Json::array();
    for (double theta : albedoAngles) {
        Json row = {{"theta", theta}};
        try {
            row["values"] = directionalAlbedo(brdf, directionFromAngles(radians(theta), 0));
        } catch (const NumericError& error) {
            row["values"] = nullptr;
            row["reason"] = error.what();
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

Json factsJson(const std::vector<Fact>& facts) {
    Json json = Json::object();
    for (const auto& [name, value] : facts) {
        std::visit([&, &key = name](const auto& v) { json[key] = v; }, value);
    }
    return json;
}

Json lawsJson(const Laws& laws) {
    return {{"non_negative", laws.nonNegative},
            {"reciprocal", laws.reciprocal},
            {"isotropic", laws.isotropic},
            {"mirror_symmetric", laws.mirrorSymmetric},
            {"energy_conserving", laws.energyConserving}};
}

void describeCoefficients(const Coefficients& c, Json& document) {
    document["symmetry"] = {
        {"isotropic", c.isotropic}, {"bilateral", c.bilateral}, {"reciprocal", c.reciprocal}};
    document["facts"] = {{"basis", c.basis},
                         {"order", c.order},
                         {"condon_shortley", c.condonShortley},
                         {"quantity", quantityName(c.quantity)},
                         {"outgoing", c.outgoing.spec()},
                         {"outgoing_directions", c.outgoing.size()},
                         {"coefficients_per_direction", c.slots()},
                         {"energy", c.energy.finite ? Json(c.energy.value) : Json(nullptr)},
                         {"quadrature_error", c.error},
                         {"generator", c.generator}};
}

Json describe(const Brdf& brdf) {
    const auto* reconstruction = dynamic_cast<const Reconstruction*>(&brdf);
    Json document = {{"format", "hshfit-info"},
                     {"version", 1},
                     {"kind", reconstruction ? "coefficients" : "brdf"},
                     {"name", brdf.name()},
                     {"channels", brdf.channels().names()}};
    if (reconstruction) {
        describeCoefficients(reconstruction->coefficients(), document);
    } else {
        document["laws"] = lawsJson(brdf.laws());
        document["facts"] = factsJson(brdf.facts());
    }
    document["albedo"] = albedoJson(brdf);
    document["range"] = rangeJson(brdf);
    return document;
}

std::string scalarText(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string text(const Json& document) {
    std::string out = fmt::format("{}: {}\n", document["kind"].get<std::string>(),
                                  document["name"].get<std::string>());
    const auto line = [&](std::string name, const std::string& value) {
        std::replace(name.begin(), name.end(), '_', ' ');
        out += fmt::format("  {:<28} {}\n", name, value);
    };
    std::vector<std::string> names = document["channels"];
    if (names.size() > 8)
        names = {fmt::format("{} from {} to {}", names.size(), names.front(), names.back())};
    line("channels", fmt::format("{}", fmt::join(names, " ")));
    for (const char* section : {"laws", "symmetry", "facts"}) {
        if (!document.contains(section)) continue;
        for (const auto& [key, value] : document[section].items()) line(key, scalarText(value));
    }
    line("smallest f found", document["range"]["min"].dump());
    line("largest f found", document["range"]["max"].dump());
    for (const Json& row : document["albedo"]) {
        std::string values;
        if (row["values"].is_null()) {
            values = row["reason"];
        } else {
            std::vector<double> shown = row["values"];
            const bool many = shown.size() > 8;
            if (many) shown.resize(8);
            values = fmt::format("{:.4f}{}", fmt::join(shown, " "), many ? " …" : "");
        }
        line(fmt::format("albedo at {:g} degrees", row["theta"].get<double>()), values);
    }
    return out;
}

}  // namespace

void addInfo(CLI::App& app, Globals& globals) {
    auto spec = std::make_shared<std::string>();
    CLI::App& command = addCommand(app, globals, "info",
                                   "What a BRDF or a coefficient file is: channels, symmetry, "
                                   "invalid cells, albedo, range",
                                   "hshfit info ggx:alpha=.2,f0=.9");
    command.add_option("SPEC", *spec, "BRDF or coefficient file")->required();
    command.callback([spec, &globals] {
        const auto brdf = openSource(*spec);
        const Json document = describe(*brdf);
        brdf->checkIntact();
        if (globals.json) {
            printJson(document);
        } else {
            printText(text(document));
        }
    });
}

}  // namespace hshfit::cli
