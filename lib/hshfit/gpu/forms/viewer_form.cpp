#include <hshfit/gpu/forms/viewer_form.h>

#include <fmt/format.h>

#include <cctype>

namespace hshfit::gpu::inline forms {

ViewerForm viewerForm(const FormPayload& given, Storage storage, double roughness) {
    FormPayload payload = given;
    payload.form.head.source = shownName(payload.form.head.source);
    const Representation& form = payload.form;
    ViewerForm pane;
    pane.name = std::string(kindName(form.kind()));
    pane.name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(pane.name[0])));
    pane.name += form.kind() == Representation::Kind::halfway
                     ? fmt::format(" {},{},{}", form.halfway.half, form.halfway.difference,
                                   form.halfway.azimuth)
                     : fmt::format(" {} {}", form.head.basis, form.head.order);
    pane.spectral = form.head.channels.kind == Channels::Kind::spectral;
    pane.roughness = roughness;
    FormShaderOptions options{.prefix = pane.prefix, .storage = storageFor(payload, storage)};
    if (options.storage == Storage::block) options.storage = Storage::texture;
    pane.shader = formShaderSource(Language::glslEs, payload, options);
    if (options.storage == Storage::texture) pane.texels = payload.texels;
    return pane;
}

}  // namespace hshfit::gpu::inline forms
