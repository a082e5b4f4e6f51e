#include <hshfit/files/exr_header.h>
#include <hshfit/files/exr_stream.h>
#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/internal/container_files.h>
#include <hshfit/gpu/containers/internal/exr_texels.h>

#include <ImfInputFile.h>
#include <ImfOutputFile.h>

namespace hshfit::gpu::inline containers {
namespace {

constexpr std::size_t maxHeight = 1 << 16;  // for headers that checkExrHeader accepts
constexpr ExrRules rules{.files = "strips of texels", .picture = true};

std::size_t stripHeight(const Texels& texels) {
    return static_cast<std::size_t>(texels.height) * texels.layers;
}

void write(const TexelFile& file, AtomicFile& out) {
    const Texels& texels = file.texels;
    if (stripHeight(texels) > maxHeight) {
        throw UsageError(fmt::format(
            "an EXR strip of {} layers of {} rows is too high for its readers (at most {} rows); "
            "use exr-parts or ktx2",
            texels.layers, texels.height, maxHeight));
    }
    Imf::Header header = exrHeader(texels, static_cast<int>(stripHeight(texels)));
    describeExr(file, header);
    try {
        ExrToFile stream(out);
        Imf::OutputFile output(stream, header, 0);
        output.setFrameBuffer(exrSlices(texels, texels.bytes.data()));
        output.writePixels(static_cast<int>(stripHeight(texels)));
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw OutputError(fmt::format("cannot write the EXR file: {}", error.what()));
    }
}

bool recognises(std::string_view bytes) {
    return !exrHasParts(bytes) && exrHasAttribute(bytes, exrSidecar);
}

std::string sidecar(std::string_view bytes, const std::string& file) {
    checkExrHeader(bytes, file, rules);
    return readingExr(file, [&] {
        ExrFromMemory stream(bytes);
        return exrSidecarOf(Imf::InputFile(stream, 0).header(), file);
    });
}

std::vector<std::byte> texels(std::string_view bytes, Role, const Texels& expected,
                              const std::string& file) {
    const ExrHeader size = checkExrHeader(bytes, file, rules);
    if (size.width != static_cast<std::size_t>(expected.width) ||
        size.height != stripHeight(expected) || size.channels != 4) {
        throw InputError(fmt::format(
            "{}: has {} x {} pixels of {} channels; its sidecar says {} x {} of 4", file,
            size.width, size.height, size.channels, expected.width, stripHeight(expected)));
    }
    return readingExr(file, [&] {
        ExrFromMemory stream(bytes);
        Imf::InputFile input(stream, 0);
        checkExrChannels(input.header(), expected, file);
        std::vector<std::byte> result(byteCount(expected));
        input.setFrameBuffer(exrSlices(expected, result.data()));
        input.readPixels(0, static_cast<int>(size.height) - 1);
        return result;
    });
}

}  // namespace

const Container& exrContainer() {
    static const Container row{.name = "exr",
                               .suffix = ".strip.exr",
                               .summary = "OpenEXR picture, the layers one below the other, ZIP",
                               .numbers = {Number::float16, Number::float32},
                               .holdsSidecar = true,
                               .write = write,
                               .recognises = recognises,
                               .sidecar = sidecar,
                               .texels = texels};
    return row;
}

}  // namespace hshfit::gpu::inline containers
