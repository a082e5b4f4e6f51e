#include "transfer_clusters.h"

#include <hshfit/byte_cursor.h>
#include <hshfit/files/tensor_file_writer.h>
#include <hshfit/percent.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace hshfit::jobs {
namespace {

using Head = std::array<std::uint64_t, 5>;

/// Facts that clusters depend on beside the scene: of another head, they are made anew.
Head headOf(const TransferView& view, const ClusterOptions& options, int passes) {
    return {options.clusters, options.components, static_cast<std::uint64_t>(options.rounds),
            static_cast<std::uint64_t>(passes), view.matrices.size()};
}

template <class Number>
void append(std::vector<std::byte>& bytes, const std::vector<Number>& values) {
    const std::uint64_t count = values.size();
    const auto head = std::as_bytes(std::span(&count, 1)), body = std::as_bytes(std::span(values));
    bytes.insert(bytes.end(), head.begin(), head.end());
    bytes.insert(bytes.end(), body.begin(), body.end());
}

template <class Number>
bool take(ByteCursor& cursor, std::vector<Number>& values) {
    const auto count = cursor.number<std::uint64_t>();
    if (!count || *count > cursor.left() / sizeof(Number)) return false;
    const auto raw = cursor.take(*count * sizeof(Number));
    values.resize(*count);
    if (!values.empty()) std::memcpy(values.data(), raw->data(), raw->size());
    return true;
}

std::optional<MatrixClusters> clustersOf(std::span<const std::byte> bytes, const Head& head) {
    ByteCursor cursor(bytes);
    if (cursor.number<Head>() != head) return {};
    MatrixClusters found;
    for (std::size_t* size : {&found.clusters, &found.components, &found.dimension})
        *size = cursor.number<std::uint64_t>().value_or(0);
    const bool whole = take(cursor, found.means) && take(cursor, found.basis) &&
                       take(cursor, found.of) && take(cursor, found.weights) &&
                       take(cursor, found.errors);
    if (!whole) return {};
    return found;
}

std::vector<std::byte> bytesOf(const MatrixClusters& made, const Head& head) {
    const std::uint64_t sizes[] = {made.clusters, made.components, made.dimension};
    std::vector<std::byte> bytes;
    for (const std::span<const std::uint64_t> part :
         {std::span<const std::uint64_t>(head), std::span<const std::uint64_t>(sizes)}) {
        const auto raw = std::as_bytes(part);
        bytes.insert(bytes.end(), raw.begin(), raw.end());
    }
    append(bytes, made.means);
    append(bytes, made.basis);
    append(bytes, made.of);
    append(bytes, made.weights);
    append(bytes, made.errors);
    return bytes;
}

MatrixClusters keptOrMade(const TransferView& view, const ClusterOptions& options, int passes,
                          const KeptParts& kept) {
    const Head head = headOf(view, options, passes);
    if (kept.find) {
        if (const auto bytes = kept.find(options.clusters))
            if (auto found = clustersOf(*bytes, head)) return std::move(*found);
    }
    MatrixClusters made = clusterMatrices(view, options);
    if (kept.keep) kept.keep(options.clusters, bytesOf(made, head));
    return made;
}

/// The number of the chosen form, or the one with the least error if none is within the bounds.
std::size_t chosen(const std::vector<ClusterError>& all, const TransferOptions& options) {
    const auto better = [&](const ClusterError& a, const ClusterError& b) {
        const bool byBytes = options.bytes.has_value();
        const auto within = [&](const ClusterError& e) {
            return byBytes ? e.bytes <= *options.bytes : e.relativeL2 <= options.error;
        };
        if (within(a) != within(b)) return within(a);
        if (within(a) != byBytes) return a.bytes < b.bytes;
        return a.relativeL2 < b.relativeL2;
    };
    return static_cast<std::size_t>(std::ranges::min_element(all, better) - all.begin());
}

/// Bounds that no form keeps.
std::optional<Poor> judge(const ClusterError& kept, const TransferOptions& options) {
    if (options.bytes && kept.bytes > *options.bytes) {
        return Poor{.reason = fmt::format("the smallest matrices take {} bytes, and {} are allowed",
                                          kept.bytes, *options.bytes),
                    .toTry = fmt::format("{} with fewer, or a lower {}",
                                         Setting{"TransferOptions::clusters"},
                                         Setting{"TransferOptions::localOrder"})};
    }
    if (!options.bytes && kept.relativeL2 > options.error) {
        return Poor{.reason = fmt::format(
                        "the compressed matrices have an error of {}, and {} are asked for",
                        percent(kept.relativeL2, 2), percent(options.error, 2)),
                    .toTry = fmt::format("more {} and {}, or the matrices of transfer.tensor",
                                         Setting{"TransferOptions::clusters"},
                                         Setting{"TransferOptions::components"})};
    }
    return {};
}

}  // namespace

MatrixClusters compressed(const TransferView& view, const KeptParts& kept, const Listener& listener,
                          Transferred& done) {
    const TransferOptions& options = done.options;
    std::vector<MatrixClusters> tried;
    for (const std::size_t clusters : options.clusters) {
        ClusterOptions some{.clusters = clusters, .components = options.components};
        some.progress = listener.part(fmt::format("{} clusters", clusters));
        tried.push_back(keptOrMade(view, some, options.passes, kept));
        const auto& errors = tried.back().errors;
        done.compression.insert(done.compression.end(), errors.begin(), errors.end());
    }
    const std::size_t best = chosen(done.compression, options);
    done.compressed = done.compression[best];
    done.poor = judge(*done.compressed, options);
    return tried[best / (options.components + 1)].truncated(done.compressed->components);
}

void writeClusters(const MatrixClusters& clusters, const TransferView& view, FileSet& files) {
    const std::uint64_t number = clusters.clusters, components = clusters.components,
                        channels = view.channels, rows = view.localSlots(), slots = view.slots();
    TensorFileWriter writer;
    writer.add("means", {number, channels, rows, slots}, clusters.means);
    writer.add("components", {number, components, channels, rows, slots}, clusters.basis);
    writer.add("clusters", {clusters.of.size()}, clusters.of);
    writer.add("weights", {clusters.of.size(), components}, clusters.weights);
    files.write("clusters.tensor", [&](AtomicFile& file) { writer.write(file); });
}

}  // namespace hshfit::jobs
