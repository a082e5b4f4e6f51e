#include <hshfit/rendering/internal/normal_table.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/rendering/view.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::inline rendering {
namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);
constexpr std::size_t faces = 6;

/// Coordinates along the two edges of a face, and out of it: x, y, z from `axis` on, in turn.
struct FaceVector {
    double a, b, out;
};
FaceVector onFace(std::size_t axis, const Direction& d) {
    switch (axis) {
        case 0:
            return {d.y, d.z, d.x};
        case 1:
            return {d.z, d.x, d.y};
        default:
            return {d.x, d.y, d.z};
    }
}
Direction fromFace(std::size_t axis, const FaceVector& v) {
    switch (axis) {
        case 0:
            return {v.out, v.a, v.b};
        case 1:
            return {v.b, v.out, v.a};
        default:
            return {v.a, v.b, v.out};
    }
}

/// The two faces of one axis follow each other: out and back.
std::size_t faceOf(const Direction& n) {
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const std::size_t axis = z >= x && z >= y ? 2 : y >= x ? 1 : 0;
    return 2 * axis + (onFace(axis, n).out < 0 ? 1 : 0);
}

/// The axes of a face at a normal.
Frame faceFrame(std::size_t face, const Direction& n) {
    Frame frame = frameAt(n);
    if (face / 2 != 2) return frame;
    const double across = std::hypot(n.y, n.z);
    frame.tangent = {0, -n.z / across, n.y / across};  // along x times n
    frame.bitangent = cross(n, frame.tangent);
    return frame;
}

/// Lagrange's cubic polynomials of the nodes -1, 0, 1, 2 at x.
std::array<double, 4> cubicWeights(double x) {
    return {-x * (x - 1) * (x - 2) / 6, (x + 1) * (x - 1) * (x - 2) / 2, -(x + 1) * x * (x - 2) / 2,
            (x + 1) * x * (x - 1) / 6};
}

}  // namespace

NormalTable::NormalTable(std::span<const Direction> normals, int perEdge)
    : perEdge_(static_cast<std::size_t>(perEdge)) {
    const std::size_t edge = perEdge_ + 3;  // vertices along a face's edge, with the rim
    vertexOf_.assign(faces * edge * edge, none);
    cellNumber_.assign(faces * perEdge_ * perEdge_, none);
    std::vector<double> distances;
    for (std::size_t k = 0; k < normals.size(); ++k) {
        const Place at = placeOf(normals[k]);
        const double distance = std::hypot(at.x - 0.5, at.y - 0.5);
        std::size_t& number = cellNumber_[cellIndex(at)];
        if (number == none) {
            number = middles_.size();
            middles_.push_back(k);
            distances.push_back(distance);
            for (std::size_t j = 0; j < 4; ++j) {
                for (std::size_t i = 0; i < 4; ++i) {
                    const std::size_t column = at.column + i, row = at.row + j;
                    std::size_t& vertex = vertexOf_[vertexIndex(at.face, column, row)];
                    if (vertex != none) continue;
                    vertex = frames_.size();
                    const Direction normal = normalAt(at.face, static_cast<double>(column) - 1,
                                                      static_cast<double>(row) - 1);
                    frames_.push_back(faceFrame(at.face, normal));
                }
            }
        } else if (distance < distances[number]) {
            middles_[number] = k;
            distances[number] = distance;
        }
    }
}

std::size_t NormalTable::vertexIndex(std::size_t face, std::size_t column, std::size_t row) const {
    const std::size_t edge = perEdge_ + 3;
    return (face * edge + row) * edge + column;
}

std::size_t NormalTable::cellIndex(const Place& place) const {
    return (place.face * perEdge_ + place.row) * perEdge_ + place.column;
}

NormalTable::Place NormalTable::placeOf(const Direction& normal) const {
    const std::size_t face = faceOf(normal);
    const FaceVector v = onFace(face / 2, normal);
    const auto cells = static_cast<double>(perEdge_);
    const auto along = [&](double part) {
        return std::clamp((std::atan2(part, std::abs(v.out)) / (pi / 2) + 0.5) * cells, 0.0, cells);
    };
    const auto lower = [&](double at) {
        return std::min(static_cast<std::size_t>(at), perEdge_ - 1);
    };
    const double x = along(v.a), y = along(v.b);
    const std::size_t column = lower(x), row = lower(y);
    return {face, column, row, x - static_cast<double>(column), y - static_cast<double>(row)};
}

Direction NormalTable::normalAt(std::size_t face, double column, double row) const {
    const auto part = [&](double at) {
        return std::tan((at / static_cast<double>(perEdge_) - 0.5) * (pi / 2));
    };
    return normalised(fromFace(face / 2, {part(column), part(row), face % 2 == 0 ? 1.0 : -1.0}));
}

void NormalTable::fill(std::size_t count, const At& at) {
    count_ = count;
    values_.resize(count * frames_.size());
    tbb::parallel_for(std::size_t{0}, frames_.size(),
                      [&](std::size_t k) { at(frames_[k], values_.data() + k * count); });
}

std::size_t NormalTable::cellOf(const Direction& normal) const {
    return cellNumber_[cellIndex(placeOf(normal))];
}

std::vector<std::size_t> NormalTable::cellsAround(const Direction& normal) const {
    const Place at = placeOf(normal);
    std::vector<std::size_t> cells;
    for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
            const Direction beside = normalAt(at.face, static_cast<double>(at.column) + 0.5 + i,
                                              static_cast<double>(at.row) + 0.5 + j);
            const std::size_t cell = cellNumber_[cellIndex(placeOf(beside))];
            if (cell != none && (i != 0 || j != 0)) cells.push_back(cell);
        }
    }
    return cells;
}

double NormalTable::interpolate(const Direction& normal, std::span<double> values) const {
    assert(values.size() == count_);
    const Place at = placeOf(normal);
    const auto across = cubicWeights(at.x), up = cubicWeights(at.y);
    std::ranges::fill(values, 0.0);
    for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t vertex = vertexOf_[vertexIndex(at.face, at.column + i, at.row + j)];
            const double weight = across[i] * up[j];
            const double* from = values_.data() + vertex * count_;
            for (std::size_t k = 0; k < values.size(); ++k) values[k] += weight * from[k];
        }
    }
    return azimuth(faceFrame(at.face, normal).toLocal(frameAt(normal).tangent));
}

}  // namespace hshfit::inline rendering
