#include <hshfit/light/internal/node_moments.h>

#include <hshfit/projection/lane_products.h>
#include <hshfit/stop_request.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

constexpr std::size_t momentSides = 8;  ///< cosine R, G, B, 0, sine R, G, B, 0
constexpr std::size_t ringsOfBatch = 256;
/// Sums that run at a time, whatever the number of threads.
constexpr std::size_t groups = 8;

/// Nodes first to last - 1 have the same height.
struct Ring {
    std::size_t first, last;
};

std::vector<Ring> ringsOf(const LightNodes& nodes) {
    std::vector<Ring> rings;
    for (std::size_t k = 0; k < nodes.count(); ++k) {
        if (k > 0 && nodes.z[k] == nodes.z[k - 1])
            rings.back().last = k + 1;
        else
            rings.push_back({k, k + 1});
    }
    return rings;
}

/// cos(m phi) and sin(m phi) of the nodes of a batch, for growing m.
class Azimuths {
public:
    Azimuths(const LightNodes& nodes, std::size_t first, std::size_t last)
        : cosine_(last - first, 1.0), sine_(last - first, 0.0) {
        for (std::size_t k = first; k < last; ++k) {
            const double length = std::hypot(nodes.x[k], nodes.y[k]);
            stepCosine_.push_back(length > 0 ? nodes.x[k] / length : 1);
            stepSine_.push_back(length > 0 ? nodes.y[k] / length : 0);
        }
    }
    void advance() {
        for (std::size_t k = 0; k < cosine_.size(); ++k) {
            const double c = cosine_[k] * stepCosine_[k] - sine_[k] * stepSine_[k];
            sine_[k] = sine_[k] * stepCosine_[k] + cosine_[k] * stepSine_[k];
            cosine_[k] = c;
        }
    }
    double cosine(std::size_t k) const { return cosine_[k]; }
    double sine(std::size_t k) const { return sine_[k]; }

private:
    std::vector<double> cosine_, sine_, stepCosine_, stepSine_;
};

/// Adds the sums over some rings: m after m, [l - m][side].
void addBatch(const Basis& basis, const LightNodes& nodes, std::span<const Ring> rings,
              std::vector<double>& sums) {
    const std::size_t first = rings.front().first, last = rings.back().last;
    const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
    std::vector<Elevation<double>> elevations;
    for (const Ring& ring : rings) {
        const std::size_t k = ring.first;
        elevations.push_back(elevationOf({nodes.x[k], nodes.y[k], nodes.z[k]}));
    }
    Azimuths azimuths(nodes, first, last);
    std::vector<double> theta(static_cast<std::size_t>(basis.order()) * rings.size());
    std::vector<double> parts(rings.size() * momentSides);
    double* out = sums.data();
    for (int m = 0; m < basis.order(); ++m) {
        stopIfRequested();
        if (m > 0) azimuths.advance();
        std::fill(parts.begin(), parts.end(), 0.0);
        for (std::size_t r = 0; r < rings.size(); ++r) {
            double* to = parts.data() + r * momentSides;
            const double weight = projected ? elevations[r].mu : 1;
            for (std::size_t k = rings[r].first; k < rings[r].last; ++k) {
                const double c = weight * azimuths.cosine(k - first);
                const double s = weight * azimuths.sine(k - first);
                for (std::size_t channel = 0; channel < 3; ++channel) {
                    to[channel] += c * nodes.flux[channel][k];
                    to[4 + channel] += s * nodes.flux[channel][k];
                }
            }
        }
        const auto degrees = static_cast<std::size_t>(basis.order() - m);
        basis.analysisTheta(m, elevations, theta.data());
        addProducts({theta.data(), degrees, rings.size()}, {parts.data(), momentSides, momentSides},
                    rings.size(), out, momentSides);
        out += degrees * momentSides;
    }
}

}  // namespace

void addNodeMoments(const Basis& basis, const LightNodes& nodes, std::vector<double>& moments) {
    const std::vector<Ring> rings = ringsOf(nodes);
    const auto order = static_cast<std::size_t>(basis.order());
    const auto slots = static_cast<std::size_t>(basis.slots());
    const std::size_t batches = (rings.size() + ringsOfBatch - 1) / ringsOfBatch;
    std::vector<std::vector<double>> sums(std::min(groups, batches));
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t group) {
        sums[group].assign(order * (order + 1) / 2 * momentSides, 0.0);
        for (std::size_t batch = group; batch < batches; batch += sums.size()) {
            const std::size_t first = batch * ringsOfBatch;
            const std::size_t count = std::min(ringsOfBatch, rings.size() - first);
            addBatch(basis, nodes, std::span(rings).subspan(first, count), sums[group]);
        }
    });
    for (const auto& sum : sums) {
        const double* from = sum.data();
        for (int m = 0; m < basis.order(); ++m) {
            const double norm =
                azimuthSign(m, basis.condonShortley()) / std::sqrt(m == 0 ? 2 * pi : pi);
            for (int l = m; l < basis.order(); ++l, from += momentSides) {
                for (std::size_t c = 0; c < 3; ++c) {
                    double* to = moments.data() + c * slots;
                    to[slotOf(l, m)] += norm * from[c];
                    if (m > 0) to[slotOf(l, -m)] += norm * from[4 + c];
                }
            }
        }
    }
}

}  // namespace hshfit::inline light
