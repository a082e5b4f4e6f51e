#include <hshfit/representation/constraints/constraints_scan.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hshfit::inline representation::inline constraints {

double HemisphereScan::horizon() {
    return pi / 2 - 1e-6;
}

HemisphereScan::HemisphereScan(const Basis& basis, bool even, int density)
    : order_(basis.order()), even_(even) {
    // A quarter turn of theta is stretched to a half by hsh and its kin: band l has l / 2
    // wavelengths in it.
    const int polar = density * (order_ + 2) / 2 + 1, around = density * (order_ + 1);
    const int azimuths = even ? around / 2 + 1 : around;
    polarStep_ = horizon() / (polar - 1);
    azimuthStep_ = 2 * pi / around;
    std::vector<Elevation<double>> points;
    for (int i = 0; i < polar; ++i) {
        polar_.push_back(i * polarStep_);
        points.push_back(elevationOf(directionFromAngles(polar_.back(), 0)));
    }
    for (int j = 0; j < azimuths; ++j) azimuths_.push_back(j * azimuthStep_);
    for (int m = 0; m < order_; ++m) {
        theta_.emplace_back(points.size() * static_cast<std::size_t>(order_ - m));
        basis.theta(m, points, theta_.back().data());
    }
    const auto width = static_cast<std::size_t>(2 * order_ - 1);
    azimuthParts_.resize(azimuths_.size() * width);
    for (std::size_t j = 0; j < azimuths_.size(); ++j) {
        hshfit::azimuthParts(directionFromAngles(pi / 4, azimuths_[j]), order_,
                             basis.condonShortley(), azimuthParts_.data() + j * width);
    }
}

std::array<SearchAxis, 2> HemisphereScan::axesAt(std::size_t node) const {
    constexpr double any = std::numeric_limits<double>::infinity();
    const double across = std::max(polarStep_, azimuthStep_ * polar(node));
    return {SearchAxis{polarStep_, -any, any}, SearchAxis{across, -any, any}};
}

Direction HemisphereScan::offset(std::size_t node, double along, double across) const {
    const double radius = polar(node) + along;
    return directionFromAngles(std::min(std::hypot(radius, across), horizon()),
                               azimuth(node) + std::atan2(across, radius));
}

void HemisphereScan::synthesise(const double* c, double* values) const {
    const std::size_t rings = polar_.size();
    const auto width = static_cast<std::size_t>(2 * order_ - 1);
    std::vector<double> ring(width);
    for (std::size_t i = 0; i < rings; ++i) {
        for (int m = 1 - order_; m < order_; ++m) {
            const int first = std::abs(m);
            const double* column = theta_[static_cast<std::size_t>(first)].data() + i;
            double sum = 0;
            for (int l = first; l < order_; ++l, column += rings) sum += c[slotOf(l, m)] * *column;
            ring[static_cast<std::size_t>(order_ - 1 + m)] = sum;
        }
        const std::size_t from = even_ ? static_cast<std::size_t>(order_ - 1) : 0;
        for (std::size_t j = 0; j < azimuths_.size(); ++j) {
            const double* parts = azimuthParts_.data() + j * width;
            double sum = 0;
            for (std::size_t k = from; k < width; ++k) sum += ring[k] * parts[k];
            values[i * azimuths_.size() + j] = sum;
        }
    }
}

std::vector<std::size_t> HemisphereScan::minima(const double* values, double threshold,
                                                bool alongLines) const {
    const auto rings = static_cast<int>(polar_.size()), around = static_cast<int>(azimuths_.size());
    const auto at = [&](int i, int j) {
        if (i < 0 || i >= rings) return std::numeric_limits<double>::infinity();
        // Mirrored at both ends where even, else periodic.
        if (even_) {
            j = j < 0 ? -j : j >= around ? 2 * (around - 1) - j : j;
        } else {
            j = (j + around) % around;
        }
        return values[i * around + j];
    };
    std::vector<std::size_t> found;
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < (i == 0 ? 1 : around); ++j) {
            const double value = at(i, j);
            if (!(value < threshold)) continue;
            int lines = 0;
            for (const auto& [di, dj] : {std::pair(0, 1), {1, 0}, {1, 1}, {1, -1}}) {
                lines += value <= at(i + di, j + dj) && value <= at(i - di, j - dj);
            }
            if (alongLines ? lines > 0 : lines == 4) {
                found.push_back(static_cast<std::size_t>(i * around + j));
            }
        }
    }
    return found;
}

}  // namespace hshfit::inline representation::inline constraints
