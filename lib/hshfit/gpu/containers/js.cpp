// An ECMAScript module: metadata as an object literal (the sidecar word for word), the numbers as a
// typed array out of base64.

#include <hshfit/files/checksum.h>
#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/internal/container_files.h>

namespace hshfit::gpu::inline containers {
namespace {

constexpr std::string_view magic = "// hshfit-gpu 1: ";
constexpr std::string_view metadataStart = "\nexport const metadata = ";
constexpr std::string_view metadataEnd = "\n};\n";
constexpr std::string_view base64Start = "\nconst base64 = \"";
constexpr std::string_view base64End = "\";\n";

/// WebGL and WebGPU take half floats as Uint16Array.
std::string_view arrayType(Number number) {
    switch (number) {
        case Number::float16:
        case Number::unorm16:
            return "Uint16Array";
        case Number::float32:
            return "Float32Array";
        case Number::unorm8:
            break;
    }
    return "Uint8Array";
}

void write(const TexelFile& file, AtomicFile& out) {
    std::string json = file.sidecar;
    while (!json.empty() && json.back() == '\n') json.pop_back();
    out.write(fmt::format("{}{} texels, index {}\n", magic, roleName(file.role),
                          "((layer*height + y)*width + x)*4 + lane"));
    out.write(metadataStart);
    out.write(json);
    out.write(";\n");
    out.write(base64Start);
    out.write(base64(file.texels.bytes));
    out.write(base64End);
    out.write("\nconst octets = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));\n");
    out.write(fmt::format("export const {} = new {}(octets.buffer);\n",
                          file.role == Role::coefficients ? "coefficients" : "basis",
                          arrayType(file.texels.number)));
}

/// The text between two marks.
std::string_view between(std::string_view bytes, std::string_view start, std::string_view end,
                         std::size_t keep, const std::string& file) {
    const std::size_t first = bytes.find(start);
    const std::size_t last = first == bytes.npos ? first : bytes.find(end, first + start.size());
    if (last == bytes.npos) {
        throw InputError(
            fmt::format("{}: '{}' and its end are not there; only modules as hshfit "
                        "writes them can be read",
                        file, start.substr(1)));
    }
    return bytes.substr(first + start.size(), last + keep - first - start.size());
}

std::string sidecar(std::string_view bytes, const std::string& file) {
    return std::string(between(bytes, metadataStart, metadataEnd, 2, file));
}

std::vector<std::byte> texels(std::string_view bytes, Role, const Texels& expected,
                              const std::string& file) {
    const std::string_view text = between(bytes, base64Start, base64End, 0, file);
    const std::size_t count = byteCount(expected);
    if (text.size() != (count + 2) / 3 * 4) {
        throw InputError(fmt::format("{}: has {} characters of base64; its sidecar asks for {}",
                                     file, text.size(), (count + 2) / 3 * 4));
    }
    std::vector<std::byte> result = fromBase64(text, count);
    if (result.size() != count) {
        throw InputError(fmt::format("{}: the base64 of the texels is damaged", file));
    }
    return result;
}

}  // namespace

const Container& jsContainer() {
    static const Container row{
        .name = "js",
        .suffix = ".js",
        .summary = "ECMAScript module: a typed array and the metadata",
        .numbers = {Number::float16, Number::float32, Number::unorm16, Number::unorm8},
        .holdsSidecar = true,
        .write = write,
        .recognises = [](std::string_view bytes) { return bytes.starts_with(magic); },
        .sidecar = sidecar,
        .texels = texels};
    return row;
}

}  // namespace hshfit::gpu::inline containers
