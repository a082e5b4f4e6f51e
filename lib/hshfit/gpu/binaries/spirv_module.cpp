#include <hshfit/gpu/binaries/spirv_module.h>

#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/gpu/vulkan/spirv.h>

namespace hshfit::embedded {
extern const std::string_view binaries_compute;
}

namespace hshfit::gpu::inline binaries {
namespace {

using kainjow::mustache::data;

std::vector<std::uint32_t> moduleOf(const Channels& channels, const std::string& prefix,
                                    const std::string& snippet) {
    if (!compilesGlsl())
        throw UsageError(
            "the target spirv needs glslang, without which this program was built; expected a "
            "build "
            "with libvulkan-dev, glslang-dev and glslang-tools, or the target glsl");
    return compileGlsl(spirvSource(channels, prefix, snippet));
}

}  // namespace

std::string spirvSource(const Channels& channels, std::string_view prefix,
                        std::string_view snippet) {
    using Kind = Channels::Kind;
    const bool grey = channels.kind == Kind::grey, spectral = channels.kind == Kind::spectral;
    data page, each{data::type::list};
    page.set("snippet", std::string(snippet));
    page.set("prefix", std::string(prefix));
    page.set("group", std::to_string(spirvGroup));
    page.set("channels", std::to_string(channels.count()));
    page.set("type", spectral ? std::string(prefix) + "_Values" : grey ? "float" : "vec3");
    for (std::size_t c = 0; c < channels.count(); ++c) {
        const std::string index = std::to_string(c);
        data one;
        one.set("channel", index);
        one.set("of", grey ? "" : (spectral ? ".v[" : "[") + index + "]");
        each.push_back(one);
    }
    page.set("each", each);
    return filledText(embedded::binaries_compute, page);
}

std::vector<std::uint32_t> spirvModule(const Payload& payload, const std::string& prefix) {
    return moduleOf(
        payload.head.channels, prefix,
        shaderSource(Language::glsl, payload, {.prefix = prefix, .environmentOrder = 0}));
}

std::vector<std::uint32_t> spirvModule(const FormPayload& payload,
                                       const FormShaderOptions& options) {
    return moduleOf(payload.form.head.channels, options.prefix,
                    formShaderSource(Language::glsl, payload, options));
}

std::string spirvBytes(const std::vector<std::uint32_t>& words) {
    std::string bytes;
    bytes.reserve(4 * words.size());
    for (const std::uint32_t word : words)
        for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift);
    return bytes;
}

}  // namespace hshfit::gpu::inline binaries
