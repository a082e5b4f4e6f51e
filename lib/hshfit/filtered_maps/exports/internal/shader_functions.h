#pragma once

#include <hshfit/gpu/shader.h>

#include <kainjow/mustache.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline filtered_maps::inline exports {

/// A parameter of a function or a member of a struct: the word of its type, "real", "vec2", "vec3",
/// "vec4", "int", or a struct of the snippet, and its name.
struct Named {
    std::string_view type, name;
};

/// Declarations of functions and structs in a language, of a page with the words of
/// setMapTextures().
class ShaderFunctions {
public:
    ShaderFunctions(gpu::Language language, kainjow::mustache::data& page)
        : wgsl_(language == gpu::Language::wgsl), page_(page) {}

    /// The word `key` as "result PREFIX_name(…)" up to the body. `textures`: whether textures come
    /// first where they are arguments.
    void add(const std::string& key, std::string_view result, std::string_view name,
             const std::vector<Named>& parameters, bool textures = false);
    /// The word `key` as the whole struct, PREFIX_name.
    void addStruct(const std::string& key, const std::string& name,
                   const std::vector<Named>& members);

private:
    std::string typeOf(std::string_view word) const;

    bool wgsl_;
    kainjow::mustache::data& page_;
};

}  // namespace hshfit::inline filtered_maps::inline exports
