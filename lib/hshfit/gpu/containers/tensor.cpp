#include <hshfit/files/tensor_file.h>
#include <hshfit/files/tensor_file_writer.h>
#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/internal/container_files.h>

namespace hshfit::gpu::inline containers {
namespace {

constexpr std::string_view sidecarField = "hshfit_sidecar";

std::string fieldName(Role role) {
    return role == Role::coefficients ? "coefficients" : "basis";
}

TensorFile::Type typeOf(Number number) {
    switch (number) {
        case Number::float16:
            return TensorFile::Type::f16;
        case Number::float32:
            return TensorFile::Type::f32;
        case Number::unorm16:
            return TensorFile::Type::u16;
        case Number::unorm8:
            break;
    }
    return TensorFile::Type::u8;
}

std::vector<std::uint64_t> shapeOf(const Texels& texels) {
    return {texels.layers, static_cast<std::uint64_t>(texels.height),
            static_cast<std::uint64_t>(texels.width), 4};
}

std::span<const unsigned char> octets(std::string_view bytes) {
    return {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()};
}

void write(const TexelFile& file, AtomicFile& out) {
    TensorFileWriter writer;
    writer.add(fieldName(file.role), typeOf(file.texels.number), shapeOf(file.texels),
               file.texels.bytes);
    writer.add(std::string(sidecarField), file.sidecar);
    writer.write(out);
}

bool recognises(std::string_view bytes) {
    if (!bytes.starts_with(TensorFile::magic)) return false;
    try {
        return TensorFile(octets(bytes), "").find(sidecarField) != nullptr;
    } catch (const InputError&) {
        return false;
    }
}

std::string sidecar(std::string_view bytes, const std::string& path) {
    const TensorFile file(octets(bytes), path);
    const auto text = file.octets(file.field(sidecarField));
    return {text.begin(), text.end()};
}

std::vector<std::byte> texels(std::string_view bytes, Role role, const Texels& expected,
                              const std::string& path) {
    const TensorFile file(octets(bytes), path);
    const TensorFile::Field& field = file.field(fieldName(role));
    if (field.type != typeOf(expected.number) || field.shape != shapeOf(expected)) {
        file.fail(field,
                  fmt::format("is {} of {}; its sidecar says {} of {}", shapeText(field.shape),
                              typeName(field.type), shapeText(shapeOf(expected)),
                              typeName(typeOf(expected.number))));
    }
    const auto raw = std::as_bytes(file.raw(field));
    return {raw.begin(), raw.end()};
}

}  // namespace

const Container& tensorContainer() {
    static const Container row{
        .name = "tensor",
        .suffix = ".tensor",
        .summary = "tensor file of Mitsuba and Falcor, [layer, y, x, lane]",
        .numbers = {Number::float16, Number::float32, Number::unorm16, Number::unorm8},
        .holdsSidecar = true,
        .write = write,
        .recognises = recognises,
        .sidecar = sidecar,
        .texels = texels};
    return row;
}

}  // namespace hshfit::gpu::inline containers
