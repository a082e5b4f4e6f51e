#include <hshfit/gpu/binaries/spirv_module.h>

#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/proposals/proposal_shader.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/gpu/vulkan/spirv.h>

#include <algorithm>
#include <utility>

namespace hshfit::embedded {
extern const std::string_view binaries_compute;
}

namespace hshfit::gpu::inline binaries {
namespace {

using kainjow::mustache::data;
using Bindings = std::vector<ModuleBinding>;
using Fields = std::vector<ModuleField>;
using Kind = ModuleBinding::Kind;

/// A module before it is compiled.
struct Plan {
    std::string function, prefix, snippet;
    Fields items, results;      ///< of bindings 2 and 3
    Bindings bound = {};        ///< what the function reads
    std::string type = "vec3";  ///< of f in GLSL
    Channels channels = Channels::rgb();
};

const std::string localDirection = "a unit vector in the frame of tangent, bitangent, normal";

/// The last of the results, the channels of f, with the place of each in an item.
void setChannels(const Plan& plan, const ModuleBinding& results, data& page) {
    const bool spectral = plan.channels.kind == Channels::Kind::spectral;
    const std::size_t count = plan.results.back().floats, stride = results.stride() / 4;
    data each{data::type::list};
    for (std::size_t c = 0; c < count; ++c) {
        const std::string index = std::to_string(c);
        data one;
        one.set("place", std::to_string(stride - count + c));
        one.set("of", plan.type == "float" ? "" : (spectral ? ".v[" : "[") + index + "]");
        each.push_back(one);
    }
    page.set("each", each);
    page.set("stride", std::to_string(stride));
}

/// Sections and words of one function.
void setFunction(const Plan& plan, data& page) {
    for (const char* function : {"eval", "sample", "pdf"})
        page.set(function, plan.function == function);
    std::string items;
    for (const ModuleField& field : plan.items) items += (items.empty() ? "" : ", ") + field.name;
    page.set("items", items);
    page.set("snippet", plan.snippet);
    page.set("prefix", plan.prefix);
    page.set("function", plan.function);
    page.set("type", plan.type);
    page.set("group", std::to_string(spirvGroup));
}

SpirvModule compiled(Plan plan, data page = {}) {
    if (!compilesGlsl())
        throw UsageError(
            "the target spirv needs glslang, without which this program was built; expected a "
            "build with libvulkan-dev, glslang-dev and glslang-tools, or the target glsl");
    const ModuleBinding items{.binding = 2,
                              .kind = Kind::items,
                              .content = "what the function is called with, a work item each",
                              .fields = plan.items},
        results{.binding = 3,
                .kind = Kind::results,
                .content = "what it gives, in the order of binding 2",
                .fields = plan.results};
    setFunction(plan, page);
    setChannels(plan, results, page);
    const std::string source = filledText(embedded::binaries_compute, page);
    Bindings bindings = std::move(plan.bound);
    bindings.insert(bindings.end(), {items, results});
    std::ranges::sort(bindings, {}, &ModuleBinding::binding);
    return {std::move(plan.function), compileGlsl(source), std::move(bindings)};
}

/// The functions of a snippet, with what it reads.
std::vector<SpirvModule> modulesOf(const Channels& channels, const std::string& prefix,
                                   const std::string& snippet, Bindings bound,
                                   const std::optional<ProposalRecord>& proposal, bool cosine) {
    const ModuleField wo{"wo", 4, localDirection + ", to the viewer"},
        wi{"wi", 4, localDirection + ", to the light"};
    const ModuleField f{"f", channels.count(),
                        cosine ? "f cos(theta_i), by channel" : "f, by channel"};
    const std::string type = channels.kind == Channels::Kind::grey       ? "float"
                             : channels.kind == Channels::Kind::spectral ? prefix + "_Values"
                                                                         : "vec3";
    std::vector<SpirvModule> modules;
    modules.push_back(compiled({"eval", prefix, snippet, {wo, wi}, {f}, bound, type, channels}));
    if (!proposal) return modules;
    const std::string sampling = proposalSource(Language::glsl, *proposal, {prefix, cosine});
    const ModuleField u{"u", 4, "uniform numbers in [0, 1)"},
        drawn{"wi", 3, "the direction drawn; 0 where wo is not above the horizon"},
        pdf{"pdf", 1, "the density of wi per steradian"};
    modules.push_back(compiled({"sample",
                                prefix,
                                snippet + sampling,
                                {wo, u},
                                {drawn, pdf, f},
                                std::move(bound),
                                type,
                                channels}));
    // The density reads none of the coefficients.
    modules.push_back(compiled({"pdf", prefix, sampling, {wo, wi}, {pdf}, {}, "float", channels}));
    return modules;
}

}  // namespace

std::vector<SpirvModule> spirvModules(const Payload& payload, const std::string& prefix,
                                      const std::optional<ProposalRecord>& proposal) {
    Bindings bound{{0, Kind::textureArray, "the coefficients, texels of the containers"}};
    if (payload.basisTexels)
        bound.push_back({1, Kind::textureArray, "the basis, texels of the containers"});
    return modulesOf(
        payload.head.channels, prefix,
        shaderSource(Language::glsl, payload, {.prefix = prefix, .environmentOrder = 0}),
        std::move(bound), proposal, payload.head.quantity == Quantity::brdfCosine);
}

std::vector<SpirvModule> spirvModules(const FormPayload& payload, const FormShaderOptions& options,
                                      const std::optional<ProposalRecord>& proposal) {
    Bindings bound;
    const Storage storage = storageFor(payload, options.storage);
    if (storage == Storage::texture)
        bound.push_back({.kind = Kind::textureArray,
                         .content = "the numbers of the form, texels of the containers",
                         .filtered = false});
    if (storage == Storage::block)
        bound.push_back({.kind = Kind::uniforms,
                         .content = "the numbers of the form: the texels, decoded, in their order",
                         .count = decode(payload.texels).size()});
    return modulesOf(payload.form.head.channels, options.prefix,
                     formShaderSource(Language::glsl, payload, options), std::move(bound), proposal,
                     false);
}

SpirvModule spirvLightingModule(const LightingCall& call) {
    Plan plan{.function = call.function,
              .prefix = call.prefix,
              .snippet = call.snippet,
              .items = {{"normal", 4, "a unit vector in the world"},
                        {"tangent", 4,
                         call.tangent ? "the material's +x, a unit vector across the normal"
                                      : "not read: the material has no tangent"},
                        {"viewer", 4, "a unit vector in the world, to the viewer"}},
              .results = {{"radiance", 3, "reflected to the viewer, linear RGB"}},
              .bound = {{.kind = Kind::texture,
                         .content = "the table, of NAME.lighting.json",
                         .filtered = false}}};
    if (call.cube)
        plan.bound.push_back({1, Kind::cube, "the cube with its levels, of NAME.lighting.json"});
    ModuleBinding light{.binding = 4, .kind = Kind::items, .content = {}};
    if (call.areas) {
        plan.items.push_back({"position", 4, "from which the corners of binding 4 are seen"});
        light.content = "quadrilaterals of light, as many as the buffer has";
        for (const char* corner : {"corner0", "corner1", "corner2", "corner3"})
            light.fields.push_back({corner, 4, "a corner in the world, in turn around"});
        light.fields.push_back({"radiance", 4, "linear RGB; all areas are summed"});
    } else {
        light.content = "coefficients of light, of NAME.lighting.json";
        light.fields = {{"light", 4, "linear RGB of the slot l(l+1)+m"}};
        light.count = call.lights;
    }
    if (call.areas || call.lights > 0) plan.bound.push_back(std::move(light));
    data page;
    page.set("lighting", true);
    page.set("areas", call.areas);
    page.set("array", !call.areas && call.lights > 0);
    page.set("lights", std::to_string(call.lights));
    page.set("tangent", call.tangent ? "items[k].tangent.xyz, " : "");
    return compiled(std::move(plan), std::move(page));
}

std::string spirvBytes(const std::vector<std::uint32_t>& words) {
    std::string bytes;
    bytes.reserve(4 * words.size());
    for (const std::uint32_t word : words)
        for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift);
    return bytes;
}

}  // namespace hshfit::gpu::inline binaries
