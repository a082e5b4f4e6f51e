#pragma once

#include "../shaders/bound_shader.h"
#include "../shaders/shader_job.h"

#include <hshfit/gpu/binaries/spirv_module.h>
#include <hshfit/gpu/forms/form_payload.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/payload.h>

#include <string>
#include <string_view>
#include <vector>

/// Modules of SPIR-V with what they are bound to.
namespace hshfit::shaders {

/// Vectors of three as a buffer of items has them: all first ones, second ones …, by turns, each
/// with a fourth number that no module reads.
std::vector<float> itemNumbers(const std::vector<std::vector<Direction>>& fields);

/// The textures or the uniform block of coefficients, or of a form.
std::vector<gpu::ComputeResource> boundTo(const gpu::Payload& payload);
std::vector<gpu::ComputeResource> boundTo(const gpu::FormPayload& payload, gpu::Storage storage);

/// A module over `count` items, with one group more than they take, whose work items have nothing
/// to do. `outputs` are the floats of a result.
BoundShader boundModule(const std::vector<std::uint32_t>& words, std::vector<float> items,
                        std::size_t count, std::size_t outputs,
                        std::vector<gpu::ComputeResource> bound);

/// The bindings of a module, a line for each: number, type, and what the type has of image, access,
/// stride, offsets of fields and items. Once of the text of spirv-dis, once of the file beside the
/// module (moduleText). Results are floats in a module, whose stride is then no item's.
std::vector<std::string> listedBindings(const std::string& listing);
std::vector<std::string> statedBindings(const std::string& text);

}  // namespace hshfit::shaders
