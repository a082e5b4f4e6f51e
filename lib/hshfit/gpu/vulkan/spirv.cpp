#include <hshfit/gpu/vulkan/spirv.h>

#include <hshfit/error.h>

#include <fmt/format.h>
#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>

#include <memory>
#include <string_view>

namespace hshfit::gpu::inline vulkan {
namespace {

/// The compiler's state of the process.
struct Compiler {
    Compiler() { glslang_initialize_process(); }
    Compiler(const Compiler&) = delete;
    Compiler& operator=(const Compiler&) = delete;
    ~Compiler() { glslang_finalize_process(); }
};

using Shader = std::unique_ptr<glslang_shader_t, decltype(&glslang_shader_delete)>;
using Program = std::unique_ptr<glslang_program_t, decltype(&glslang_program_delete)>;

[[noreturn]] void refuse(std::string_view log) {
    throw NumericError(fmt::format("a shader does not compile: {}", log.substr(0, log.find('\n'))));
}

}  // namespace

bool compilesGlsl() {
    return true;
}

std::vector<std::uint32_t> compileGlsl(const std::string& source) {
    static const Compiler compiler;
    glslang_input_t input{};
    input.language = GLSLANG_SOURCE_GLSL;
    input.stage = GLSLANG_STAGE_COMPUTE;
    input.client = GLSLANG_CLIENT_VULKAN;
    input.client_version = GLSLANG_TARGET_VULKAN_1_1;
    input.target_language = GLSLANG_TARGET_SPV;
    input.target_language_version = GLSLANG_TARGET_SPV_1_3;
    input.code = source.c_str();
    input.default_version = 450;
    input.default_profile = GLSLANG_NO_PROFILE;
    input.messages = GLSLANG_MSG_DEFAULT_BIT;
    input.resource = glslang_default_resource();
    const Shader shader(glslang_shader_create(&input), glslang_shader_delete);
    if (!glslang_shader_preprocess(shader.get(), &input) ||
        !glslang_shader_parse(shader.get(), &input)) {
        refuse(glslang_shader_get_info_log(shader.get()));
    }
    const Program program(glslang_program_create(), glslang_program_delete);
    glslang_program_add_shader(program.get(), shader.get());
    constexpr int messages = GLSLANG_MSG_SPV_RULES_BIT | GLSLANG_MSG_VULKAN_RULES_BIT;
    if (!glslang_program_link(program.get(), messages))
        refuse(glslang_program_get_info_log(program.get()));
    glslang_program_SPIRV_generate(program.get(), GLSLANG_STAGE_COMPUTE);
    std::vector<std::uint32_t> words(glslang_program_SPIRV_get_size(program.get()));
    glslang_program_SPIRV_get(program.get(), words.data());
    return words;
}

}  // namespace hshfit::gpu::inline vulkan
