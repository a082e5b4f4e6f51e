#pragma once

#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/viewer.h>

namespace hshfit::gpu::inline forms {

/// The form as a pane of the viewer, by its shader in GLSL ES: numbers as constants, or else as a
/// texture of single precision. `roughness`: highlightRoughness, for the sum over directions.
ViewerForm viewerForm(const FormPayload& payload, Storage storage, double roughness);

}  // namespace hshfit::gpu::inline forms
