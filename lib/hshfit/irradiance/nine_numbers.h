#pragma once

#include <hshfit/irradiance/conventions.h>

#include <string>
#include <string_view>

namespace hshfit::inline irradiance {

/// Coefficients of radiance in our world from the numbers of an engine, row by row as
/// `engineValues` gives them; numbers that no light changes are not looked at. The inverse of
/// `engineValues`, exact but for rounding. Throws InputError with `name` for another count.
NineRgb radianceFromEngine(const Convention& convention, const std::vector<double>& numbers,
                           const std::string& name);

/// Numbers of a text: triples or quadruples of cmgen, CSV with or without a line of names and with
/// or without l and m in front, or a JSON array. Remarks from // or # to the end of a line are left
/// out. Throws InputError with `name` for words between the numbers, or more than 64 numbers.
std::vector<double> numbersOfText(std::string_view text, const std::string& name);

/// The convention that a text states: cmgen's lines end in "// L00, irradiance, pre-scaled base",
/// which is filament's. Empty where none is stated.
std::string_view conventionOfText(std::string_view text);

}  // namespace hshfit::inline irradiance
