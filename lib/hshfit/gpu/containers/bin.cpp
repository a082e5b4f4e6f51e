#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/internal/container_files.h>

namespace hshfit::gpu::inline containers {
namespace {

void write(const TexelFile& file, AtomicFile& out) {
    out.write(file.texels.bytes);
}

std::vector<std::byte> texels(std::string_view bytes, Role, const Texels& expected,
                              const std::string& file) {
    if (bytes.size() != byteCount(expected)) {
        ByteFields(bytes, file)
            .fail("the file", 0,
                  fmt::format("has {} bytes; its sidecar says {}", bytes.size(),
                              byteCount(expected)));
    }
    return bytesOf(bytes);
}

}  // namespace

const Container& binContainer() {
    static const Container row{
        .name = "bin",
        .suffix = ".{}.bin",
        .summary = "the bare numbers, little-endian; the sidecar beside it says the rest",
        .numbers = {Number::float16, Number::float32, Number::unorm16, Number::unorm8},
        .holdsSidecar = false,
        .write = write,
        .recognises = [](std::string_view) { return false; },
        .sidecar = nullptr,
        .texels = texels};
    return row;
}

}  // namespace hshfit::gpu::inline containers
