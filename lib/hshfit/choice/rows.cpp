#include <hshfit/choice/rows.h>

#include <hshfit/error.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::choice {
namespace {

std::optional<PairReference> referenceOf(const Brdf& source) {
    try {
        return PairReference(source, spreadPairs());
    } catch (const NumericError&) {
        return std::nullopt;
    }
}

}  // namespace

RowMeasurement::RowMeasurement(const Brdf& source, const PoorBounds& bounds,
                               const gpu::ShaderCosts* costs)
    : source_(source),
      bounds_(bounds),
      costs_(costs),
      pictures_(source),
      pairs_(referenceOf(source)) {}

std::optional<double> RowMeasurement::capturedBy(const Brdf& g) const {
    if (!pairs_ || g.channels().count() != source_.channels().count()) return std::nullopt;
    const double left = pairs_->errorsOf(g).energyLeft;
    return std::isfinite(left) ? std::optional(1 - left) : std::nullopt;
}

Row RowMeasurement::rowOf(const Candidate& candidate) const {
    Row row{.kind = candidate.kind, .name = candidate.name, .made = candidate.make()};
    const Brdf& g = row.made.brdf ? *row.made.brdf : source_;
    row.picture = row.made.brdf ? pictures_.errorOf(g) : pictures_.errorOfItself();
    row.captured = capturedBy(g);
    row.poor = poorReason(row.captured, row.picture, bounds_);
    row.lost = lossSentence(row.picture);
    if (costs_ && row.made.shader) row.cost = costs_->of(row.made.shader());
    return row;
}

MeasuredRows measureRows(const RowMeasurement& measurement, std::span<const Candidate> candidates) {
    MeasuredRows measured;
    for (const Candidate& candidate : candidates) {
        try {
            measured.rows.push_back(measurement.rowOf(candidate));
        } catch (const OutputError&) {
            throw;
        } catch (const Error& error) {
            measured.leftOut.push_back({candidate.kind, candidate.name, error.what()});
        }
    }
    std::ranges::stable_sort(measured.rows, std::less{},
                             [](const Row& row) { return row.made.bytes; });
    return measured;
}

}  // namespace hshfit::choice
