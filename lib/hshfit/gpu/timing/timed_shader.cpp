#include <hshfit/gpu/timing/timed_shader.h>

#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/forms/form_table.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/representation/named_arrays.h>

#include <fmt/format.h>

#include <cstdint>
#include <string_view>

namespace hshfit::embedded {
extern const std::string_view lobes, timed_pixels;
}

namespace hshfit::gpu::inline timing {
namespace {

using kainjow::mustache::data;

std::string render(data& page) {
    page.set("side", std::to_string(timedSide));
    return filledText(embedded::timed_pixels, page);
}

ComputeResource sumsBuffer() {
    return {.binding = sumsBinding, .count = std::size_t{timedSide} * timedSide};
}

std::string wrapped(const std::string& snippet, const Channels& channels) {
    using Kind = Channels::Kind;
    const bool grey = channels.kind == Kind::grey, spectral = channels.kind == Kind::spectral;
    data page, each{data::type::list};
    page.set("snippet", snippet);
    page.set("evaluates", true);
    page.set("type", spectral ? "hsh_Values" : grey ? "float" : "vec3");
    for (std::size_t c = 0; c < channels.count(); ++c) {
        data one;
        one.set("first", c == 0);
        one.set("of", grey ? "" : (spectral ? ".v[" : "[") + std::to_string(c) + "]");
        each.push_back(one);
    }
    page.set("each", each);
    return render(page);
}

TimedShader shaderOfForm(const Representation& form) {
    const FormPayload payload = packForm(form);
    const Storage storage = storageFor(payload, Storage::automatic);
    TimedShader shader{wrapped(formShaderSource(Language::glsl, payload, {.storage = storage}),
                               form.head.channels),
                       {sumsBuffer()}};
    using Kind = ComputeResource::Kind;
    if (storage == Storage::texture) {
        shader.resources.push_back(
            {.binding = 0, .kind = Kind::sampledTexture, .texels = payload.texels});
    } else if (storage == Storage::block) {
        const std::vector<double> values = decode(payload.texels);
        shader.resources.push_back(
            {.binding = 0, .kind = Kind::uniforms, .numbers = {values.begin(), values.end()}});
    }
    return shader;
}

Number numberOf(Precision precision) {
    switch (precision) {
        case Precision::half:
            return Number::float16;
        case Precision::unorm16:
            return Number::unorm16;
        case Precision::unorm8:
            return Number::unorm8;
        case Precision::float64:
        case Precision::float32:
            break;
    }
    return Number::float32;
}

}  // namespace

TimedShader timedShader(const Representation& form) {
    if (form.kind() != Representation::Kind::outgoing) {
        if (!hasShader(form)) throw UsageError("this form has no shader of its own");
        return shaderOfForm(form);
    }
    if (!form.added.empty())
        throw UsageError("coefficients with a BRDF added have no shader of their own");
    Payload payload =
        pack(decoded(form), {.number = numberOf(namedArrays(form).front().array->precision)});
    const std::string snippet = shaderSource(Language::glsl, payload, {.environmentOrder = 0});
    return {wrapped(snippet, form.head.channels),
            {sumsBuffer(),
             {.binding = 0,
              .kind = ComputeResource::Kind::sampledTexture,
              .texels = std::move(payload.coefficients)}}};
}

TimedShader lobesShader(int lobes) {
    data page, each{data::type::list};
    for (int k = 1; k <= lobes; ++k) {
        // Unlike each other, so that none is shared.
        data lobe("a2", fmt::format("{:.4f}", 0.08 / k));
        lobe.set("f0", fmt::format("{:.4f}", 1.0 / (k + 1)));
        each.push_back(lobe);
    }
    page.set("lobes", each);
    const Channels rgb{.kind = Channels::Kind::rgb};
    return {wrapped(filledText(embedded::lobes, page), rgb), {sumsBuffer()}};
}

TimedShader bareShader() {
    data page;
    page.set("evaluates", false);
    page.set("snippet", std::string());
    return {render(page), {sumsBuffer()}};
}

}  // namespace hshfit::gpu::inline timing
