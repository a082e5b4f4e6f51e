#pragma once

#include <hshfit/brdf/brdf.h>

#include <string>

namespace hshfit::jobs {

/// The material `spec`, a gltf-pbr that was fitted to `source`, with base and sheen in the colours
/// of the least loss over pictures. Fits keep the sheen grey, because its largest channel darkens
/// all channels. Returns `spec` without sheen, for sources other than RGB and for scattered
/// measurements, and where colours lower the loss by less than 2 %.
std::string withColouredSheen(const std::string& spec, const Brdf& source);

}  // namespace hshfit::jobs
