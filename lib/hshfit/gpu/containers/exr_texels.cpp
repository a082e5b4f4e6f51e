#include <hshfit/gpu/containers/internal/exr_texels.h>

#include <hshfit/error.h>

#include <ImfChannelList.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

namespace hshfit::gpu::inline containers {
namespace {

constexpr const char* names[] = {"R", "G", "B", "A"};

Imf::PixelType pixelType(Number number) {
    return number == Number::float16 ? Imf::HALF : Imf::FLOAT;
}

}  // namespace

Imf::Header exrHeader(const Texels& texels, int height) {
    if (isNormalised(texels.number)) {
        throw UsageError("EXR holds floating-point numbers only");
    }
    Imf::Header header(texels.width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* name : names) {
        header.channels().insert(name, Imf::Channel(pixelType(texels.number)));
    }
    return header;
}

void describeExr(const TexelFile& file, Imf::Header& header) {
    for (const auto& [key, value] : file.facts) {
        header.insert("hshfit:" + key, Imf::StringAttribute(value));
    }
    header.insert(std::string(exrSidecar), Imf::StringAttribute(file.sidecar));
}

Imf::FrameBuffer exrSlices(const Texels& texels, const std::byte* first) {
    const std::size_t size = numberBytes(texels.number), step = 4 * size;
    Imf::FrameBuffer buffer;
    for (std::size_t lane = 0; lane < 4; ++lane) {
        auto* base = reinterpret_cast<char*>(const_cast<std::byte*>(first + lane * size));
        buffer.insert(names[lane], Imf::Slice(pixelType(texels.number), base, step,
                                              step * static_cast<std::size_t>(texels.width)));
    }
    return buffer;
}

void checkExrChannels(const Imf::Header& header, const Texels& texels, const std::string& file) {
    for (const char* name : names) {
        const Imf::Channel* channel = header.channels().findChannel(name);
        if (channel && channel->type == pixelType(texels.number)) continue;
        throw InputError(fmt::format("{}: has no channel '{}' of {}, as its sidecar says", file,
                                     name, numberName(texels.number)));
    }
}

std::string exrSidecarOf(const Imf::Header& header, const std::string& file) {
    const auto* text = header.findTypedAttribute<Imf::StringAttribute>(std::string(exrSidecar));
    if (!text) {
        throw InputError(fmt::format("{}: has no attribute '{}'", file, exrSidecar));
    }
    return text->value();
}

}  // namespace hshfit::gpu::inline containers
