#include <brdfs/measured/scattered/angle_tables.h>
#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace hshfit::brdfs {
namespace {

/// Half of a second of arc, above the rounding of angles that were read in degrees.
constexpr double oneAngle = 2e-6;

/// A place of a table, with the number of its sample.
struct TableEntry {
    double polar, azimuth;
    std::size_t sample;
};

/// The angle within a turn from `start`.
double turnedFrom(double start, double angle) {
    double turned = std::fmod(angle - start, 2 * pi);
    if (turned < -oneAngle) turned += 2 * pi;
    return turned > 2 * pi - oneAngle ? start : start + turned;
}

void sortOut(std::vector<double>& angles) {
    std::ranges::sort(angles);
    const auto alike = [](double a, double b) { return b - a < oneAngle; };
    angles.erase(std::unique(angles.begin(), angles.end(), alike), angles.end());
}

std::size_t indexOf(const std::vector<double>& angles, double angle) {
    const auto at = std::lower_bound(angles.begin(), angles.end(), angle - oneAngle);
    return static_cast<std::size_t>(at - angles.begin());
}

/// The azimuth behind the largest gap of a circle of azimuths.
double startOf(std::vector<double> azimuths) {
    for (double& azimuth : azimuths) azimuth = turnedFrom(0, azimuth);
    sortOut(azimuths);
    if (azimuths.empty()) return 0;
    double start = azimuths.front(), gap = azimuths.front() + 2 * pi - azimuths.back();
    for (std::size_t k = 1; k < azimuths.size(); ++k)
        if (azimuths[k] - azimuths[k - 1] > gap + oneAngle) {
            gap = azimuths[k] - azimuths[k - 1];
            start = azimuths[k];
        }
    return start;
}

/// Fills the lists of `table` from its entries. An entry at the pole stands for all azimuths there.
/// Returns the share of places that have a sample.
double fillTable(AngleTable& table, const std::vector<TableEntry>& entries) {
    std::vector<double> azimuths;
    table.polars.clear();
    for (const TableEntry& entry : entries) {
        table.polars.push_back(entry.polar);
        if (entry.polar > oneAngle) azimuths.push_back(entry.azimuth);
    }
    const double start = startOf(azimuths);
    for (double& azimuth : azimuths) azimuth = turnedFrom(start, azimuth);
    table.azimuths = std::move(azimuths);
    sortOut(table.polars);
    sortOut(table.azimuths);
    const std::size_t count = table.azimuths.size();
    table.samples.assign(table.polars.size() * count, AngleTable::missing);
    for (const TableEntry& entry : entries) {
        const auto row = static_cast<std::ptrdiff_t>(indexOf(table.polars, entry.polar) * count);
        const auto places = table.samples.begin() + row;
        if (entry.polar > oneAngle) {
            const std::size_t a = indexOf(table.azimuths, turnedFrom(start, entry.azimuth));
            places[static_cast<std::ptrdiff_t>(a)] = entry.sample;
        } else {
            std::fill_n(places, count, entry.sample);
        }
    }
    if (table.samples.empty()) return 0;
    const auto holes = std::ranges::count(table.samples, AngleTable::missing);
    return 1 - static_cast<double>(holes) / static_cast<double>(table.samples.size());
}

/// Polar angle and azimuth of wo about the pole of the table, for light from azimuth `from`.
TableEntry entryOf(const AngleTable& table, double from, const Direction& wo, std::size_t sample) {
    const double x = -(wo.x * std::cos(from) + wo.y * std::sin(from));
    const double y = wo.x * std::sin(from) - wo.y * std::cos(from);
    if (!table.aboutMirror) return {std::atan2(std::hypot(x, y), wo.z), std::atan2(y, x), sample};
    const double s = std::sin(table.incidence), c = std::cos(table.incidence);
    const double along = x * s + wo.z * c, towardsNormal = wo.z * s - x * c;
    return {std::atan2(std::hypot(towardsNormal, y), along), std::atan2(-y, towardsNormal), sample};
}

}  // namespace

std::vector<AngleTable> tablesOf(const Samples& samples, bool aboutMirror, bool isotropic) {
    // Incidence and azimuth of wi in steps of `oneAngle`, with the samples that have them.
    std::map<std::pair<long, long>, std::vector<std::size_t>> groups;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const Direction& wi = samples.wi[k];
        const double polar = std::atan2(std::hypot(wi.x, wi.y), wi.z);
        if (polar < oneAngle && !isotropic) continue;
        const double around = isotropic ? 0 : turnedFrom(0, std::atan2(wi.y, wi.x));
        groups[{std::lround(polar / oneAngle), std::lround(around / oneAngle)}].push_back(k);
    }
    std::vector<AngleTable> tables;
    std::vector<TableEntry> entries;
    for (const auto& group : groups) {
        const Direction& first = samples.wi[group.second.front()];
        AngleTable table{.incidence = std::atan2(std::hypot(first.x, first.y), first.z),
                         .azimuth = static_cast<double>(group.first.second) * oneAngle,
                         .aboutMirror = aboutMirror};
        entries.clear();
        for (const std::size_t k : group.second) {
            const Direction& wi = samples.wi[k];
            entries.push_back(entryOf(table, std::atan2(wi.y, wi.x), samples.wo[k], k));
        }
        // Directions in no order fill a small share of the table of all their angles.
        constexpr double leastShare = 0.25;
        if (fillTable(table, entries) < leastShare) return {};
        tables.push_back(std::move(table));
    }
    return tables;
}

}  // namespace hshfit::brdfs
