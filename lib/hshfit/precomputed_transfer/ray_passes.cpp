#include <hshfit/precomputed_transfer/internal/ray_passes.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/rendering/view.h>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

namespace hshfit::inline precomputed_transfer {

/// Arrays of one thread, kept from one vertex to the next.
struct RayPasses::Desk {
    std::vector<DirectionAbove> directions;
    std::vector<double> x, y, z;
    std::vector<float> local;      ///< [ray][j]
    std::vector<double> response;  ///< [R, G, B][j]
    std::vector<float> reflected;  ///< [channel][i], of one ray
    std::vector<double> vector;    ///< [channel][i]
    std::vector<float> matrix;     ///< [channel][j][i]
};

RayPasses::RayPasses(const TransferMesh& mesh, const GatheredTransfer& gathered,
                     std::span<const TransferMaterial> materials, std::size_t channels)
    : mesh_(mesh),
      gathered_(gathered),
      materials_(materials),
      channels_(channels),
      rays_(gathered.hits.size() / mesh.vertices.size()),
      strata_(rays_),
      local_(bases::make("hsh", gathered.localOrder)) {
    for (const TransferMaterial& material : materials) {
        if (!material.response || material.response->order == gathered.localOrder) continue;
        throw UsageError(
            fmt::format("material '{}' has a response of {} bands, and the matrices "
                        "{}",
                        material.name, material.response->order, gathered.localOrder));
    }
}

void RayPasses::pass(const TransferPass& before, TransferPass& now,
                     const std::function<void(std::size_t)>& progress) const {
    tbb::enumerable_thread_specific<Desk> desks;
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, mesh_.vertices.size(), [&](std::size_t v) {
        gatherVertex(v, before, now, desks.local());
        const std::size_t count = ++done;
        if (count % 64 == 0) progress(count);
    });
}

/// Adds what vertex q reflects against the direction of a ray.
void RayPasses::addReflected(std::uint32_t q, double weight, const Direction& world,
                             const TransferPass& before, Desk& desk) const {
    const TransferMaterial& material = materials_[mesh_.material(q)];
    const std::size_t slots = gathered_.slots(), rows = gathered_.localSlots();
    if (!material.response) {
        const float* from = before.vectors.data() + q * channels_ * slots;
        for (std::size_t c = 0; c < channels_; ++c) {
            const auto factor = static_cast<float>(weight * material.albedo[c]);
            for (std::size_t i = c * slots; i < (c + 1) * slots; ++i)
                desk.reflected[i] += factor * from[i];
        }
        return;
    }
    const Frame frame = rendering::frameAt(normalised(directionOf(mesh_.vertices[q].normal)));
    desk.response.resize(3 * rows);
    material.towards(normalised(frame.toLocal(-world)), desk.response);
    const float* from = before.matrices.data() + q * channels_ * rows * slots;
    for (std::size_t c = 0; c < channels_; ++c) {
        float* to = desk.reflected.data() + c * slots;
        for (std::size_t j = 0; j < rows; ++j) {
            const auto factor = static_cast<float>(weight * desk.response[c * rows + j]);
            const float* row = from + (c * rows + j) * slots;
            for (std::size_t i = 0; i < slots; ++i) to[i] += factor * row[i];
        }
    }
}

void RayPasses::gatherVertex(std::size_t v, const TransferPass& before, TransferPass& now,
                             Desk& desk) const {
    const std::size_t slots = gathered_.slots(), rows = gathered_.localSlots();
    RandomNumbers random(gathered_.seed, v);
    strata_.fill(random, desk.directions);
    const TransferHit* hits = gathered_.hits.data() + v * rays_;
    double cosines = 0, angles = 0;
    desk.x.clear(), desk.y.clear(), desk.z.clear();
    for (std::size_t k = 0; k < rays_; ++k) {
        if (hits[k].triangle == TransferHit::untold) continue;
        cosines += desk.directions[k].cosine;
        angles += desk.directions[k].solidAngle;
        if (!hits[k].meets()) continue;
        const Direction& d = desk.directions[k].local;
        desk.x.push_back(d.x), desk.y.push_back(d.y), desk.z.push_back(d.z);
    }
    desk.local.resize(desk.x.size() * rows);
    local_->evaluate(DirectionBatch{desk.x.data(), desk.y.data(), desk.z.data(), desk.x.size()},
                     desk.local.data());
    desk.vector.assign(channels_ * slots, 0);
    desk.matrix.assign(channels_ * rows * slots, 0);
    const Frame frame = rendering::frameAt(normalised(directionOf(mesh_.vertices[v].normal)));
    std::size_t met = 0;
    for (std::size_t k = 0; k < rays_; ++k) {
        if (!hits[k].meets()) continue;
        const DirectionAbove& direction = desk.directions[k];
        const Direction world = frame.toWorld(direction.local);
        desk.reflected.assign(channels_ * slots, 0);
        const std::array<double, 3> weights = hits[k].weights();
        for (std::size_t c = 0; c < 3; ++c)
            addReflected(mesh_.triangles[hits[k].triangle][c], weights[c], world, before, desk);
        const double share = direction.cosine / cosines;
        for (std::size_t i = 0; i < desk.vector.size(); ++i)
            desk.vector[i] += share * static_cast<double>(desk.reflected[i]);
        const double angle = 2 * pi * direction.solidAngle / angles;
        for (std::size_t j = 0; j < rows; ++j) {
            const auto factor = static_cast<float>(angle) * desk.local[met * rows + j];
            for (std::size_t c = 0; c < channels_; ++c) {
                float* to = desk.matrix.data() + (c * rows + j) * slots;
                const float* from = desk.reflected.data() + c * slots;
                for (std::size_t i = 0; i < slots; ++i) to[i] += factor * from[i];
            }
        }
        ++met;
    }
    std::ranges::transform(
        desk.vector, now.vectors.begin() + static_cast<std::ptrdiff_t>(v * desk.vector.size()),
        [](double x) { return static_cast<float>(x); });
    std::ranges::copy(desk.matrix,
                      now.matrices.begin() + static_cast<std::ptrdiff_t>(v * desk.matrix.size()));
}

}  // namespace hshfit::inline precomputed_transfer
