#include <hshfit/precomputed_transfer/internal/directions_above.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline precomputed_transfer {

DirectionStrata::DirectionStrata(std::size_t count) : count_(count) {
    const auto rings =
        static_cast<std::size_t>(std::max(1.0, std::round(std::sqrt(static_cast<double>(count)))));
    for (std::size_t r = 0; r <= rings; ++r) rings_.push_back(count * r / rings);
}

void DirectionStrata::fill(RandomNumbers& random, std::vector<DirectionAbove>& out) const {
    out.resize(count_);
    const double turn = random.next();
    const auto number = static_cast<double>(count_);
    for (std::size_t r = 0; r + 1 < rings_.size(); ++r) {
        const std::size_t first = rings_[r], columns = rings_[r + 1] - first;
        for (std::size_t c = 0; c < columns; ++c) {
            const double along = random.next();
            // The integral of mu + 1/2 is (mu^2 + mu) / 2.
            const double share =
                (static_cast<double>(first) + static_cast<double>(columns) * along) / number;
            const double mu = (std::sqrt(1 + 8 * share) - 1) / 2;
            const double phi =
                2 * pi *
                ((static_cast<double>(c) + random.next()) / static_cast<double>(columns) + turn);
            const double sine = std::sqrt(std::max(0.0, 1 - mu * mu));
            out[first + c] = {{sine * std::cos(phi), sine * std::sin(phi), mu},
                              2 * mu / (mu + 0.5),
                              1 / (mu + 0.5)};
        }
    }
}

}  // namespace hshfit::inline precomputed_transfer
