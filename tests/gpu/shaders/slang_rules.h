#pragma once

#include <string>
#include <vector>

/// Slang modules without a compiler of Slang. The syntax that HLSL lacks is held to the rules of
/// Slang's user guide (Modules and Access Control; Automatic Differentiation); the rest is HLSL.
namespace hshfit::shaders {

/// Breaches of these rules, a line each.
std::vector<std::string> breachesOf(const std::string& module);

/// The HLSL below a module: without the words that are Slang's alone, and with the registers of the
/// wrappers.
std::string asHlsl(std::string module);

/// The module of snippets as HLSL. Throws Refused with its breaches.
std::string moduleAsHlsl(const std::string& snippets);

}  // namespace hshfit::shaders
