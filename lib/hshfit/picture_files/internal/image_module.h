#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline picture_files {

/// A picture as OpenImageIO opened it. OpenImageIO and its libraries take some tenths of a second
/// to load, so that they are linked to a module (image_module.cpp) that the first picture loads.
class ImageModulePicture {
public:
    virtual ~ImageModulePicture() = default;

    /// Rows [top, bottom) from the first stored one, channels [first, last):
    /// [row][column][channel]. False with `error`.
    virtual bool read(int top, int bottom, int first, int last, float* values) = 0;

    int width = 0, height = 0, depth = 1, x = 0, y = 0;
    int fullWidth = 0, fullHeight = 0, fullX = 0, fullY = 0;
    int tileWidth = 0, tileHeight = 0;  ///< 0: scan lines
    int orientation = 1;
    bool deep = false, floating = false;
    std::string number;       ///< "half", "uint8", …
    std::string environment;  ///< of an OpenEXR environment map
    std::vector<std::string> channels;
    std::vector<float> chromaticities;   ///< of OpenEXR: x, y of red, green, blue, white; or none
    std::vector<std::string> partNames;  ///< of every part of the file
    std::vector<std::vector<std::string>> partChannels;  ///< likewise
    std::string error;
};

/// The name and the type of the module's only function: opens part `part` of `path` by the plug-in
/// of a format; null, with the reason in `error`, where that fails.
inline constexpr const char* imageModuleFunction = "hshfitOpenImage";
using ImageModuleFunction = ImageModulePicture*(const char* plugin, const char* path, int part,
                                                std::string& error);

/// The function imageModuleFunction of the module. Throws InputError where the module, a file
/// beside the program, is missing.
ImageModuleFunction& imageModule();

}  // namespace hshfit::inline picture_files
