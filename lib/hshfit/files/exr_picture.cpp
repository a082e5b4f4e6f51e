#include <hshfit/checked_product.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/files/exr_stream.h>
#include <hshfit/files/printable.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

namespace hshfit::inline files {
namespace {

/// Channel `index` of `values`, which OpenEXR does not write to when it writes a file.
template <class Value>
Imf::Slice slice(Imf::PixelType type, const Value* values, std::size_t index, std::size_t channels,
                 std::size_t width) {
    const std::size_t step = channels * sizeof(Value);
    return {type, reinterpret_cast<char*>(const_cast<Value*>(values + index)), step, step * width};
}

ExrPicture readChecked(std::string_view bytes, const ExrHeader& size) {
    ExrFromMemory stream(bytes);
    Imf::InputFile input(stream, 0);
    ExrPicture picture{.width = size.width, .height = size.height};
    const auto& header = input.header();
    for (auto i = header.begin(); i != header.end(); ++i) {
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&i.attribute())) {
            picture.attributes[i.name()] = text->value();
        }
    }
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
        picture.channels.emplace_back(i.name());
    }
    const std::size_t count = picture.channels.size();
    picture.values.resize(picture.width * picture.height * count);
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < count; ++c) {
        buffer.insert(picture.channels[c],
                      slice(Imf::FLOAT, picture.values.data(), c, count, picture.width));
    }
    input.setFrameBuffer(buffer);
    input.readPixels(0, static_cast<int>(picture.height) - 1);
    return picture;
}

}  // namespace

void writeExrPicture(const ExrPicture& picture, ExrPixels pixels, AtomicFile& file) {
    Imf::Header header(static_cast<int>(picture.width), static_cast<int>(picture.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, text] : picture.attributes) {
        header.insert(name, Imf::StringAttribute(text));
    }
    const Imf::PixelType type = pixels == ExrPixels::half ? Imf::HALF : Imf::FLOAT;
    for (const auto& name : picture.channels) header.channels().insert(name, Imf::Channel(type));
    const std::size_t count = picture.channels.size();
    std::vector<half> halves;
    if (pixels == ExrPixels::half) halves.assign(picture.values.begin(), picture.values.end());
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < count; ++c) {
        buffer.insert(picture.channels[c],
                      pixels == ExrPixels::half
                          ? slice(type, halves.data(), c, count, picture.width)
                          : slice(type, picture.values.data(), c, count, picture.width));
    }
    try {
        ExrToFile stream(file);
        Imf::OutputFile output(stream, header, 0);
        output.setFrameBuffer(buffer);
        output.writePixels(static_cast<int>(picture.height));
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw OutputError(fmt::format("cannot write the EXR file: {}", error.what()));
    }
}

ExrPicture readExrPicture(std::string_view bytes, const std::string& file, std::size_t most) {
    const ExrHeader size = checkExrHeader(bytes, file, {.files = "pictures", .picture = true});
    const auto values = checkedProduct({size.width, size.height, size.channels});
    if (!values || *values > most) {
        throw InputError(
            fmt::format("{}: {} x {} pixels of {} channels are too many; at most {} "
                        "values are read",
                        file, size.width, size.height, size.channels, most));
    }
    try {
        return readChecked(bytes, size);
    } catch (const std::exception& error) {
        throw InputError(
            fmt::format("{}: invalid OpenEXR data: {}", file, printable(error.what())));
    }
}

}  // namespace hshfit::inline files
