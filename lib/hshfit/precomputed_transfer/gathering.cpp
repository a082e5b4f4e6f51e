#include <hshfit/precomputed_transfer/gathering.h>

#include <hshfit/precomputed_transfer/internal/buried_vertices.h>
#include <hshfit/precomputed_transfer/internal/closed_form.h>
#include <hshfit/precomputed_transfer/internal/directions_above.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/rendering/view.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>

namespace hshfit::inline precomputed_transfer {
namespace {

using Clock = std::chrono::steady_clock;

/// The way from a vertex to the middle of a triangle that rays start at, and their distance from
/// it: more than the rounding of single precision about the scene's middle.
constexpr double nudge = 0.05, lift = 4e-6;
/// A vertex is buried if fewer of its rays than this share tell anything.
constexpr double leastTold = 0.05;
/// The share of rays that tell nothing up to which the closed form stands for the free ones.
constexpr double mostUntold = 0.002;

double secondsSince(const Clock::time_point& start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

enum class End : unsigned char { escapes, meets, untold };

/// Arrays of one thread, kept from one vertex to the next.
struct Desk {
    std::vector<DirectionAbove> directions;
    std::vector<Direction> world;
    std::vector<Ray> rays;
    std::vector<RayHit> hits;
    std::vector<End> ends;
    std::vector<std::size_t> chosen;  ///< rays that are summed
    std::vector<double> x, y, z;
    std::vector<float> harmonics, local;
    std::vector<double> shares;  ///< of every vertex that is seen
    std::vector<std::uint32_t> seen;
    double tracing = 0, all = 0;
};

/// The arrays of a part as bytes.
struct PartWriter {
    std::vector<std::byte> bytes;

    template <class Item>
    void array(std::span<Item> items) {
        const auto more = std::as_bytes(items);
        bytes.insert(bytes.end(), more.begin(), more.end());
    }
    template <class Item>
    void list(std::vector<Item>& items) {
        const std::uint64_t count = items.size();
        array(std::span(&count, 1));
        array(std::span(items));
    }
};

/// The same in the other direction. Bytes of another scene or other options are no part: their
/// length would differ.
struct PartReader {
    std::span<const std::byte> left;

    template <class Item>
    void array(std::span<Item> items) {
        if (left.size() < items.size_bytes())
            throw InputError("kept parts of precomputed transfer that are too short");
        if (!items.empty()) std::memcpy(items.data(), left.data(), items.size_bytes());
        left = left.subspan(items.size_bytes());
    }
    template <class Item>
    void list(std::vector<Item>& items) {
        std::uint64_t count = 0;
        array(std::span(&count, 1));
        if (count > left.size() / sizeof(Item))
            throw InputError("kept parts of precomputed transfer that are too short");
        items.resize(count);
        array(std::span(items));
    }
};

class Gathering {
public:
    Gathering(const TransferMesh& mesh, const RayScene& scene, const GatheringOptions& options)
        : mesh_(mesh),
          scene_(scene),
          options_(options),
          strata_(options.rays),
          harmonics_(bases::make("sh", options.order)),
          closed_(options.order, options.localOrder) {
        if (options.localOrder > 0) local_ = bases::make("hsh", options.localOrder);
        const std::size_t count = mesh.vertices.size();
        result_.order = options.order;
        result_.localOrder = options.localOrder;
        result_.seed = options.seed;
        slots_ = result_.slots();
        matrix_ = slots_ * result_.localSlots();
        result_.unshadowed.resize(count * slots_);
        result_.shadowed.resize(count * slots_);
        result_.unshadowedMatrices.resize(count * matrix_);
        result_.shadowedMatrices.resize(count * matrix_);
        if (options.links) result_.links.resize(count);
        if (options.localOrder > 0 && options.links) result_.hits.resize(count * options.rays);
        told_.resize(count);
        errors_.resize(count);
    }

    GatheredTransfer run() {
        const std::size_t count = mesh_.vertices.size();
        if (!options_.shadows) {
            tbb::parallel_for(std::size_t{0}, count, [&](std::size_t v) { fillClosedForm(v); });
            return std::move(result_);
        }
        std::atomic<std::size_t> done = 0;
        std::atomic<std::size_t> found = 0;
        tbb::parallel_for(std::size_t{0}, (count + partVertices - 1) / partVertices,
                          [&](std::size_t part) {
                              const std::size_t first = part * partVertices;
                              const std::size_t end = std::min(first + partVertices, count);
                              if (find(part, first, end))
                                  found += end - first;
                              else
                                  gatherPart(part, first, end);
                              const std::size_t now = done += end - first;
                              if (options_.progress) options_.progress(now, count);
                          });
        result_.found = found;
        for (const Desk& desk : desks_) {
            result_.tracingSeconds += desk.tracing;
            result_.seconds += desk.all;
        }
        result_.rays = count * options_.rays;
        finish();
        return std::move(result_);
    }

private:
    void gatherPart(std::size_t part, std::size_t first, std::size_t end) {
        Desk& desk = desks_.local();
        const auto start = Clock::now();
        for (std::size_t v = first; v < end; ++v) gatherVertex(v, desk);
        desk.all += secondsSince(start);
        if (!options_.kept.keep) return;
        PartWriter writer;
        eachArray(first, end, writer);
        options_.kept.keep(part, writer.bytes);
    }

    bool find(std::size_t part, std::size_t first, std::size_t end) {
        if (!options_.kept.find) return false;
        const auto bytes = options_.kept.find(part);
        if (!bytes) return false;
        PartReader reader{*bytes};
        eachArray(first, end, reader);
        for (std::size_t v = first; v < end; ++v) fillClosedForm(v);
        return true;
    }

    /// All that tracing finds for some vertices.
    template <class Visitor>
    void eachArray(std::size_t first, std::size_t end, Visitor& visitor) {
        const std::size_t count = end - first;
        const auto some = [&](auto& values, std::size_t stride) {
            visitor.array(std::span(values.data() + first * stride, count * stride));
        };
        some(told_, 1);
        some(errors_, 1);
        some(result_.shadowed, slots_);
        some(result_.shadowedMatrices, matrix_);
        if (!result_.hits.empty()) some(result_.hits, options_.rays);
        for (std::size_t v = first; v < end && !result_.links.empty(); ++v)
            visitor.list(result_.links[v]);
    }

    void fillClosedForm(std::size_t v) {
        closed_.vector(mesh_.vertices[v].normal, result_.unshadowed.data() + v * slots_);
        closed_.matrix(mesh_.vertices[v].normal, result_.unshadowedMatrices.data() + v * matrix_);
    }

    /// Rays of the vertex and their hits.
    void trace(std::size_t v, Desk& desk) const {
        RandomNumbers random(options_.seed, v);
        strata_.fill(random, desk.directions);
        const TransferVertex& vertex = mesh_.vertices[v];
        const Direction place = directionOf(vertex.position);
        const Frame frame = rendering::frameAt(normalised(directionOf(vertex.normal)));
        double largest = 0;
        for (std::size_t i = 0; i < 3; ++i)
            largest = std::max(largest, std::abs(double{vertex.position[i]} - scene_.centre()[i]));
        const std::size_t count = options_.rays, around = mesh_.first[v + 1] - mesh_.first[v];
        desk.world.resize(count);
        desk.rays.resize(count);
        desk.hits.resize(count);
        desk.ends.assign(count, End::escapes);
        for (std::size_t k = 0; k < count; ++k) {
            const Direction world = frame.toWorld(desk.directions[k].local);
            desk.world[k] = world;
            // The first triangle that the ray leaves on its front, from any of them.
            auto at = static_cast<std::size_t>(random.next() * static_cast<double>(around));
            std::size_t tries = 0;
            while (tries < around && !(dot(normalOf(v, at), world) > 0)) {
                at = (at + 1) % around;
                ++tries;
            }
            if (tries == around) desk.ends[k] = End::untold;
            const std::uint32_t t = mesh_.around[mesh_.first[v] + std::min(at, around - 1)];
            const Direction middle =
                (1.0 / 3) * (mesh_.corner(t, 0) + mesh_.corner(t, 1) + mesh_.corner(t, 2));
            const Direction gap = nudge * (middle - place);
            const double step = lift * (largest + std::sqrt(dot(gap, gap)));
            const Direction start = place + gap + step * mesh_.normals[t];
            desk.rays[k] = {{start.x, start.y, start.z},
                            {static_cast<float>(world.x), static_cast<float>(world.y),
                             static_cast<float>(world.z)}};
        }
        const auto start = Clock::now();
        scene_.firstHits(desk.rays, desk.hits);
        desk.tracing += secondsSince(start);
    }
    const Direction& normalOf(std::size_t v, std::size_t at) const {
        return mesh_.normals[mesh_.around[mesh_.first[v] + at]];
    }

    /// The triangle whose side a ray meets, or none.
    std::uint32_t sideOf(const RayHit& hit, const Direction& world) const {
        const bool front = dot(mesh_.normals[hit.triangle], world) < 0;
        return front ? hit.triangle : mesh_.backs[hit.triangle];
    }

    void gatherVertex(std::size_t v, Desk& desk) {
        trace(v, desk);
        fillClosedForm(v);
        // Normalised over the rays that tell something.
        double cosines = 0, angles = 0, meetings = 0, inside = 0;
        for (std::size_t k = 0; k < desk.rays.size(); ++k) {
            if (desk.ends[k] != End::untold && std::isfinite(desk.hits[k].distance)) {
                const bool told = sideOf(desk.hits[k], desk.world[k]) != TransferMesh::none;
                desk.ends[k] = told ? End::meets : End::untold;
                meetings += told ? 1 : 0;
            }
            if (desk.ends[k] == End::untold) {
                inside += 1;
                continue;
            }
            cosines += desk.directions[k].cosine;
            angles += desk.directions[k].solidAngle;
        }
        const auto count = static_cast<double>(desk.rays.size());
        told_[v] = 1 - inside / count;
        if (told_[v] < leastTold) return;
        // The closed form would count rays that tell nothing as free.
        const bool fromClosedForm = inside <= mostUntold * count && 2 * meetings <= count;
        choose(desk, fromClosedForm ? End::meets : End::escapes);
        sumVectors(v, desk, 1 / cosines, fromClosedForm);
        if (local_) sumMatrices(v, desk, 2 * pi / angles, fromClosedForm);
        if (options_.links) link(v, desk, 1 / cosines);
    }

    /// Directions of the rays with that end, and the harmonics there.
    void choose(Desk& desk, End end) const {
        desk.chosen.clear();
        desk.x.clear(), desk.y.clear(), desk.z.clear();
        for (std::size_t k = 0; k < desk.rays.size(); ++k) {
            if (desk.ends[k] != end) continue;
            desk.chosen.push_back(k);
            desk.x.push_back(desk.world[k].x);
            desk.y.push_back(desk.world[k].y);
            desk.z.push_back(desk.world[k].z);
        }
        desk.harmonics.resize(desk.chosen.size() * slots_);
        harmonics_->evaluate(
            DirectionBatch{desk.x.data(), desk.y.data(), desk.z.data(), desk.chosen.size()},
            desk.harmonics.data());
    }

    void sumVectors(std::size_t v, const Desk& desk, double factor, bool fromClosedForm) {
        std::array<std::array<double, 256>, 2> halves{};
        for (std::size_t k = 0; k < desk.chosen.size(); ++k) {
            const std::size_t ray = desk.chosen[k];
            const double weight = factor * desk.directions[ray].cosine;
            const float* values = desk.harmonics.data() + k * slots_;
            std::array<double, 256>& half = halves[ray % 2];
            for (std::size_t i = 0; i < slots_; ++i)
                half[i] += weight * static_cast<double>(values[i]);
        }
        const float* whole = result_.unshadowed.data() + v * slots_;
        float* out = result_.shadowed.data() + v * slots_;
        double squares = 0;
        for (std::size_t i = 0; i < slots_; ++i) {
            const double sum = halves[0][i] + halves[1][i], gap = halves[0][i] - halves[1][i];
            out[i] = static_cast<float>(fromClosedForm ? static_cast<double>(whole[i]) - sum : sum);
            squares += gap * gap;
        }
        errors_[v] = std::sqrt(squares);
    }

    void sumMatrices(std::size_t v, Desk& desk, double factor, bool fromClosedForm) {
        const std::size_t rows = result_.localSlots(), number = desk.chosen.size();
        for (std::size_t k = 0; k < number; ++k) {
            const Direction& d = desk.directions[desk.chosen[k]].local;
            desk.x[k] = d.x, desk.y[k] = d.y, desk.z[k] = d.z;
        }
        desk.local.resize(number * rows);
        local_->evaluate(DirectionBatch{desk.x.data(), desk.y.data(), desk.z.data(), number},
                         desk.local.data());
        std::vector<float> sums(matrix_);
        for (std::size_t k = 0; k < number; ++k) {
            const double weight = factor * desk.directions[desk.chosen[k]].solidAngle;
            const float* world = desk.harmonics.data() + k * slots_;
            for (std::size_t j = 0; j < rows; ++j) {
                const float h = static_cast<float>(weight) * desk.local[k * rows + j];
                float* row = sums.data() + j * slots_;
                for (std::size_t i = 0; i < slots_; ++i) row[i] += h * world[i];
            }
        }
        const float* whole = result_.unshadowedMatrices.data() + v * matrix_;
        float* out = result_.shadowedMatrices.data() + v * matrix_;
        for (std::size_t e = 0; e < matrix_; ++e)
            out[e] = fromClosedForm ? whole[e] - sums[e] : sums[e];
    }

    void link(std::size_t v, Desk& desk, double factor) {
        desk.shares.resize(mesh_.vertices.size());
        desk.seen.clear();
        for (std::size_t k = 0; k < desk.rays.size(); ++k) {
            if (desk.ends[k] == End::untold && !result_.hits.empty())
                result_.hits[v * options_.rays + k].triangle = TransferHit::untold;
            if (desk.ends[k] != End::meets) continue;
            const RayHit& hit = desk.hits[k];
            const std::uint32_t side = sideOf(hit, desk.world[k]);
            // The back of a triangle has its second and third corner exchanged.
            const bool front = side == hit.triangle;
            const double second = front ? hit.u : hit.v, third = front ? hit.v : hit.u;
            const double weight = factor * desk.directions[k].cosine;
            const std::array<double, 3> parts{1 - second - third, second, third};
            for (std::size_t c = 0; c < 3; ++c) {
                double& share = desk.shares[mesh_.triangles[side][c]];
                if (share == 0) desk.seen.push_back(mesh_.triangles[side][c]);
                share += weight * std::max(parts[c], 1e-12);
            }
            if (!result_.hits.empty()) keep(v * options_.rays + k, side, second, third);
        }
        std::ranges::sort(desk.seen);
        std::vector<TransferLink>& links = result_.links[v];
        links.reserve(desk.seen.size());
        for (const std::uint32_t seen : desk.seen) {
            links.push_back({seen, static_cast<float>(desk.shares[seen])});
            desk.shares[seen] = 0;
        }
    }

    void keep(std::size_t at, std::uint32_t side, double second, double third) {
        const auto code = [](double x) {
            return static_cast<std::uint16_t>(std::lround(65535 * std::clamp(x, 0.0, 1.0)));
        };
        result_.hits[at] = {side, code(second), code(third)};
    }

    /// Noise, and the vertices that tell nothing.
    void finish() {
        double squares = 0, whole = 0;
        for (std::size_t v = 0; v < told_.size(); ++v) {
            result_.inside += static_cast<std::size_t>(
                std::lround((1 - told_[v]) * static_cast<double>(options_.rays)));
            if (told_[v] < leastTold) result_.buried.push_back(static_cast<std::uint32_t>(v));
            squares += errors_[v] * errors_[v];
            if (errors_[v] > result_.largestNoise) {
                result_.largestNoise = errors_[v];
                result_.noisiest = static_cast<std::uint32_t>(v);
            }
        }
        const BuriedVertices buried(mesh_, result_.buried);
        buried.fill(result_.shadowed, slots_);
        buried.fill(result_.shadowedMatrices, matrix_);
        for (const float x : result_.shadowed)
            whole += static_cast<double>(x) * static_cast<double>(x);
        if (!(whole > 0)) return;
        result_.noise = std::sqrt(squares / whole);
        result_.largestNoise /= std::sqrt(whole / static_cast<double>(told_.size()));
    }

    const TransferMesh& mesh_;
    const RayScene& scene_;
    const GatheringOptions& options_;
    DirectionStrata strata_;
    std::unique_ptr<Basis> harmonics_, local_;
    ClosedForm closed_;
    std::size_t slots_ = 0, matrix_ = 0;
    GatheredTransfer result_;
    std::vector<double> told_, errors_;
    tbb::enumerable_thread_specific<Desk> desks_;
};

}  // namespace

std::size_t gatheringBytes(const TransferMesh& mesh, const GatheringOptions& options,
                           std::size_t channels) {
    const std::size_t vertices = mesh.vertices.size();
    const auto slots = static_cast<std::size_t>(options.order) * options.order;
    const auto matrix = slots * static_cast<std::size_t>(options.localOrder) * options.localOrder;
    // Vectors and matrices of each kind, two passes of interreflection and their sum.
    std::size_t bytes = vertices * sizeof(float) * 2 * (slots + matrix);
    if (options.links) {
        bytes += vertices * sizeof(float) * channels * (3 * slots + matrix);
        bytes += vertices * sizeof(TransferLink) * std::min(3 * options.rays, vertices);
        if (matrix > 0) bytes += vertices * options.rays * sizeof(TransferHit);
    }
    return bytes + mesh.triangles.size() * 200;
}

RayScene rayScene(const TransferMesh& mesh) {
    Mesh triangles;
    for (const TransferVertex& vertex : mesh.vertices)
        triangles.positions.push_back(vertex.position);
    triangles.triangles.assign(mesh.triangles.begin(),
                               mesh.triangles.begin() + static_cast<std::ptrdiff_t>(mesh.fronts));
    return RayScene(triangles);
}

GatheredTransfer gather(const TransferMesh& mesh, const RayScene& scene,
                        const GatheringOptions& options) {
    if (options.order < 1 || options.order > 16 || options.localOrder < 0 ||
        options.localOrder > 16) {
        throw UsageError(fmt::format("{} bands of light and {} above a vertex; both go up to 16",
                                     options.order, options.localOrder));
    }
    if (options.rays < 1)
        throw UsageError(
            fmt::format("no rays; {} is 1 or more", Setting{"GatheringOptions::rays"}));
    return Gathering(mesh, scene, options).run();
}

std::size_t raysWithin(const TransferMesh& mesh, const RayScene& scene,
                       const GatheringOptions& options, const TimeLimit& limit) {
    constexpr std::size_t fewest = 64;
    if (!limit || options.rays <= fewest) return options.rays;
    GatheringOptions trial = options;
    trial.rays = fewest;
    trial.progress = {};
    trial.kept = {};
    const double before = limit.secondsLeft();
    gather(mesh, scene, trial);
    const double left = limit.secondsLeft(), perRay = (before - left) / fewest;
    const auto most = static_cast<double>(options.rays), fit = perRay > 0 ? left / perRay : most;
    return static_cast<std::size_t>(std::clamp<double>(fit, fewest, most));
}

}  // namespace hshfit::inline precomputed_transfer
