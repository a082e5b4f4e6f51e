#include <hshfit/precomputed_transfer/interreflection.h>

#include <hshfit/precomputed_transfer/internal/buried_vertices.h>
#include <hshfit/precomputed_transfer/internal/ray_passes.h>

#include <hshfit/error.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hshfit::inline precomputed_transfer {
namespace {

/// Mean reflected radiance in light of radiance 1, whose only coefficient is sqrt(4 pi).
double energyOf(const TransferMesh& mesh, std::span<const TransferMaterial> materials,
                const std::vector<float>& vectors, std::size_t channels, std::size_t slots) {
    double sum = 0, area = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Rgb& albedo = materials[mesh.material(v)].albedo;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto irradiance =
                static_cast<double>(vectors[(v * channels + c % channels) * slots]);
            sum += mesh.vertices[v].area * albedo[c] * irradiance / 3;
        }
        area += mesh.vertices[v].area;
    }
    return std::sqrt(4 * pi) * sum / area;
}

/// [vertex][channel][slot] from [vertex][slot].
std::vector<float> inChannels(const std::vector<float>& from, std::size_t channels,
                              std::size_t slots) {
    std::vector<float> result(from.size() * channels);
    if (slots == 0) return result;
    for (std::size_t v = 0; v < from.size() / slots; ++v) {
        for (std::size_t c = 0; c < channels; ++c)
            std::copy_n(from.data() + v * slots, slots, result.data() + (v * channels + c) * slots);
    }
    return result;
}

/// Fills in a pass of an earlier run, if there is one.
bool found(const KeptParts& kept, std::size_t number, TransferPass& pass) {
    const auto bytes = kept.find ? kept.find(number) : std::nullopt;
    const std::size_t vectors = pass.vectors.size() * sizeof(float),
                      matrices = pass.matrices.size() * sizeof(float);
    if (!bytes) return false;
    if (bytes->size() != vectors + matrices)
        throw InputError("a kept pass of precomputed transfer of another size");
    if (vectors > 0) std::memcpy(pass.vectors.data(), bytes->data(), vectors);
    if (matrices > 0) std::memcpy(pass.matrices.data(), bytes->data() + vectors, matrices);
    return true;
}

void keep(const KeptParts& kept, std::size_t number, const TransferPass& pass) {
    if (!kept.keep) return;
    std::vector<std::byte> bytes;
    for (const std::vector<float>* values : {&pass.vectors, &pass.matrices}) {
        const auto more = std::as_bytes(std::span(*values));
        bytes.insert(bytes.end(), more.begin(), more.end());
    }
    kept.keep(number, bytes);
}

/// One pass over links.
void linkPass(const TransferMesh& mesh, const GatheredTransfer& gathered,
              std::span<const TransferMaterial> materials, std::size_t channels,
              const std::vector<float>& before, std::vector<float>& now) {
    const std::size_t slots = gathered.slots(), stride = channels * slots;
    tbb::parallel_for(std::size_t{0}, mesh.vertices.size(), [&](std::size_t v) {
        std::vector<double> sums(stride);
        for (const TransferLink& link : gathered.links[v]) {
            const Rgb& albedo = materials[mesh.material(link.vertex)].albedo;
            const float* from = before.data() + link.vertex * stride;
            for (std::size_t c = 0; c < channels; ++c) {
                const double factor = static_cast<double>(link.share) * albedo[c];
                for (std::size_t i = c * slots; i < (c + 1) * slots; ++i)
                    sums[i] += factor * static_cast<double>(from[i]);
            }
        }
        std::ranges::transform(sums, now.begin() + static_cast<std::ptrdiff_t>(v * stride),
                               [](double x) { return static_cast<float>(x); });
    });
}

}  // namespace

bool grey(std::span<const TransferMaterial> materials) {
    return std::ranges::all_of(materials, [](const TransferMaterial& material) {
        const Rgb& c = material.albedo;
        return c[0] == c[1] && c[1] == c[2];
    });
}

InterreflectedTransfer interreflect(const TransferMesh& mesh, const GatheredTransfer& gathered,
                                    std::span<const TransferMaterial> materials,
                                    const InterreflectionOptions& options) {
    const std::size_t count = mesh.vertices.size(), slots = gathered.slots();
    if (gathered.links.size() != count) {
        throw UsageError(
            "interreflection of a scene whose links were not kept when it was gathered");
    }
    InterreflectedTransfer result;
    result.channels = grey(materials) ? 1 : 3;
    const std::size_t channels = result.channels, stride = channels * slots;
    const std::size_t matrix = slots * gathered.localSlots();
    const BuriedVertices buried(mesh, gathered.buried);
    TransferPass before{inChannels(gathered.shadowed, channels, slots),
                        inChannels(gathered.shadowedMatrices, channels, matrix)};
    TransferPass now{std::vector<float>(before.vectors.size()),
                     std::vector<float>(before.matrices.size())};
    result.vectors = before.vectors;
    result.matrices = before.matrices;
    result.energy.push_back(energyOf(mesh, materials, before.vectors, channels, slots));
    std::optional<RayPasses> rays;
    if (matrix > 0) rays.emplace(mesh, gathered, materials, channels);
    for (int pass = 1; pass <= options.passes && !options.limit.isOver(); ++pass) {
        const auto number = static_cast<std::size_t>(options.passes);
        const auto done = static_cast<std::size_t>(pass - 1);
        if (rays && !found(options.kept, done, now)) {
            rays->pass(before, now, [&](std::size_t vertices) {
                if (options.progress) options.progress(done * count + vertices, number * count);
            });
            keep(options.kept, done, now);
        } else if (!rays)
            linkPass(mesh, gathered, materials, channels, before.vectors, now.vectors);
        buried.fill(now.vectors, stride);
        buried.fill(now.matrices, channels * matrix);
        for (std::size_t i = 0; i < now.vectors.size(); ++i) result.vectors[i] += now.vectors[i];
        for (std::size_t i = 0; i < now.matrices.size(); ++i) result.matrices[i] += now.matrices[i];
        result.energy.push_back(energyOf(mesh, materials, now.vectors, channels, slots));
        std::swap(before, now);
        if (options.progress) options.progress((done + 1) * count, number * count);
    }
    return result;
}

}  // namespace hshfit::inline precomputed_transfer
