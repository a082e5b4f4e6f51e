#include "command.h"
#include "documents.h"
#include "form_options.h"
#include "health.h"
#include "info_light.h"

#include <hshfit/accuracy/isotropy.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/light/catalog.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <brdfs/measured/scattered/scattered.h>

#include <jobs/source.h>

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

/// The cost of an evaluation relative to that of a few lobes: sums and mixtures have a lobe
/// for every term that they add up.
std::size_t costOf(const Brdf& brdf) {
    constexpr std::size_t fewLobes = 32;
    return 1 + brdf.lobes(directionFromAngles(pi / 4, 0)).size() / fewLobes;
}

/// Smallest and largest f over 12 outgoing directions and the grid that quadrature would use.
Json rangeJson(const Brdf& brdf) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    std::vector<double> values;
    const std::size_t mostRings = std::max<std::size_t>(2048 / costOf(brdf), 1);
    for (double theta : {0.0, 30.0, 60.0, 80.0}) {
        for (double phi : {0.0, 40.0, 90.0}) {
            const Direction wo = directionFromAngles(radians(theta), radians(phi));
            const HemisphereGrid grid = gridFor(brdf.lobes(wo), wo, {.order = 8, .level = 1});
            const std::size_t step = 1 + grid.weights.size() / mostRings;
            for (const auto& panel : grid.panels) {
                for (std::size_t r = 0; r < panel.rings; ++r) {
                    const std::size_t ring = panel.firstRing + r;
                    if (ring % step != 0) continue;
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
    return {{"min", finiteOrNull(low)}, {"max", finiteOrNull(high)}};
}

Json factsJson(const std::vector<Fact>& facts) {
    Json json = Json::object();
    for (const auto& [name, value] : facts) {
        std::visit([&, &key = name](const auto& v) { json[key] = v; }, value);
    }
    return json;
}

void describeCoefficients(const CoefficientHead& c, Json& document) {
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

/// Adds the facts of the container of exported coefficients; nothing for other files.
void describeContainer(const std::string& path, Json& facts) {
    if (!gpu::looksLikePayload(path)) return;
    const gpu::ImportedPayload read = gpu::readPayload(path);
    facts["container"] = read.container;
    facts["texels"] = read.file;
    facts["number"] = gpu::numberName(read.payload.coefficients.number);
    facts["packing"] = gpu::packingName(read.payload.packing);
    facts["layers"] = read.payload.coefficients.layers;
    facts["functions_per_direction"] = read.payload.slots.size();
}

/// Sentences about a BRDF that is not what it is taken for.
std::vector<std::string> warningsOf(const Brdf& brdf) {
    std::vector<std::string> warnings;
    for (const auto& [name, value] : brdf.facts())
        if (name == "looks_like")
            warnings.push_back("the file looks like " + std::get<std::string>(value));
    constexpr double alike = 0.01;  // the files of real materials stay below 0.001
    const double variation = brdf.laws().isotropic ? azimuthVariation(brdf) : 0;
    if (variation > alike)
        warnings.push_back(
            fmt::format("it is taken as isotropic, but at normal incidence f varies with the "
                        "azimuth by {:.2g} % (root mean square)",
                        100 * variation));
    return warnings;
}

Json describe(const Brdf& brdf, const Globals& globals) {
    const auto* reconstruction = dynamic_cast<const Reconstruction*>(&brdf);
    const auto* represented = dynamic_cast<const RepresentedBrdf*>(&brdf);
    const bool coefficients = reconstruction || represented;
    Json document = {{"format", "hshfit-info"},
                     {"version", 1},
                     {"kind", coefficients ? "coefficients" : "brdf"},
                     {"name", brdf.name()},
                     {"channels", brdf.channels().names()}};
    if (reconstruction) {
        describeCoefficients(reconstruction->coefficients(), document);
    } else if (represented) {
        describeCoefficients(represented->representation().head, document);
        document["representation"] = describeForm(represented->representation());
    } else {
        document["laws"] = lawsJson(brdf.laws());
        document["facts"] = factsJson(brdf.facts());
    }
    Progress progress(globals, "info");
    HealthOptions options{.progress = progress.callback()};
    // A search among samples takes some twenty times as long as a look into a table.
    if (dynamic_cast<const brdfs::Scattered*>(&brdf) == nullptr) options.albedoEvaluations *= 4;
    options.albedoEvaluations /= costOf(brdf);
    describeHealth(brdf, examine(brdf, options), document);
    document["range"] = rangeJson(brdf);
    if (const auto warnings = warningsOf(brdf); !warnings.empty()) {
        document["warnings"] = warnings;
        // A picture of light is not to be repaired into a BRDF.
        if (document["facts"].contains("looks_like"))
            document["health"]["suggested_repairs"] = Json::array();
    }
    return document;
}

std::string scalarText(const Json& value) {
    return value.is_string() ? value.get<std::string>() : jsonText(value);
}

std::string infoText(const Json& document) {
    std::string out = fmt::format("{}: {}\n", document["kind"].get<std::string>(),
                                  document["name"].get<std::string>());
    std::vector<std::string> names = document["channels"];
    if (names.size() > 8)
        names = {fmt::format("{} from {} to {}", names.size(), names.front(), names.back())};
    out += factLine("channels", fmt::format("{}", fmt::join(names, " ")));
    for (const char* section : {"laws", "symmetry", "facts", "representation"}) {
        if (!document.contains(section)) continue;
        for (const auto& [key, value] : document[section].items())
            out += factLine(key, scalarText(value));
    }
    out += factLine("smallest f found", jsonText(document["range"]["min"]));
    out += factLine("largest f found", jsonText(document["range"]["max"]));
    out += healthText(document);
    for (const Json& warning : document.value("warnings", Json::array()))
        out += factLine("WARNING", warning.get<std::string>());
    return out;
}

}  // namespace

void addInfo(CLI::App& command, Globals& globals) {
    struct Options {
        std::string spec;
        bool rgb = false;
    };
    auto options = std::make_shared<Options>();
    command.add_option("SPEC", options->spec, "BRDF, light, coefficient file or file of an export")
        ->required();
    addRgb(command, options->rgb);
    command.callback([options, &globals] {
        if (looksLikeLight(options->spec)) {
            const Json document = describeLight(options->spec);
            if (globals.json) {
                printJson(document);
            } else {
                printText(lightText(document));
            }
            return;
        }
        const auto brdf = jobs::openSource(options->spec, options->rgb);
        Json document = describe(*brdf, globals);
        describeContainer(options->spec, document["facts"]);
        jobs::requireReadable(*brdf);  // NaN values are in the census
        if (globals.json) {
            printJson(document);
        } else {
            printText(infoText(document));
        }
    });
}

}  // namespace hshfit::cli
