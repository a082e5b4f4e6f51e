#include <hshfit/gpu/binaries/module_bindings.h>

#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/binaries/spirv_module.h>
#include <hshfit/version.h>

namespace hshfit::gpu::inline binaries {
namespace {

using Json = nlohmann::ordered_json;
using Kind = ModuleBinding::Kind;

Json textureJson(const ModuleBinding& binding, const char* image) {
    return {{"binding", binding.binding},
            {"type", "combined_image_sampler"},
            {"image", image},
            {"filter", binding.filtered ? "linear" : "nearest"},
            {"address", "clamp_to_edge"},
            {"content", binding.content}};
}

Json uniformsJson(const ModuleBinding& binding) {
    return {{"binding", binding.binding},
            {"type", "uniform_buffer"},
            {"layout", "std140"},
            {"bytes", 4 * binding.count},
            {"content", binding.content}};
}

Json storageJson(const ModuleBinding& binding) {
    Json fields = Json::array();
    std::size_t offset = 0;
    for (const ModuleField& field : binding.fields) {
        fields.push_back({{"name", field.name},
                          {"offset", offset},
                          {"floats", field.floats},
                          {"content", field.content}});
        offset += 4 * field.floats;
    }
    Json json = {{"binding", binding.binding},
                 {"type", "storage_buffer"},
                 {"layout", "std430"},
                 {"access", binding.kind == Kind::items ? "read" : "write"},
                 {"stride", binding.stride()}};
    if (binding.count > 0) json["items"] = binding.count;
    json["content"] = binding.content;
    json["fields"] = fields;
    return json;
}

Json bindingJson(const ModuleBinding& binding) {
    switch (binding.kind) {
        case Kind::textureArray:
            return textureJson(binding, "2d_array");
        case Kind::texture:
            return textureJson(binding, "2d");
        case Kind::cube:
            return textureJson(binding, "cube");
        case Kind::uniforms:
            return uniformsJson(binding);
        case Kind::items:
        case Kind::results:
            break;
    }
    return storageJson(binding);
}

}  // namespace

std::size_t ModuleBinding::stride() const {
    std::size_t floats = 0;
    for (const ModuleField& field : fields) floats += field.floats;
    return 4 * floats;
}

std::string moduleText(const SpirvModule& module, std::string_view path) {
    const std::string bytes = spirvBytes(module.words);
    Json bindings = Json::array();
    for (const ModuleBinding& binding : module.bindings) bindings.push_back(bindingJson(binding));
    const Json document = {
        {"format", "hshfit-spirv"},
        {"version", 1},
        {"generator", std::string("hshfit ") + version},
        {"module", {{"path", path}, {"bytes", bytes.size()}, {"sha256", sha256(bytes)}}},
        {"spirv", "1.3"},
        {"vulkan", "1.1"},
        {"function", module.function},
        {"entry_point", {{"name", "main"}, {"stage", "compute"}}},
        {"group", {{"size", spirvGroup}, {"specialization_constant", 0}}},
        {"dispatch", "ceil(items of binding 2 / size of a group), 1, 1"},
        {"descriptor_set", 0},
        {"bindings", bindings},
        {"push_constant_bytes", 0}};
    return jsonText(document, 1) + "\n";
}

}  // namespace hshfit::gpu::inline binaries
