#include <hshfit/quadrature/azimuth_tables.h>

#include <hshfit/brdf/directions.h>

#include <tbb/concurrent_unordered_map.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <mutex>

namespace hshfit::inline quadrature {

void AzimuthTable::fill(int order, const AzimuthSpacing& spacing, std::size_t first,
                        std::size_t howMany) {
    count = howMany;
    cosine.resize(count);
    sine.resize(count);
    weights.resize(spacing.squeeze > 0 ? count : 0);
    const double step = 2 * pi / static_cast<double>(spacing.azimuths);
    for (std::size_t j = 0; j < count; ++j) {
        const double t = (static_cast<double>(first + j) + 0.5) * step;
        const SpreadAzimuth at = spreadAzimuth(t, spacing);
        cosine[j] = at.cosine;
        sine[j] = at.sine;
        if (!weights.empty()) weights[j] = at.weight;
    }
    fillRows(order);
}

void AzimuthTable::fill(int order, const AzimuthSpacing& spacing, std::span<const double> t,
                        std::span<const double> ofNodes) {
    count = t.size();
    cosine.resize(count);
    sine.resize(count);
    weights.resize(count);
    for (std::size_t j = 0; j < count; ++j) {
        const SpreadAzimuth at = spreadAzimuth(t[j], spacing);
        cosine[j] = at.cosine;
        sine[j] = at.sine;
        weights[j] = at.weight * ofNodes[j];
    }
    fillRows(order);
}

void AzimuthTable::fillRows(int order) {
    const AzimuthColumns columns(order);
    const std::size_t stride = columns.all();
    rows.assign(stride * count, 0.0);
    // Powers of exp(i phi): their error is about m eps. Several azimuths at a time, since each is a
    // chain of its own.
    constexpr std::size_t together = 8;
    for (std::size_t from = 0; from < count; from += together) {
        const std::size_t some = std::min(together, count - from);
        double re[together] = {}, im[together] = {}, c[together] = {}, s[together] = {};
        std::copy_n(cosine.data() + from, some, c);
        std::copy_n(sine.data() + from, some, s);
        for (std::size_t j = 0; j < some; ++j) re[j] = weights.empty() ? 1 : weights[from + j];
        double* to = rows.data() + from * stride;
        for (std::size_t j = 0; j < some; ++j) to[j * stride] = re[j] / std::sqrt(2 * pi);
        for (std::size_t j = 0; j < together; ++j) re[j] /= std::sqrt(pi);
        for (int m = 1; m < order; ++m) {
            for (std::size_t j = 0; j < together; ++j) {
                const double next = re[j] * c[j] - im[j] * s[j];
                im[j] = re[j] * s[j] + im[j] * c[j];
                re[j] = next;
            }
            const std::size_t even = columns.of(m), odd = columns.of(-m);
            for (std::size_t j = 0; j < some; ++j) {
                to[j * stride + even] = re[j];
                to[j * stride + odd] = im[j];
            }
        }
    }
}

namespace {

/// Azimuths and values of one table; values of all cached tables.
constexpr std::size_t mostAzimuths = 4096;
constexpr std::size_t mostValues = std::size_t{1} << 18, mostKept = std::size_t{1} << 23;

struct Slot {
    std::once_flag once;
    AzimuthTable table;
};

}  // namespace

struct AzimuthTables::Kept {
    tbb::concurrent_unordered_map<std::size_t, std::unique_ptr<Slot>> slots;
    std::atomic<std::size_t> values = 0;

    /// None where the cache is full.
    Slot* find(const AzimuthSpacing& spacing, std::size_t size) {
        const std::size_t key = spacing.azimuths * 64 + static_cast<std::size_t>(spacing.squeeze);
        if (const auto found = slots.find(key); found != slots.end()) return found->second.get();
        if (values.load(std::memory_order_relaxed) + size > mostKept) return nullptr;
        const auto [place, isNew] = slots.emplace(key, std::make_unique<Slot>());
        if (isNew) values += size;
        return place->second.get();
    }
};

AzimuthTables::AzimuthTables(int order) : order_(order), kept_(std::make_unique<Kept>()) {}
AzimuthTables::~AzimuthTables() = default;

std::shared_ptr<const AzimuthTable> AzimuthTables::find(const AzimuthSpacing& spacing) const {
    assert(spacing.azimuths % 4 == 0);
    const std::size_t count = tableSize(spacing), size = count * AzimuthColumns(order_).all();
    if (spacing.azimuths > mostAzimuths || size > mostValues) return nullptr;
    const auto fill = [&](AzimuthTable& table) { table.fill(order_, spacing, 0, count); };
    if (Slot* slot = kept_->find(spacing, size)) {
        std::call_once(slot->once, fill, slot->table);
        return {std::shared_ptr<const AzimuthTable>(), &slot->table};  // kept_ owns it
    }
    auto own = std::make_shared<AzimuthTable>();
    fill(*own);
    return own;
}

}  // namespace hshfit::inline quadrature
