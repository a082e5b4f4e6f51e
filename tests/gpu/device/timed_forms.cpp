// timed_forms NETWORK.glsl: keeps shaders to be timed (HSHFIT_KEEP_SHADERS) of forms in their usual
// sizes, of GGX + Lambert, of nothing, and of the network in the file.

#include "../shaders/runners.h"

#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/timing/timed_shader.h>
#include <hshfit/representation/forms/form.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iterator>

namespace hshfit::shaders {
namespace {

using Kind = gpu::ComputeResource::Kind;

std::string textIn(const char* path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(fmt::format("cannot read {}", path));
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The formula of a lobe with Lambert, which the library has within a shader of its own.
std::string lobeSnippet() {
    const std::string source = gpu::lobesShader(1).source;
    const std::size_t first = source.find('\n') + 1;
    return source.substr(first, source.find("layout(local_size") - first);
}

/// The form of a BRDF, whose numbers do not change what its shader costs.
Representation formOf(const Form& form) {
    const auto open = [](const std::string& spec) { return brdfs::open(spec); };
    const char* spec = form.kind == Representation::Kind::basis
                           ? "lambert:kd=.5/.3/.2 + ggx:alpha=.6,F0=.9/.6/.3"
                           : "lambert:kd=.1/.2/.3 + ggx:alpha=.3,F0=.9/.6/.3";
    return represent(*brdfs::open(spec), form, open, {.tolerance = 1e-2});
}

void keepForm(int place, const std::string& name, const Form& form, gpu::Storage storage) {
    const gpu::FormPayload payload = gpu::packForm(formOf(form));
    std::vector<gpu::ComputeResource> resources;
    if (storage == gpu::Storage::texture)
        resources.push_back({.kind = Kind::sampledTexture, .texels = payload.texels});
    keepTimed(
        {.place = place,
         .name = fmt::format("{}, {}", name, gpu::storageName(storage)),
         .snippet = gpu::formShaderSource(gpu::Language::glsl, payload, {.storage = storage})},
        std::move(resources));
}

void keepOutgoing(int place, const std::string& name, const Form& form) {
    const gpu::Payload payload = gpu::pack(decoded(formOf(form)), {.number = gpu::Number::float16});
    keepTimed({.place = place,
               .name = name + ", texture",
               .snippet = gpu::shaderSource(gpu::Language::glsl, payload, {.environmentOrder = 0})},
              {{.kind = Kind::sampledTexture, .texels = payload.coefficients}});
}

void keepAll(const char* network) {
    using Form = hshfit::Form;
    using Content = Representation::Kind;
    using gpu::Storage;
    constexpr Precision half = Precision::half;
    keepTimed({.place = 0,
               .name = "nothing",
               .snippet = "vec3 hsh_eval(vec3 wo, vec3 wi) { return wo + wi; }\n"},
              {});
    keepTimed({.place = 1, .name = "GGX + Lambert", .snippet = lobeSnippet()}, {});
    keepTimed({.place = 2, .name = "network, 675 weights", .snippet = textIn(network)}, {});
    int place = 10;
    const Form halfway[] = {
        {.kind = Content::halfway, .halfway = {5, 4, 3}, .precision = half},
        {.kind = Content::halfway, .halfway = {8, 4, 3}, .precision = half},
        {.kind = Content::halfway, .precision = half},
    };
    const char* names[] = {"`--halfway 5,4,3`", "`--halfway 8,4,3`", "`--form halfway`"};
    for (std::size_t k = 0; k < std::size(halfway); ++k)
        for (const Storage storage : {Storage::constants, Storage::texture})
            keepForm(place++, names[k], halfway[k], storage);
    for (const int order : {4, 8})
        keepForm(place++, fmt::format("`--form basis --basis zernike --order {}`", order),
                 {.kind = Content::basis,
                  .basis = "zernike",
                  .order = order,
                  .reciprocal = true,
                  .precision = half},
                 Storage::constants);
    keepOutgoing(place++, "`--basis hsh --order 8 --outgoing 16`",
                 {.order = 8, .outgoing = "16", .precision = half});
}

}  // namespace
}  // namespace hshfit::shaders

int main(int count, char** arguments) {
    try {
        if (count != 2 || std::getenv("HSHFIT_KEEP_SHADERS") == nullptr)
            throw std::runtime_error("HSHFIT_KEEP_SHADERS=FOLDER timed_forms NETWORK.glsl");
        hshfit::shaders::keepAll(arguments[1]);
    } catch (const std::exception& error) {
        fmt::print(stderr, "timed_forms: {}\n", error.what());
        return 1;
    }
    return 0;
}
