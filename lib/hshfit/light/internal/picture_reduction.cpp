#include <hshfit/light/internal/picture_reduction.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

/// Sides divided by the least whole number with which at most `most` pixels are left, rounded down
/// to whole pixels of a face.
PictureGeometry reduced(const PictureGeometry& file, std::size_t most) {
    const double excess = static_cast<double>(file.width) * static_cast<double>(file.height) /
                          static_cast<double>(most);
    if (excess <= 1) return file;
    const auto divisor = static_cast<std::size_t>(std::ceil(std::sqrt(excess)));
    const std::size_t unit =
        file.faceSize() > 0 ? file.faceSize() : std::min(file.width, file.height);
    const std::size_t kept = std::max(unit / divisor, std::size_t{1});
    return {file.layout, file.width / unit * kept, file.height / unit * kept};
}

/// The kept pixel in which a file's pixel begins, and the share of it that lies there.
std::pair<std::size_t, double> overlap(std::size_t index, std::size_t from, std::size_t to) {
    const std::size_t first = index * to / from;
    const std::size_t end = (first + 1) * from;  // in units of 1 / to of a file's pixel
    const std::size_t begin = index * to;
    const double share = std::min(1.0, static_cast<double>(end - begin) / static_cast<double>(to));
    return {first, share};
}

}  // namespace

double middleWeight(const PictureGeometry& g, std::size_t column, std::size_t row) {
    const auto middle = [](std::size_t k, std::size_t count) {
        return 2 * (static_cast<double>(k) + 0.5) / static_cast<double>(count) - 1;
    };
    if (g.layout == PictureLayout::latlong) return std::cos(pi / 2 * middle(row, g.height));
    if (const std::size_t n = g.faceSize(); n > 0) {
        const double a = middle(column % n, n), b = middle(row % n, n), squared = 1 + a * a + b * b;
        return 1 / (squared * std::sqrt(squared));
    }
    if (g.layout == PictureLayout::equalArea) return 1;
    const double r = std::hypot(middle(column, g.width), middle(row, g.height));
    if (r >= 1) return 0;
    if (g.layout == PictureLayout::mirrorBall) return 1;
    const double rim = g.layout == PictureLayout::dome ? pi / 2 : pi;
    return r > 0 ? std::sin(rim * r) / r : rim;
}

PictureReduction::PictureReduction(const PictureGeometry& file, std::size_t most)
    : file_(file), kept_(reduced(file, most)) {
    rgb_.reserve(3 * kept_.width * kept_.height);
    if (kept_.width == file_.width) return;
    for (std::size_t column = 0; column < file_.width; ++column) {
        const auto [first, share] = overlap(column, file_.width, kept_.width);
        overlaps_.push_back({first, share});
    }
    sums_.assign(4 * (kept_.width + 1), 0);
}

void PictureReduction::add(std::size_t row, std::span<const float> rgb) {
    if (overlaps_.empty()) {
        rgb_.insert(rgb_.end(), rgb.begin(), rgb.end());
        return;
    }
    const auto [first, share] = overlap(row, file_.height, kept_.height);
    if (first > inProgress_) finish(inProgress_);
    addTo(first, share, row, rgb);
    if (share < 1) {
        finish(first);
        addTo(first + 1, 1 - share, row, rgb);
    }
    if (row + 1 == file_.height) finish(inProgress_);
}

void PictureReduction::addTo(std::size_t keptRow, double share, std::size_t row,
                             std::span<const float> rgb) {
    inProgress_ = keptRow;
    const bool latlong = file_.layout == PictureLayout::latlong;
    const double ofRow = latlong ? middleWeight(file_, 0, row) : 0;
    for (std::size_t column = 0; column < file_.width; ++column) {
        const double weight = share * (latlong ? ofRow : middleWeight(file_, column, row));
        const auto [left, part] = overlaps_[column];
        for (const auto& [at, own] :
             {std::pair(left, part * weight), std::pair(left + 1, (1 - part) * weight)}) {
            if (!(own > 0)) continue;
            double* sum = sums_.data() + 4 * at;
            for (std::size_t c = 0; c < 3; ++c) sum[c] += own * rgb[3 * column + c];
            sum[3] += own;
        }
    }
}

void PictureReduction::finish(std::size_t keptRow) {
    for (std::size_t column = 0; column < kept_.width; ++column) {
        const double* sum = sums_.data() + 4 * column;
        for (std::size_t c = 0; c < 3; ++c) {
            rgb_.push_back(sum[3] > 0 ? static_cast<float>(sum[c] / sum[3]) : 0.F);
        }
    }
    std::ranges::fill(sums_, 0.0);
    inProgress_ = keptRow + 1;
}

}  // namespace hshfit::inline light
