#include <brdfs/measured/scattered/table_interpolant.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

constexpr double sameAngle = 1e-7;

/// A place between two entries of an ascending list.
struct Bracket {
    std::size_t low = 0, high = 0;
    double share = 0;   ///< of the upper entry
    double excess = 0;  ///< the distance to the list's end, for an angle outside of it
};

Bracket bracketOf(const std::vector<double>& list, double x) {
    const std::size_t last = list.size() - 1;
    if (x <= list.front()) return {.excess = list.front() - x};
    if (x >= list.back()) return {last, last, 0, x - list.back()};
    const auto above = std::upper_bound(list.begin(), list.end(), x);
    const auto high = static_cast<std::size_t>(above - list.begin());
    return {high - 1, high, (x - list[high - 1]) / (list[high] - list[high - 1]), 0};
}

double largestGap(const std::vector<double>& list) {
    double gap = 0;
    for (std::size_t k = 1; k < list.size(); ++k) gap = std::max(gap, list[k] - list[k - 1]);
    return gap;
}

/// Weighted values of the places that have a sample.
struct Sums {
    double* out;
    std::size_t stride, channels;
    double weight = 0;

    void add(const double* values, double share) {
        if (!(share > 0) || std::isnan(values[0])) return;
        weight += share;
        for (std::size_t c = 0; c < channels; ++c) out[c * stride] += share * values[c];
    }
};

/// The position of wo about the mirror direction: cos(radius), and sin(radius) times the cosine and
/// sine of the azimuth.
struct LobePlace {
    double along, towardsNormal, aside;
};

struct Table {
    double incidence = 0;
    bool aboutMirror = false;
    std::vector<double> polars = {}, azimuths = {};
    std::vector<double> values = {};  ///< [polar][azimuth][channel], NaN where not measured

    void add(const LobePlace& place, bool mirror, double reach, double weight, Sums& sums) const;

private:
    void addAt(double polar, double azimuth, double reach, double weight, Sums& sums) const;
    double outside(double azimuth) const;
};

/// The distance of an azimuth from the table's range, 0 inside.
double Table::outside(double azimuth) const {
    const double first = azimuths.front();
    double turned = std::fmod(azimuth - first, 2 * pi);
    if (turned < 0) turned += 2 * pi;
    const double range = azimuths.back() - first;
    return turned <= range + sameAngle ? 0 : std::min(turned - range, 2 * pi - turned);
}

void Table::addAt(double polar, double azimuth, double reach, double weight, Sums& sums) const {
    const double first = azimuths.front();
    double turned = std::fmod(azimuth - first, 2 * pi);
    if (turned < 0) turned += 2 * pi;
    const double range = azimuths.back() - first;
    if (turned > range && 2 * pi - turned < turned - range) turned -= 2 * pi;
    const Bracket p = bracketOf(polars, polar), a = bracketOf(azimuths, first + turned);
    const double excess = std::hypot(p.excess, a.excess * std::sin(polar));
    weight *= std::max(0.0, 1 - excess / reach);
    const auto at = [&](std::size_t row, std::size_t column) {
        return values.data() + (row * azimuths.size() + column) * sums.channels;
    };
    sums.add(at(p.low, a.low), weight * (1 - p.share) * (1 - a.share));
    sums.add(at(p.low, a.high), weight * (1 - p.share) * a.share);
    sums.add(at(p.high, a.low), weight * p.share * (1 - a.share));
    sums.add(at(p.high, a.high), weight * p.share * a.share);
}

void Table::add(const LobePlace& place, bool mirror, double reach, double weight,
                Sums& sums) const {
    double polar = 0, azimuth = 0;
    if (aboutMirror) {
        polar = std::atan2(std::hypot(place.towardsNormal, place.aside), place.along);
        azimuth = std::atan2(place.aside, place.towardsNormal);
    } else {
        const double s = std::sin(incidence), c = std::cos(incidence);
        const double x = place.along * s - place.towardsNormal * c;
        const double z = place.along * c + place.towardsNormal * s;
        constexpr double rounding = -1e-9;
        if (z < rounding) return;
        polar = std::atan2(std::hypot(x, place.aside), z);
        azimuth = std::atan2(-place.aside, x);
    }
    if (!mirror) return addAt(polar, azimuth, reach, weight, sums);
    const double here = outside(azimuth), there = outside(-azimuth);
    // Both sides were measured: f is their mean.
    if (here == 0 && there == 0) {
        addAt(polar, std::fabs(azimuth), reach, weight / 2, sums);
        addAt(polar, -std::fabs(azimuth), reach, weight / 2, sums);
        return;
    }
    addAt(polar, here <= there ? azimuth : -azimuth, reach, weight, sums);
}

/// A whole turn of azimuths ends where it began.
void closeCircle(Table& table, std::size_t channels) {
    const double rest = 2 * pi - (table.azimuths.back() - table.azimuths.front());
    if (rest > 1.5 * largestGap(table.azimuths)) return;
    const std::size_t old = table.azimuths.size();
    std::vector<double> closed;
    for (std::size_t p = 0; p < table.polars.size(); ++p) {
        const auto row = table.values.begin() + static_cast<std::ptrdiff_t>(p * old * channels);
        closed.insert(closed.end(), row, row + static_cast<std::ptrdiff_t>(old * channels));
        closed.insert(closed.end(), row, row + static_cast<std::ptrdiff_t>(channels));
    }
    table.values = std::move(closed);
    table.azimuths.push_back(table.azimuths.front() + 2 * pi);
}

Table compiled(const AngleTable& from, std::span<const double> values, std::size_t channels) {
    Table table{.incidence = from.incidence,
                .aboutMirror = from.aboutMirror,
                .polars = from.polars,
                .azimuths = from.azimuths};
    for (const std::size_t sample : from.samples)
        for (std::size_t c = 0; c < channels; ++c)
            table.values.push_back(sample == AngleTable::missing
                                       ? std::numeric_limits<double>::quiet_NaN()
                                       : values[sample * channels + c]);
    closeCircle(table, channels);
    return table;
}

/// The table of normal incidence that has the mean over all azimuths of another one.
Table meanOverAzimuth(const Table& from, bool mirror, double reach, std::size_t channels) {
    constexpr int turns = 72;
    Table mean{
        .incidence = 0, .aboutMirror = true, .polars = from.polars, .azimuths = {0, pi, 2 * pi}};
    if (mean.polars.front() > sameAngle && mean.polars.front() <= reach)
        mean.polars.insert(mean.polars.begin(), 0.0);
    std::vector<double> ring(channels);
    for (const double radius : mean.polars) {
        std::ranges::fill(ring, 0.0);
        Sums sums{.out = ring.data(), .stride = 1, .channels = channels};
        for (int k = 0; k < turns; ++k) {
            const double a = 2 * pi * k / turns;
            from.add(
                {std::cos(radius), std::sin(radius) * std::cos(a), std::sin(radius) * std::sin(a)},
                mirror, reach, 1.0, sums);
        }
        for (double& value : ring)
            value =
                sums.weight > 0 ? value / sums.weight : std::numeric_limits<double>::quiet_NaN();
        for (std::size_t a = 0; a < mean.azimuths.size(); ++a)
            mean.values.insert(mean.values.end(), ring.begin(), ring.end());
    }
    return mean;
}

}  // namespace

struct TableInterpolant::Parts {
    Options options;
    std::size_t channels = 0;
    std::vector<double> azimuths;            ///< of wi, ascending
    std::vector<std::vector<Table>> tables;  ///< [azimuth], in ascending order of the incidence
    std::vector<std::vector<double>> incidences;

    void add(std::size_t k, double incidence, const LobePlace& place, double weight,
             Sums& sums) const;
};

void TableInterpolant::Parts::add(std::size_t k, double incidence, const LobePlace& place,
                                  double weight, Sums& sums) const {
    const Bracket at = bracketOf(incidences[k], incidence);
    weight *= std::max(0.0, 1 - at.excess / options.reach);
    const auto addTable = [&](std::size_t table, double share) {
        if (weight * share > 0)
            tables[k][table].add(place, options.mirror, options.reach, weight * share, sums);
    };
    addTable(at.low, 1 - at.share);
    addTable(at.high, at.share);
}

bool TableInterpolant::suits(const std::vector<AngleTable>& tables, bool isotropic) {
    const double widest = radians(60);
    bool several = false;
    for (const AngleTable& table : tables) {
        if (table.polars.size() < 2 || table.azimuths.size() < 3) return false;
        if (largestGap(table.azimuths) > widest + sameAngle) return false;
        several |= std::fabs(table.azimuth - tables.front().azimuth) > sameAngle;
    }
    return !tables.empty() && several != isotropic;
}

TableInterpolant::TableInterpolant(const std::vector<AngleTable>& tables,
                                   std::span<const double> values, std::size_t channels,
                                   const Options& options)
    : parts_(std::make_unique<Parts>()) {
    assert(suits(tables, options.isotropic) && options.reach > 0);
    Parts& p = *parts_;
    p.options = options;
    p.channels = channels;
    for (const AngleTable& table : tables) p.azimuths.push_back(table.azimuth);
    std::ranges::sort(p.azimuths);
    const auto alike = [](double a, double b) { return b - a < sameAngle; };
    p.azimuths.erase(std::unique(p.azimuths.begin(), p.azimuths.end(), alike), p.azimuths.end());
    for (const double azimuth : p.azimuths) {
        std::vector<Table> of;
        for (const AngleTable& table : tables)
            if (std::fabs(table.azimuth - azimuth) <= sameAngle)
                of.push_back(compiled(table, values, channels));
        std::ranges::sort(of, {}, &Table::incidence);
        if (options.isotropic && of.front().incidence <= options.reach) {
            Table normal = meanOverAzimuth(of.front(), options.mirror, options.reach, channels);
            if (of.front().incidence <= sameAngle)
                of.front() = std::move(normal);
            else
                of.insert(of.begin(), std::move(normal));
        }
        std::vector<double> incidences;
        for (const Table& table : of) incidences.push_back(table.incidence);
        p.tables.push_back(std::move(of));
        p.incidences.push_back(std::move(incidences));
    }
}

TableInterpolant::~TableInterpolant() = default;

double TableInterpolant::evaluate(const Direction& wi, const Direction& wo, double* out,
                                  std::size_t stride) const {
    const Parts& p = *parts_;
    const double sine = std::hypot(wi.x, wi.y), incidence = std::atan2(sine, wi.z);
    const double x = sine > 1e-12 ? -wi.x / sine : 1, y = sine > 1e-12 ? -wi.y / sine : 0;
    const double mirrorSide = wo.x * x + wo.y * y;
    const LobePlace place{.along = mirrorSide * sine + wo.z * wi.z,
                          .towardsNormal = wo.z * sine - mirrorSide * wi.z,
                          .aside = wo.x * y - wo.y * x};
    for (std::size_t c = 0; c < p.channels; ++c) out[c * stride] = 0;
    Sums sums{.out = out, .stride = stride, .channels = p.channels};
    if (p.azimuths.size() == 1) {
        p.add(0, incidence, place, 1.0, sums);
    } else {
        // The rotations go once around, or leave a gap in which the tables at its ends fade.
        std::vector<double> around = p.azimuths;
        const double gap = 2 * pi - (around.back() - around.front());
        const bool closed = gap <= 1.5 * largestGap(around);
        if (closed) around.push_back(around.front() + 2 * pi);
        double turned = std::fmod(std::atan2(-y, -x) - around.front(), 2 * pi);
        if (turned < 0) turned += 2 * pi;
        const double range = around.back() - around.front();
        if (turned > range && 2 * pi - turned < turned - range) turned -= 2 * pi;
        const Bracket at = bracketOf(around, around.front() + turned);
        const double weight = std::max(0.0, 1 - at.excess * sine / p.options.reach);
        p.add(at.low % p.azimuths.size(), incidence, place, weight * (1 - at.share), sums);
        p.add(at.high % p.azimuths.size(), incidence, place, weight * at.share, sums);
    }
    if (!(sums.weight > 0)) return 0;
    for (std::size_t c = 0; c < p.channels; ++c) out[c * stride] /= sums.weight;
    return std::min(1.0, 2 * sums.weight);
}

}  // namespace hshfit::brdfs
