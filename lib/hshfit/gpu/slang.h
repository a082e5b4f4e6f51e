#pragma once

#include <string>
#include <string_view>

namespace hshfit::gpu {

/// Slang (shader-slang.org) of snippets in HLSL: a module called `name`, to be imported from a file
/// of that name. Templates are in HLSL for both languages; this step is all that differs:
///     a line `module "name";` precedes the code;
///     functions, structs with their members, textures and samplers are `public`;
///     textures, samplers and blocks have no registers: Slang lays them out, and programs bind
///     them by their names;
///     a function without textures, blocks and tables, of one number or three, is [Differentiable]
///     where it is called PREFIX_eval, and calls of step in it are marked no_diff: its derivative
///     is 0, and Slang's library has none.
/// The comment that names macros for registers is replaced by one of the module. Throws UsageError
/// for a name with quotes or backslashes, std::logic_error for a text without that comment, which
/// no snippet is.
std::string slangModule(const std::string& hlsl, std::string_view name);

}  // namespace hshfit::gpu
