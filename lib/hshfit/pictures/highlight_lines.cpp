#include <hshfit/pictures/internal/highlight_lines.h>

#include <cmath>

namespace hshfit::inline pictures {
namespace {

constexpr double steepest = 85;  // degrees of elevation
constexpr int steps = 60;        // on each side of the middle

bool isWithin(const DirectionPair& pair) {
    static const double least = std::cos(radians(steepest)) - 1e-12;
    return pair.wi.z >= least && pair.wo.z >= least;
}

/// A line of the pairs at angles from -reach to reach, as far as both directions are within.
template <class PairAt>
HighlightLine lineOf(double reach, const PairAt& pairAt) {
    HighlightLine line;
    for (int k = -steps; k <= steps; ++k) {
        const double part = static_cast<double>(k) / steps;
        const double angle = reach * part * std::abs(part);
        const DirectionPair pair = pairAt(radians(angle));
        if (!isWithin(pair)) continue;
        line.angles.push_back(angle);
        line.pairs.push_back(pair);
    }
    return line;
}

HighlightLine ridge(double azimuth) {
    HighlightLine line;
    for (int t = 0; t <= 80; ++t) {
        line.angles.push_back(t);
        line.pairs.push_back({directionFromAngles(radians(t), azimuth),
                              directionFromAngles(radians(t), azimuth + pi)});
    }
    return line;
}

void addLines(double azimuth, std::vector<HighlightLine>& lines) {
    for (const double apart : {4, 30, 60, 90, 120, 140, 160}) {
        const double difference = radians(apart / 2);
        for (const double turn : {0.0, pi / 2})
            lines.push_back(
                lineOf(turn == 0 ? steepest - apart / 2 : steepest, [&](double thetaHalf) {
                    return fromHalfDifference(thetaHalf, azimuth, difference, turn);
                }));
    }
    for (const double theta : {0, 15, 30, 45, 60, 75}) {
        const Direction wi = directionFromAngles(radians(theta), azimuth);
        lines.push_back(lineOf(steepest + theta, [&](double offset) {
            return DirectionPair{wi, directionFromAngles(radians(theta) + offset, azimuth + pi)};
        }));
    }
    lines.push_back(ridge(azimuth));
}

std::vector<double> azimuthsOf(bool isotropic) {
    return isotropic ? std::vector<double>{0} : std::vector<double>{0, pi / 4, pi / 2};
}

std::vector<HighlightLine> madeLines(bool isotropic) {
    std::vector<HighlightLine> lines;
    for (const double azimuth : azimuthsOf(isotropic)) addLines(azimuth, lines);
    return lines;
}

std::vector<HighlightLine> madeRidges(bool isotropic) {
    std::vector<HighlightLine> lines;
    for (const double azimuth : azimuthsOf(isotropic)) lines.push_back(ridge(azimuth));
    return lines;
}

}  // namespace

std::span<const HighlightLine> highlightLines(bool isotropic) {
    static const std::vector<HighlightLine> all[] = {madeLines(false), madeLines(true)};
    return all[isotropic ? 1 : 0];
}

std::span<const HighlightLine> mirrorRidges(bool isotropic) {
    static const std::vector<HighlightLine> all[] = {madeRidges(false), madeRidges(true)};
    return all[isotropic ? 1 : 0];
}

}  // namespace hshfit::inline pictures
