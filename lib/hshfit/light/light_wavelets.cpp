#include <hshfit/light/light_wavelets.h>

#include <hshfit/error.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/wavelets/soho.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hshfit::inline light {
namespace {

using wavelets::Partition;

/// Parts of lights beside the width of a leaf.
constexpr double partsPerLeaf = 4;

/// Averages of radiance over the leaves, [R, G, B][leaf].
class Leaves {
public:
    Leaves(const Partition& partition, const LightDomain& domain)
        : partition_(partition),
          domain_(domain),
          frame_(domain.frame()),
          leaves_(partition.level(partition.levels())),
          width_(std::sqrt(leaves_.front().area)) {
        for (auto& channel : averages_) channel.assign(leaves_.size(), 0.0);
    }

    /// Adds the radiance in the middle of each leaf.
    void addRadiance(std::span<const Light> lights) {
        constexpr std::size_t block = 1024;
        tbb::parallel_for(std::size_t{0}, (leaves_.size() + block - 1) / block, [&](std::size_t b) {
            const std::size_t last = std::min(leaves_.size(), (b + 1) * block);
            for (std::size_t k = b * block; k < last; ++k) {
                const Rgb radiance =
                    radianceFrom(lights, frame_.toWorld(wavelets::centreOf(leaves_[k])));
                for (std::size_t c = 0; c < 3; ++c) averages_[c][k] += radiance[c];
            }
        });
    }
    void addPicture(const PictureLight& light) {
        const PictureGeometry geometry = geometryOf(light);
        const auto parts = static_cast<std::size_t>(
            std::ceil(std::max(1.0, partsPerLeaf * geometry.pixelAngle() / width_)));
        const PictureGeometry finer{light.layout, light.width * parts, light.height * parts};
        for (std::size_t row = 0; row < finer.height; ++row) {
            for (std::size_t column = 0; column < finer.width; ++column) {
                const float* rgb =
                    light.rgb.data() + 3 * (row / parts * light.width + column / parts);
                if (rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0) continue;
                const double scale = static_cast<double>(parts);
                addFlux(
                    frame_.toLocal(directionOf(light, (static_cast<double>(column) + 0.5) / scale,
                                               (static_cast<double>(row) + 0.5) / scale)),
                    {rgb[0], rgb[1], rgb[2]}, finer.solidAngle(column, row));
            }
        }
    }
    void addNodes(const Light& light) {
        const LightNodes nodes =
            nodesOf(light, domain_, static_cast<int>(std::ceil(partsPerLeaf / width_)), 0);
        for (std::size_t k = 0; k < nodes.count(); ++k)
            addFlux({nodes.x[k], nodes.y[k], nodes.z[k]},
                    {nodes.flux[0][k], nodes.flux[1][k], nodes.flux[2][k]}, 1);
    }

    /// The energies that the best k terms capture, [k], and last the energy of all terms.
    std::vector<double> captured(std::size_t most) const {
        std::array<std::vector<double>, 3> each;
        tbb::parallel_for(std::size_t{0}, std::size_t{3}, [&](std::size_t c) {
            std::vector<double> coefficients(leaves_.size());
            wavelets::analyse(partition_, averages_[c].data(), coefficients.data());
            each[c] = wavelets::capturedByTerms(coefficients, most);
            each[c].push_back(0);
            for (const double value : coefficients) each[c].back() += value * value;
        });
        for (std::size_t k = 0; k < each[0].size(); ++k) each[0][k] += each[1][k] + each[2][k];
        return each[0];
    }

private:
    void addFlux(const Direction& local, const Rgb& radiance, double solidAngle) {
        if (domain_.normal && !(local.z > 0)) return;
        std::array<unsigned char, Partition::mostLevels + 1> path{};
        partition_.locate(local, partition_.levels(), path.data());
        std::size_t leaf = path[0];
        for (int j = 1; j <= partition_.levels(); ++j)
            leaf = 4 * leaf + path[static_cast<std::size_t>(j)];
        const double share = solidAngle / leaves_[leaf].area;
        for (std::size_t c = 0; c < 3; ++c) averages_[c][leaf] += share * radiance[c];
    }

    const Partition& partition_;
    const LightDomain& domain_;
    const Frame frame_;
    const std::vector<wavelets::Triangle>& leaves_;
    const double width_;
    std::array<std::vector<double>, 3> averages_;
};

std::vector<double> capturedAt(std::span<const Light> lights, const LightDomain& domain,
                               std::size_t most, int level) {
    const Partition partition(
        domain.normal ? Partition::Domain::hemisphere : Partition::Domain::sphere, level);
    Leaves leaves(partition, domain);
    for (const Light& light : lights) {
        if (const auto* picture = std::get_if<PictureLight>(&light))
            leaves.addPicture(*picture);
        else if (std::holds_alternative<DiscLight>(light) ||
                 std::holds_alternative<PanelLight>(light))
            leaves.addNodes(light);
        else
            leaves.addRadiance({&light, 1});
    }
    return leaves.captured(most);
}

}  // namespace

LightTerms lightTerms(std::span<const Light> lights, const LightDomain& domain, std::size_t most,
                      const LightTermsOptions& options) {
    for (const Light& light : lights)
        if (std::holds_alternative<DirectionalLight>(light))
            throw UsageError("light from a single direction has no energy, and no best wavelets");
    LightTerms terms;
    for (int level = options.firstLevel; level <= options.lastLevel; ++level) {
        std::vector<double> now = capturedAt(lights, domain, most, level);
        terms.levels = level;
        terms.error = std::numeric_limits<double>::quiet_NaN();
        if (!terms.captured.empty()) {
            double change = 0;
            for (std::size_t k = 0; k <= most; ++k)
                change = std::max(change, std::abs(now[k] - terms.captured[k]));
            terms.error = now.back() > 0 ? change / now.back() / 3 : 0;
        }
        now.pop_back();
        terms.captured = std::move(now);
        if (terms.error < options.tolerance) break;
    }
    return terms;
}

}  // namespace hshfit::inline light
