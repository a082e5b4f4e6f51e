#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::gpu::inline binaries {

/// A part of an item of a storage buffer.
struct ModuleField {
    std::string name;
    std::size_t floats = 1;
    std::string content;
};

/// A thing at a binding of descriptor set 0 of a module.
struct ModuleBinding {
    enum class Kind { textureArray, texture, cube, uniforms, items, results };

    std::uint32_t binding = 0;
    Kind kind = Kind::items;
    std::string content;
    bool filtered = true;  ///< of a texture: between texels, not by whole numbers
    /// The parts of an item of a storage buffer, one after another without gaps.
    std::vector<ModuleField> fields = {};
    /// Items of a storage buffer that is as long as the module says, or floats of a uniform block;
    /// 0: as long as the buffer.
    std::size_t count = 0;

    std::size_t stride() const;  ///< bytes of an item
};

struct SpirvModule;

/// The file beside a module that says how it is bound (docs/schemas/spirv.schema.json): entry
/// point, size of a group, bindings and the layouts of buffers. `path` is the module's file.
std::string moduleText(const SpirvModule& module, std::string_view path);

}  // namespace hshfit::gpu::inline binaries
