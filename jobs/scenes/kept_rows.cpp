#include "kept_rows.h"

#include <hshfit/byte_cursor.h>

#include <fmt/format.h>

#include <cstring>
#include <span>
#include <vector>

namespace hshfit::jobs {
namespace {

std::string keyOf(const std::string& inputs, const Camera& camera, const PathOptions& options) {
    return fmt::format("paths of {}\n{}\n{} {} {} {} {}", camera.name, inputs, options.samples,
                       options.mostBounces, options.fewestBounces, options.sureBounces,
                       options.seed);
}

void append(std::vector<std::byte>& bytes, std::span<const std::byte> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
}

}  // namespace

KeptRows::KeptRows(const std::string& path, const std::string& inputs, const Camera& camera,
                   const PathOptions& options)
    : width_(static_cast<std::size_t>(camera.width)), work_(path, keyOf(inputs, camera, options)) {}

PathRows KeptRows::rows() {
    PathRows rows;
    rows.find = [this](int row) -> std::optional<PathRow> {
        const auto bytes = work_.block(static_cast<std::uint64_t>(row));
        if (!bytes) return std::nullopt;
        ByteCursor cursor(*bytes);
        PathRow result;
        for (std::size_t* count : {&result.rays, &result.cut})
            *count = cursor.number<std::uint64_t>().value_or(0);
        for (std::vector<float>* values : {&result.radiance, &result.error}) {
            const auto raw = cursor.take(3 * width_ * sizeof(float));
            if (!raw) return std::nullopt;
            values->resize(3 * width_);
            std::memcpy(values->data(), raw->data(), raw->size());
        }
        ++taken_;
        return result;
    };
    rows.keep = [this](int row, const PathRow& done) {
        const std::uint64_t counts[] = {done.rays, done.cut};
        std::vector<std::byte> bytes;
        append(bytes, std::as_bytes(std::span(counts)));
        append(bytes, std::as_bytes(std::span(done.radiance)));
        append(bytes, std::as_bytes(std::span(done.error)));
        work_.add(static_cast<std::uint64_t>(row), bytes);
    };
    return rows;
}

}  // namespace hshfit::jobs
