#include <hshfit/precomputed_transfer/internal/buried_vertices.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace hshfit::inline precomputed_transfer {

BuriedVertices::BuriedVertices(const TransferMesh& mesh, std::span<const std::uint32_t> buried) {
    // Slivers whose normals turn away share no vertex with the triangles beside them.
    using Place = std::tuple<std::uint32_t, bool, MeshVector>;
    const auto placeOf = [&](std::uint32_t v) {
        const bool front = mesh.around[mesh.first[v]] < mesh.fronts;
        return Place{mesh.vertices[v].object, front, mesh.vertices[v].position};
    };
    std::map<Place, std::vector<std::uint32_t>> places;
    for (const std::uint32_t v : buried) places[placeOf(v)];
    for (std::uint32_t v = 0; v < mesh.vertices.size() && !places.empty(); ++v) {
        const auto found = places.find(placeOf(v));
        if (found != places.end()) found->second.push_back(v);
    }
    std::vector<char> open(mesh.vertices.size(), 1);
    for (const std::uint32_t v : buried) open[v] = 0;
    std::vector<std::uint32_t> left(buried.begin(), buried.end()), next;
    while (!left.empty()) {
        const std::size_t before = order_.size();
        next.clear();
        for (const std::uint32_t v : left) {
            Vertex vertex{v, {}};
            for (std::uint32_t k = mesh.first[v]; k < mesh.first[v + 1]; ++k) {
                for (const std::uint32_t other : mesh.triangles[mesh.around[k]])
                    if (open[other]) vertex.sources.push_back(other);
            }
            for (const std::uint32_t other : places[placeOf(v)])
                if (open[other]) vertex.sources.push_back(other);
            std::ranges::sort(vertex.sources);
            vertex.sources.erase(std::unique(vertex.sources.begin(), vertex.sources.end()),
                                 vertex.sources.end());
            if (vertex.sources.empty())
                next.push_back(v);
            else
                order_.push_back(std::move(vertex));
        }
        if (order_.size() == before) break;
        for (std::size_t k = before; k < order_.size(); ++k) open[order_[k].vertex] = 1;
        left.swap(next);
    }
}

void BuriedVertices::fill(std::vector<float>& values, std::size_t stride) const {
    for (const Vertex& vertex : order_) {
        float* out = values.data() + vertex.vertex * stride;
        for (std::size_t i = 0; i < stride; ++i) {
            double sum = 0;
            for (const std::uint32_t source : vertex.sources)
                sum += static_cast<double>(values[source * stride + i]);
            out[i] = static_cast<float>(sum / static_cast<double>(vertex.sources.size()));
        }
    }
}

}  // namespace hshfit::inline precomputed_transfer
