#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::gpu::inline containers {

/// A choice of an export: a container, a shader language, a compiled shader, the viewer, the set of
/// them that suits one renderer, a standard material, which has parameters in place of
/// coefficients, a module with a material, or mips of a map for an engine's own material.
struct Target {
    enum class Kind { container, shader, viewer, renderer, material, module, binary, mips };

    Kind kind = Kind::container;
    std::string name, summary;
    std::vector<std::string> parts;  ///< written with it: names of other targets
};
std::string_view kindName(Target::Kind kind);  ///< "container", …

/// The containers, the languages, compiled shaders, the viewer, the modules, the renderers and the
/// materials, in this order.
const std::vector<Target>& targets();

/// Containers, languages, modules and the viewer named in a comma-separated list, renderers
/// replaced by their parts, and materials, each once and in the order of the table; "all" is
/// everything but the materials and mips. Throws UsageError that lists the known ones.
std::vector<const Target*> selectTargets(std::string_view names);

}  // namespace hshfit::gpu::inline containers
