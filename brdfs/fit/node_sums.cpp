#include <brdfs/fit/node_sums.h>

#include <hshfit/each_in_parallel.h>

#include <algorithm>
#include <functional>

namespace hshfit::brdfs {

namespace {

// Runs of one outgoing direction, in one call each.
std::vector<double> valuesAt(const Brdf& brdf, const NodeSums& sums,
                             const std::vector<double>& wiY) {
    constexpr std::size_t blockSize = 1024;
    const std::size_t channels = brdf.channels().count(), count = sums.size();
    std::vector<double> values(channels * count);
    eachInParallel((count + blockSize - 1) / blockSize, [&](std::size_t block) {
        const std::size_t end = std::min(count, (block + 1) * blockSize);
        std::vector<double> buffer;
        for (std::size_t k = block * blockSize; k < end;) {
            const Direction& wo = sums.wo[k];
            std::size_t next = k + 1;
            while (next < end && sums.wo[next].x == wo.x && sums.wo[next].y == wo.y &&
                   sums.wo[next].z == wo.z)
                ++next;
            const std::size_t run = next - k;
            buffer.resize(channels * run);
            brdf.eval(wo, {sums.wiX.data() + k, wiY.data() + k, sums.wiZ.data() + k, run},
                      buffer.data());
            for (std::size_t c = 0; c < channels; ++c)
                std::copy_n(buffer.data() + c * run, run, values.data() + c * count + k);
            k = next;
        }
    });
    return values;
}

}  // namespace

std::vector<double> valuesAt(const Brdf& brdf, const NodeSums& sums) {
    std::vector<double> values = valuesAt(brdf, sums, sums.wiY);
    if (brdf.laws().mirrorSymmetric || std::ranges::none_of(sums.mirrored, std::identity()))
        return values;
    std::vector<double> images = sums.wiY;
    for (std::size_t k = 0; k < images.size(); ++k)
        if (sums.mirrored[k]) images[k] = -images[k];
    const std::vector<double> other = valuesAt(brdf, sums, images);
    for (std::size_t v = 0; v < values.size(); ++v) values[v] = 0.5 * (values[v] + other[v]);
    return values;
}

std::vector<double> summed(const NodeSums& sums, const std::vector<std::size_t>& rows,
                           const std::vector<double>& values) {
    const std::size_t nodes = sums.size(), channels = values.size() / nodes;
    std::vector<double> result;
    for (std::size_t c = 0; c < channels; ++c)
        for (const std::size_t place : rows) {
            const NodeSums::Row& row = sums.rows[place];
            double sum = 0;
            for (std::size_t j = 0; j < row.nodes; ++j)
                sum += sums.factors[row.firstFactor + j] * values[c * nodes + row.firstNode + j];
            result.push_back(sum);
        }
    return result;
}

}  // namespace hshfit::brdfs
