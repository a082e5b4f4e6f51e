#include <hshfit/files/exr_header.h>
#include <hshfit/files/exr_stream.h>
#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/internal/container_files.h>
#include <hshfit/gpu/containers/internal/exr_texels.h>

#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>

namespace hshfit::gpu::inline containers {
namespace {

constexpr ExrRules rules{.files = "parts of texels", .picture = true};

std::size_t layerBytes(const Texels& texels) {
    return byteCount(texels) / texels.layers;
}

void write(const TexelFile& file, AtomicFile& out) {
    const Texels& texels = file.texels;
    std::vector<Imf::Header> headers(texels.layers, exrHeader(texels, texels.height));
    for (std::size_t layer = 0; layer < headers.size(); ++layer) {
        headers[layer].setName(fmt::format("layer{:03}", layer));
        headers[layer].setType(Imf::SCANLINEIMAGE);
    }
    describeExr(file, headers[0]);
    try {
        ExrToFile stream(out);
        Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()),
                                        false, 0);
        for (std::size_t layer = 0; layer < headers.size(); ++layer) {
            Imf::OutputPart part(output, static_cast<int>(layer));
            part.setFrameBuffer(
                exrSlices(texels, texels.bytes.data() + layer * layerBytes(texels)));
            part.writePixels(texels.height);
        }
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw OutputError(fmt::format("cannot write the EXR file: {}", error.what()));
    }
}

bool recognises(std::string_view bytes) {
    return exrHasParts(bytes) && exrHasAttribute(bytes, exrSidecar);
}

std::string sidecar(std::string_view bytes, const std::string& file) {
    checkExrParts(bytes, file, rules, maxLayers);
    return readingExr(file, [&] {
        ExrFromMemory stream(bytes);
        return exrSidecarOf(Imf::MultiPartInputFile(stream, 0).header(0), file);
    });
}

std::vector<std::byte> texels(std::string_view bytes, Role, const Texels& expected,
                              const std::string& file) {
    const std::vector<ExrHeader> sizes = checkExrParts(bytes, file, rules, maxLayers);
    if (sizes.size() != expected.layers) {
        throw InputError(fmt::format("{}: has {} parts; its sidecar says {} layers", file,
                                     sizes.size(), expected.layers));
    }
    for (const ExrHeader& size : sizes) {
        if (size.width == static_cast<std::size_t>(expected.width) &&
            size.height == static_cast<std::size_t>(expected.height) && size.channels == 4) {
            continue;
        }
        throw InputError(fmt::format(
            "{}: has a part of {} x {} pixels and {} channels; its sidecar says {} x {} of 4", file,
            size.width, size.height, size.channels, expected.width, expected.height));
    }
    return readingExr(file, [&] {
        ExrFromMemory stream(bytes);
        Imf::MultiPartInputFile input(stream, 0);
        std::vector<std::byte> result(byteCount(expected));
        for (std::size_t layer = 0; layer < expected.layers; ++layer) {
            checkExrChannels(input.header(static_cast<int>(layer)), expected, file);
            Imf::InputPart part(input, static_cast<int>(layer));
            part.setFrameBuffer(exrSlices(expected, result.data() + layer * layerBytes(expected)));
            part.readPixels(0, expected.height - 1);
        }
        return result;
    });
}

}  // namespace

const Container& exrPartsContainer() {
    static const Container row{
        .name = "exr-parts",
        .suffix = ".parts.exr",
        .summary = "OpenEXR file with a part for each layer, for OIIO and OSL",
        .numbers = {Number::float16, Number::float32},
        .holdsSidecar = true,
        .write = write,
        .recognises = recognises,
        .sidecar = sidecar,
        .texels = texels};
    return row;
}

}  // namespace hshfit::gpu::inline containers
