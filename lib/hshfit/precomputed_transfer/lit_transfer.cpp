#include <hshfit/precomputed_transfer/lit_transfer.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/rendering/view.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>

namespace hshfit::inline precomputed_transfer {

LitTransfer::LitTransfer(const TransferMesh& mesh, std::span<const TransferMaterial> materials,
                         const TransferView& transfer, const LightCoefficients& light, int bands)
    : mesh_(mesh), materials_(materials) {
    if (light.order < bands || bands > transfer.order ||
        light.domain != LightCoefficients::Domain::sphere || light.condonShortley) {
        throw UsageError(
            fmt::format("light of {} bands for {} bands of transfer; it has to be on the sphere, "
                        "without the Condon-Shortley sign",
                        light.order, bands));
    }
    const std::size_t slots = transfer.slots(), rows = transfer.localSlots();
    const auto used = static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
    const bool matrices = !transfer.matrices.empty();
    if (matrices) localSlots_ = rows;
    reflected_.resize(mesh.vertices.size());
    if (matrices) incident_.resize(mesh.vertices.size() * 3 * rows);
    const auto product = [&](const float* row, std::size_t channel) {
        double sum = 0;
        const double* coefficients = light.at(light.channels.count() == 1 ? 0 : channel);
        for (std::size_t i = 0; i < used; ++i) sum += static_cast<double>(row[i]) * coefficients[i];
        return sum;
    };
    tbb::parallel_for(std::size_t{0}, mesh.vertices.size(), [&](std::size_t v) {
        const TransferMaterial& material = materials[mesh.material(v)];
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t at = v * transfer.channels + c % transfer.channels;
            reflected_[v][c] = material.albedo[c] * product(&transfer.vectors[at * slots], c);
            if (!matrices || !material.response) continue;
            for (std::size_t j = 0; j < rows; ++j)
                incident_[(v * 3 + c) * rows + j] =
                    product(&transfer.matrices[(at * rows + j) * slots], c);
        }
    });
}

Rgb LitTransfer::radiance(std::uint32_t vertex, const Direction& viewer) const {
    const TransferMaterial& material = materials_[mesh_.material(vertex)];
    if (localSlots_ == 0 || !material.response) return reflected_[vertex];
    const Frame frame = rendering::frameAt(normalised(directionOf(mesh_.vertices[vertex].normal)));
    std::array<double, std::size_t{3} * 256> response{};
    material.towards(normalised(frame.toLocal(viewer)), {response.data(), 3 * localSlots_});
    Rgb radiance{};
    const double* incident = incident_.data() + vertex * 3 * localSlots_;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t j = 0; j < localSlots_; ++j)
            radiance[c] += response[c * localSlots_ + j] * incident[c * localSlots_ + j];
    return radiance;
}

std::vector<float> transferPicture(const TransferMesh& mesh, const RayScene& scene,
                                   const LitTransfer& lit, const Camera& camera, int samples) {
    const CameraRays rays(camera);
    std::vector<float> picture(3 * camera.pixels());
    const auto width = static_cast<std::size_t>(camera.width);
    tbb::parallel_for(
        std::size_t{0}, static_cast<std::size_t>(camera.height), [&](std::size_t row) {
            for (std::size_t column = 0; column < width; ++column) {
                Rgb sum{};
                for (int k = 0; k < samples * samples; ++k) {
                    const double x = (k % samples + 0.5) / samples,
                                 y = (k / samples + 0.5) / samples;
                    const Direction along = rays.direction(static_cast<double>(column) + x,
                                                           static_cast<double>(row) + y);
                    const auto hit = scene.firstHit(rays.origin(), along);
                    if (!hit) continue;
                    const bool front = dot(mesh.normals[hit->triangle], along) < 0;
                    const std::uint32_t side = front ? hit->triangle : mesh.backs[hit->triangle];
                    if (side == TransferMesh::none) continue;
                    const double second = front ? hit->u : hit->v, third = front ? hit->v : hit->u;
                    const std::array<double, 3> weights{1 - second - third, second, third};
                    for (std::size_t corner = 0; corner < 3; ++corner) {
                        const Rgb radiance = lit.radiance(mesh.triangles[side][corner], -along);
                        for (std::size_t c = 0; c < 3; ++c) sum[c] += weights[corner] * radiance[c];
                    }
                }
                for (std::size_t c = 0; c < 3; ++c)
                    picture[3 * (row * width + column) + c] =
                        static_cast<float>(sum[c] / (samples * samples));
            }
        });
    return picture;
}

}  // namespace hshfit::inline precomputed_transfer
