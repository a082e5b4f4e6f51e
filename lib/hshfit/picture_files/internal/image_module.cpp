// The module itself: all that is linked to OpenImageIO.
#include <hshfit/picture_files/internal/image_module.h>

#include <OpenImageIO/imageio.h>

#include <memory>

namespace hshfit::inline picture_files {
namespace {

class Picture : public ImageModulePicture {
public:
    Picture(std::unique_ptr<OIIO::ImageInput> input, int part)
        : input_(std::move(input)), part_(part) {
        constexpr int mostParts = 1024;
        for (int k = 0; k < mostParts && input_->seek_subimage(k, 0); ++k) {
            partNames.emplace_back(input_->spec().get_string_attribute("oiio:subimagename"));
            partChannels.push_back(input_->spec().channelnames);
        }
        input_->geterror();  // of the part beyond the last
        if (!input_->seek_subimage(part, 0)) return;
        const OIIO::ImageSpec& spec = input_->spec();
        width = spec.width, height = spec.height, depth = spec.depth, x = spec.x, y = spec.y;
        fullWidth = spec.full_width, fullHeight = spec.full_height;
        fullX = spec.full_x, fullY = spec.full_y;
        tileWidth = spec.tile_width;
        tileHeight = spec.tile_width > 0 ? spec.tile_height : 0;
        orientation = spec.get_int_attribute("Orientation", 1);
        deep = spec.deep;
        floating = spec.format.is_floating_point();
        number = spec.format.c_str();
        environment = std::string(spec.get_string_attribute("textureformat"));
        channels = spec.channelnames;
        const OIIO::ParamValue* primaries = spec.find_attribute("chromaticities");
        constexpr int numbers = 8;
        if (primaries && primaries->type().basetype == OIIO::TypeDesc::FLOAT &&
            primaries->type().numelements() * primaries->type().aggregate == numbers) {
            const auto* from = static_cast<const float*>(primaries->data());
            chromaticities.assign(from, from + numbers);
        }
    }

    bool read(int top, int bottom, int first, int last, float* values) override {
        const auto type = OIIO::TypeDesc::FLOAT;
        // Rows and columns of OpenImageIO count from the origin of the window.
        const bool good = tileHeight > 0
                              ? input_->read_tiles(part_, 0, x, x + width, y + top, y + bottom, 0,
                                                   1, first, last, type, values)
                              : input_->read_scanlines(part_, 0, y + top, y + bottom, 0, first,
                                                       last, type, values);
        if (good && !input_->has_error()) return true;
        error = input_->geterror();
        return false;
    }

private:
    std::unique_ptr<OIIO::ImageInput> input_;
    int part_ = 0;
};

}  // namespace
}  // namespace hshfit::inline picture_files

extern "C" [[gnu::visibility("default")]] hshfit::ImageModulePicture* hshfitOpenImage(
    const char* plugin, const char* path, int part, std::string& error) {
    auto input = OIIO::ImageInput::create(plugin);
    if (!input) {
        error = OIIO::geterror();
        return nullptr;
    }
    OIIO::ImageSpec spec, hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    if (!input->open(path, spec, hints)) {
        error = input->geterror();
        return nullptr;
    }
    return new hshfit::Picture(std::move(input), part);
}
