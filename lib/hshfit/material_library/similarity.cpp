#include <hshfit/material_library/similarity.h>

#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/log_terms.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::material_library {
namespace {

using Eigen::Index;
using Place = std::array<double, 2>;

constexpr Index colours = 3;
constexpr double roomPerDisc = 2;  ///< area of the bounding box, in squares of a disc's diameter
constexpr double nudge = 1e-3;     ///< of discs at one place, in directions of their own
constexpr int sweeps = 1000;
constexpr double leastOverlap = 1e-3;

/// A column for each material. Columns are as far apart as their materials.
Eigen::MatrixXd pointsOf(const LogSpace& space, std::span<const LogMaterial> materials) {
    const auto terms = static_cast<Index>(logTerms().size());
    Eigen::MatrixXd points(colours * terms, static_cast<Index>(materials.size()));
    for (std::size_t m = 0; m < materials.size(); ++m) {
        const LogMaterial& material = materials[m];
        for (Index c = 0; c < colours; ++c) {
            // A grey material has its one channel for every colour.
            const Index channel = material.channels() == 1 ? 0 : c;
            points.col(static_cast<Index>(m)).segment(c * terms, terms) =
                space.samples().lower.transpose() *
                Eigen::Map<const Eigen::VectorXd>(material.exponents.data() + channel * terms,
                                                  terms) /
                std::sqrt(static_cast<double>(colours));
        }
    }
    return points;
}

std::array<double, 2> lengthsOf(std::span<const Place> places) {
    std::array<double, 2> lengths;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto [least, most] =
            std::ranges::minmax(places, {}, [axis](const Place& place) { return place[axis]; });
        lengths[axis] = most[axis] - least[axis];
    }
    return lengths;
}

/// The factor of coordinates; a row of discs where all lie on a line.
double scaleOf(std::span<const Place> coordinates) {
    const std::array<double, 2> lengths = lengthsOf(coordinates);
    const auto count = static_cast<double>(coordinates.size());
    const double longest = std::max(lengths[0], lengths[1]);
    if (!(longest > 0)) return 0;
    const double area = lengths[0] * lengths[1];
    const double most = count / longest;
    return area > 0 ? std::min(std::sqrt(roomPerDisc * count / area), most) : most;
}

/// Moves two discs apart until they touch; the overlap that they had.
double separate(Place& a, Place& b) {
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    if (std::abs(dx) >= 1 || std::abs(dy) >= 1) return 0;
    const double length = std::hypot(dx, dy);
    if (length >= 1 || length == 0) return 0;
    const double half = (1 - length) / (2 * length);
    a = {a[0] - half * dx, a[1] - half * dy};
    b = {b[0] + half * dx, b[1] + half * dy};
    return 1 - length;
}

/// The distance of the nearest two; infinite for fewer.
double nearestOf(std::span<const Place> places) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < places.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            nearest = std::min(
                nearest, std::hypot(places[i][0] - places[k][0], places[i][1] - places[k][1]));
    return nearest;
}

}  // namespace

Similarity similarityOf(const LogSpace& space, std::span<const LogMaterial> materials) {
    Eigen::MatrixXd points = pointsOf(space, materials);
    const std::size_t count = materials.size();
    Similarity similarity{.distances = std::vector<double>(count * count, 0.0), .coordinates = {}};
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        for (std::size_t k = 0; k < count; ++k)
            similarity.distances[i * count + k] =
                (points.col(static_cast<Index>(i)) - points.col(static_cast<Index>(k))).norm();
    });
    points.colwise() -= points.rowwise().mean().eval();
    const Eigen::MatrixXd covariance = points * points.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    const Eigen::MatrixXd axes = solver.eigenvectors().rightCols(2);  // by rising variance
    const Eigen::MatrixXd coordinates = axes.transpose() * points;
    for (Index m = 0; m < coordinates.cols(); ++m)
        similarity.coordinates.push_back({coordinates(1, m), coordinates(0, m)});
    const double all = points.squaredNorm();
    if (all > 0) similarity.kept = std::min(coordinates.squaredNorm() / all, 1.0);
    return similarity;
}

std::vector<Place> spreadPlaces(std::span<const Place> coordinates) {
    std::vector<Place> places(coordinates.begin(), coordinates.end());
    if (places.empty()) return places;
    const double scale = scaleOf(coordinates);
    // Directions of the golden angle: no two discs get the same.
    const double turn = pi * (3 - std::sqrt(5.0));
    for (std::size_t k = 0; k < places.size(); ++k) {
        const double angle = turn * static_cast<double>(k);
        places[k] = {scale * places[k][0] + nudge * std::cos(angle),
                     scale * places[k][1] + nudge * std::sin(angle)};
    }
    double overlap = 1;
    for (int sweep = 0; sweep < sweeps && overlap > leastOverlap; ++sweep) {
        overlap = 0;
        for (std::size_t i = 0; i < places.size(); ++i)
            for (std::size_t k = 0; k < i; ++k)
                overlap = std::max(overlap, separate(places[i], places[k]));
    }
    const double nearest = nearestOf(places), factor = nearest < 1 ? 1 / nearest : 1;
    Place least = places[0];
    for (const Place& place : places)
        least = {std::min(least[0], place[0]), std::min(least[1], place[1])};
    for (Place& place : places)
        place = {factor * (place[0] - least[0]) + 0.5, factor * (place[1] - least[1]) + 0.5};
    return places;
}

}  // namespace hshfit::material_library
