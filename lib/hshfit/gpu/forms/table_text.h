#pragma once

#include <hshfit/gpu/forms/function_table.h>

#include <kainjow/mustache.hpp>

#include <cstddef>

namespace hshfit::gpu::inline forms {

/// Multiply-adds of the partial "tablePlaceBody".
inline constexpr std::size_t tableProducts = 24;

/// Sets the partial "tablePlaceBody" of a template and its numbers: statements that find the place
/// of wi and wo in a table. Afterwards `above` is 1 where both directions are above the horizon and
/// 0 elsewhere, `place` the first of two texels, the second being {{nodeScale}} further down, and
/// `weight` the weight of the second; lookups in layer g, with a linear filter, give four
/// functions.
void setTablePlace(const FunctionTable& table, kainjow::mustache::data& page);

}  // namespace hshfit::gpu::inline forms
