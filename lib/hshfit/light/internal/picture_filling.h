#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/light/picture_reader.h>

#include <functional>
#include <string>
#include <vector>

namespace hshfit::inline light {

using FilledPixels = std::vector<FilledPixel>;

/// Every pixel of the used area with a component that is below 0, infinite or not a number: in its
/// place the solution of Laplace's equation on the pixels, each the mean of the pixels across its
/// four edges, over the edges of the picture and of a cube's faces too. A smooth gradient goes on
/// through them. Throws InputError for more than 65536 pixels, or where no valid pixel is next to
/// them.
FilledPixels fillPixels(const std::string& path, const PictureOptions& options);

/// Fills pixels, sorted by row and column, in the same way from the pixels around them; `rows`
/// visits all rows of the picture. Throws InputError with `message` where no pixel around has a
/// value.
void fillFromAround(FilledPixels& pixels, const PictureGeometry& geometry,
                    const std::function<void(const RowVisitor&)>& rows, const std::string& message);

/// The pixel that fills a place; null where none does.
const FilledPixel* pixelAt(const FilledPixels& pixels, std::size_t row, std::size_t column);

}  // namespace hshfit::inline light
