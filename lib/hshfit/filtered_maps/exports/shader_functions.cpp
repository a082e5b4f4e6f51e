#include <hshfit/filtered_maps/exports/internal/shader_functions.h>

#include <hshfit/gpu/language_words.h>

#include <fmt/format.h>

namespace hshfit::inline filtered_maps::inline exports {

std::string ShaderFunctions::typeOf(std::string_view word) const {
    const std::string key(word);
    if (const auto* known = page_.get(key)) return known->string_value();
    return fmt::format("{}_{}", gpu::wordOf(page_, "prefix"), word);
}

void ShaderFunctions::add(const std::string& key, std::string_view result, std::string_view name,
                          const std::vector<Named>& parameters, bool textures) {
    std::string list = textures ? gpu::wordOf(page_, "parameters") : "";
    for (const Named& parameter : parameters) {
        list += wgsl_ ? fmt::format("{}: {}, ", parameter.name, typeOf(parameter.type))
                      : fmt::format("{} {}, ", typeOf(parameter.type), parameter.name);
    }
    list.resize(list.size() - 2);
    const std::string prefix = gpu::wordOf(page_, "prefix");
    page_.set(key, wgsl_ ? fmt::format("fn {}_{}({}) -> {}", prefix, name, list, typeOf(result))
                         : fmt::format("{}{} {}_{}({})", gpu::wordOf(page_, "inline"),
                                       typeOf(result), prefix, name, list));
}

void ShaderFunctions::addStruct(const std::string& key, const std::string& name,
                                const std::vector<Named>& members) {
    std::string list;
    for (const Named& member : members) {
        list += wgsl_ ? fmt::format(" {}: {},", member.name, typeOf(member.type))
                      : fmt::format(" {} {};", typeOf(member.type), member.name);
    }
    if (wgsl_) list.pop_back();
    page_.set(key, fmt::format("struct {}_{} {{{} }}{}", gpu::wordOf(page_, "prefix"), name, list,
                               wgsl_ ? "" : ";"));
}

}  // namespace hshfit::inline filtered_maps::inline exports
