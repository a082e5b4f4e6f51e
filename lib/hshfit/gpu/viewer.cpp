#include <hshfit/gpu/viewer.h>

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/version.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace hshfit::embedded {
extern const std::string_view viewer_page, viewer_style;
extern const std::string_view viewer_radiance, viewer_harmonics, viewer_environment, viewer_shapes,
    viewer_renderer, viewer_shaders, viewer_controls, viewer_panes, viewer_light_panel, viewer_main;
extern const std::string_view viewer_geometry_vert, viewer_geometry_frag, viewer_screen_vert,
    viewer_environment_glsl, viewer_exact_glsl, viewer_fit_glsl, viewer_sampled_glsl,
    viewer_shade_frag, viewer_composite_frag;
}  // namespace hshfit::embedded

namespace hshfit::gpu {

std::string_view harmonicsScript() {
    return embedded::viewer_harmonics;
}

namespace {

using Json = nlohmann::ordered_json;
using kainjow::mustache::data;

/// Directions a pixel and frame over which the panes of the exact material and of a form sum the
/// environment.
constexpr int exactSamples = 36;

std::string paneName(const Payload& payload) {
    std::string name = payload.head.basis;
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return name;
}

std::string_view asText(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The payload that the page uploads: float16, without basis textures or folders in its source.
Payload shownPayload(Payload payload) {
    payload.head.source = shownName(payload.head.source);
    payload.basisTexels.reset();
    if (payload.coefficients.number == Number::float16) return payload;
    const Texels& from = payload.coefficients;
    payload.coefficients =
        encode(decode(from), from.width, from.height, from.layers, Number::float16);
    return payload;
}

/// The band of every lane; a band beyond all orders for unused lanes.
std::vector<int> bandsOf(const Payload& payload) {
    std::vector<int> bands(payload.coefficients.layers * 4, payload.head.order);
    for (std::size_t c = 0; c < payload.stored.size(); ++c) {
        for (std::size_t j = 0; j < payload.stored[c].slots; ++j) {
            const auto [layer, lane] = payload.place(c, j);
            bands[layer * 4 + lane] = static_cast<int>(std::sqrt(payload.slots[j] + 0.5));
        }
    }
    return bands;
}

Json fitJson(const Payload& given, std::size_t index, int environmentOrder) {
    const Payload payload = shownPayload(given);
    const std::string prefix = fmt::format("fit{}", index + 1);
    return {{"name", paneName(payload)},
            {"order", payload.head.order},
            {"width", payload.coefficients.width},
            {"height", payload.coefficients.height},
            {"layers", payload.coefficients.layers},
            {"bands", bandsOf(payload)},
            {"hasCosine", payload.head.quantity == Quantity::brdfCosine},
            {"oddSign", payload.head.condonShortley ? -1 : 1},
            {"prefix", prefix},
            {"sampler", prefix + "_coefficients"},
            {"shader", shaderSource(Language::glslEs, payload,
                                    {.prefix = prefix, .environmentOrder = environmentOrder})},
            {"texels", base64(asText(payload.coefficients.bytes))}};
}

/// The texels of a form as a sampler returns them.
std::string samplerValues(const Texels& texels) {
    const std::vector<double> values = decode(texels);
    const std::vector<float> singles(values.begin(), values.end());
    return base64(asText(std::as_bytes(std::span(singles))));
}

Json formJson(const ViewerForm& form) {
    Json document = {{"name", form.name},
                     {"prefix", form.prefix},
                     {"sampler", form.prefix + "_coefficients"},
                     {"shader", form.shader},
                     {"roughness", form.roughness},
                     {"samples", exactSamples}};
    if (form.texels) {
        document["width"] = form.texels->width;
        document["height"] = form.texels->height;
        document["texels"] = samplerValues(*form.texels);
    }
    return document;
}

Json exactJson(const ViewerInput& input) {
    if (!input.reference) return {{"absent", input.noReference}};
    const ReferenceTable& table = *input.reference;
    return {{"isotropic", table.isotropic},
            {"bilateral", table.bilateral},
            {"reciprocal", table.reciprocal},
            {"width", table.width},
            {"height", table.height},
            {"azimuths", table.azimuths},
            {"rest", table.rest},
            {"lastTheta", ReferenceTable::lastThetaDifference},
            {"channels", table.channels},
            {"roughness", table.roughness},
            {"samples", exactSamples},
            {"texels", base64(asText(std::as_bytes(std::span(table.cubeRoots))))}};
}

std::string noteOf(const ViewerLight& light) {
    const std::string energy =
        std::isfinite(light.captured)
            ? fmt::format("have {:.3g} % of its energy", 100 * light.captured)
            : std::string("have a share of its energy that does not exist, as for every point");
    return fmt::format(
        "{}: {} bands {}. The picture, {} x {} in {:.0f} kB, has the same coefficients to {:.2g} "
        "%.",
        light.name, light.coefficients.order, energy, light.width, light.height,
        static_cast<double>(light.rgbe.size()) / 1000, 100 * light.pictureError);
}

/// Coefficients of SH, [slot][R, G, B].
Json lightJson(const ViewerLight& light) {
    std::vector<double> values;
    for (std::size_t j = 0; j < light.coefficients.slots(); ++j)
        for (std::size_t c = 0; c < 3; ++c) values.push_back(light.coefficients.at(c)[j]);
    return {
        {"name", light.name},     {"width", light.width},
        {"height", light.height}, {"coefficients", values},
        {"note", noteOf(light)},  {"texels", base64(asText(std::as_bytes(std::span(light.rgbe))))}};
}

Json lightsJson(const ViewerInput& input) {
    Json lights = Json::array();
    for (const ViewerLight& light : input.lights) lights.push_back(lightJson(light));
    if (lights.empty()) {
        lights.push_back(lightJson(
            viewerLight(parseLights(std::string(studioKind().name)), input.environmentOrder)));
    }
    return lights;
}

Json shadersJson() {
    using namespace embedded;
    return {{"geometryVertex", viewer_geometry_vert},
            {"geometryFragment", viewer_geometry_frag},
            {"screenVertex", viewer_screen_vert},
            {"environment", viewer_environment_glsl},
            {"exact", viewer_exact_glsl},
            {"fit", viewer_fit_glsl},
            {"sampled", viewer_sampled_glsl},
            {"shadeFragment", viewer_shade_frag},
            {"compositeFragment", viewer_composite_frag}};
}

data notesOf(const ViewerInput& input) {
    data notes{data::type::list};
    if (const auto& table = input.reference) {
        notes.push_back(fmt::format(
            "Exact: the source tabulated over {} x {} x {} half and difference directions, {:.1f} "
            "MB; root mean square error of the table {:.2g} %. Under the environment it is a mean "
            "over directions that grows with every frame.",
            table->width, table->height, table->azimuths * table->rest,
            static_cast<double>(table->cubeRoots.size()) * 2e-6, 100 * table->error));
    }
    if (input.form) {
        notes.push_back(fmt::format(
            "{}: the form's own GLSL ES shader. Under the environment it is, like the exact "
            "picture, a mean over directions of the light's picture; {} takes the light's "
            "coefficients.",
            input.form->name, paneName(input.payloads.front())));
    }
    const Payload& first = input.payloads.front();
    notes.push_back(fmt::format(
        "{} of {}, outgoing directions {}; half floats, and the shader as it is exported. No "
        "shadows and no light from one part to another.",
        first.head.quantity == Quantity::brdf ? "f" : "f cos θi",
        first.head.source.empty() ? "an unnamed source" : shownName(first.head.source),
        first.head.outgoing.spec()));
    return notes;
}

[[noreturn]] void refuseSpectral(const std::string& name) {
    throw UsageError(
        fmt::format("{}: the viewer shows grey or RGB; project the spectral BRDF with {}", name,
                    Call{.function = "asRgb"}));
}

void check(const ViewerInput& input) {
    const std::size_t most = input.form ? 1 : 2;
    if (input.payloads.empty() || input.payloads.size() > most) {
        throw UsageError(fmt::format("a viewer of {} sets of coefficients; it shows one{}",
                                     input.payloads.size(),
                                     input.form ? " beside a form" : " or two"));
    }
    if (input.form && input.form->spectral) refuseSpectral(input.form->name);
    for (const Payload& payload : input.payloads) {
        if (payload.head.channels.kind == Channels::Kind::spectral)
            refuseSpectral(payload.head.source);
    }
    if (input.environmentOrder < 2 || input.environmentOrder > 10) {
        throw UsageError(fmt::format("an environment of {} bands; the viewer takes 2 to 10",
                                     input.environmentOrder));
    }
    for (const ViewerLight& light : input.lights) {
        if (light.coefficients.order == input.environmentOrder) continue;
        throw UsageError(fmt::format("{}: a light of {} bands in a viewer of {}", light.name,
                                     light.coefficients.order, input.environmentOrder));
    }
}

}  // namespace

std::string viewerPage(const ViewerInput& input) {
    check(input);
    const Payload& first = input.payloads.front();
    Json document = {{"order", first.head.order}, {"skyOrder", input.environmentOrder}};
    std::string names;
    if (input.form) {
        document["form"] = formJson(*input.form);
        names = input.form->name + " and ";
    }
    for (std::size_t i = 0; i < input.payloads.size(); ++i) {
        document["fits"].push_back(fitJson(input.payloads[i], i, input.environmentOrder));
        names += (i > 0 ? " and " : "") + paneName(input.payloads[i]);
        document["order"] = std::max(document["order"].get<int>(), input.payloads[i].head.order);
    }
    document["exact"] = exactJson(input);
    document["details"] = input.details;
    document["lights"] = lightsJson(input);
    document["shaders"] = shadersJson();
    std::string script;
    for (const std::string_view part :
         {embedded::viewer_radiance, embedded::viewer_harmonics, embedded::viewer_environment,
          embedded::viewer_shapes, embedded::viewer_shaders, embedded::viewer_renderer,
          embedded::viewer_controls, embedded::viewer_panes, embedded::viewer_light_panel,
          embedded::viewer_main}) {
        script += part;
    }
    data page;
    page.set("title", input.title);
    page.set("names", names);
    page.set("summary", fmt::format("{} up to order {}, next to the material itself", names,
                                    first.head.order));
    page.set("orderName", input.form ? paneName(first) + ": order" : "Order");
    page.set("generator", std::string("hshfit ") + version);
    page.set("order", std::to_string(document["order"].get<int>()));
    page.set("style", livePageStyle(embedded::viewer_style));
    page.set("notes", notesOf(input));
    page.set("data", scriptSafe(jsonText(document)));
    page.set("script", script);
    return filledPage(embedded::viewer_page, page);
}

void writeViewer(const std::string& path, const ViewerInput& input, bool force) {
    const std::string page = viewerPage(input);
    AtomicFile file(path, force ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse);
    file.write(page);
    file.commit();
}

}  // namespace hshfit::gpu
