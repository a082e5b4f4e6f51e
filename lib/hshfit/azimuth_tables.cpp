#include <hshfit/azimuth_tables.h>

#include <hshfit/directions.h>

#include <cassert>
#include <cmath>
#include <mutex>

namespace hshfit {

void AzimuthTable::fill(int order, std::size_t azimuths, std::size_t first, std::size_t howMany) {
    count = howMany;
    cosine.resize(count);
    sine.resize(count);
    const double step = 2 * pi / static_cast<double>(azimuths);
    for (std::size_t j = 0; j < count; ++j) {
        const double phi = (static_cast<double>(first + j) + 0.5) * step;
        cosine[j] = std::cos(phi);
        sine[j] = std::sin(phi);
    }
    const AzimuthColumns columns(order);
    rows.resize(columns.all() * count);
    const auto row = [&](int m) { return rows.data() + columns.of(m) * count; };
    for (std::size_t j = 0; j < count; ++j) row(0)[j] = 1 / std::sqrt(2 * pi);
    // Powers of exp(i phi): their error is about m eps.
    for (int m = 1; m < order; ++m) {
        double *re = row(m), *im = row(-m);
        if (m == 1) {
            for (std::size_t j = 0; j < count; ++j) re[j] = cosine[j] / std::sqrt(pi);
            for (std::size_t j = 0; j < count; ++j) im[j] = sine[j] / std::sqrt(pi);
            continue;
        }
        const double *before = row(m - 1), *imBefore = row(1 - m);
        for (std::size_t j = 0; j < count; ++j) {
            re[j] = before[j] * cosine[j] - imBefore[j] * sine[j];
            im[j] = before[j] * sine[j] + imBefore[j] * cosine[j];
        }
    }
}

namespace {

constexpr std::size_t largestQuadrant = 1024, mostValues = std::size_t{1} << 18;

}  // namespace

struct AzimuthTables::Kept {
    struct Slot {
        std::once_flag once;
        AzimuthTable table;
    };
    std::vector<Slot> byQuadrant = std::vector<Slot>(largestQuadrant + 1);
};

AzimuthTables::AzimuthTables(int order) : order_(order), kept_(std::make_unique<Kept>()) {}
AzimuthTables::~AzimuthTables() = default;

const AzimuthTable* AzimuthTables::find(std::size_t azimuths) const {
    const std::size_t quadrant = azimuths / 4;
    assert(azimuths % 4 == 0);
    if (quadrant > largestQuadrant || quadrant * AzimuthColumns(order_).all() > mostValues) {
        return nullptr;
    }
    Kept::Slot& slot = kept_->byQuadrant[quadrant];
    std::call_once(slot.once, [&] { slot.table.fill(order_, azimuths, 0, quadrant); });
    return &slot.table;
}

}  // namespace hshfit
