#include <brdfs/measured/scattered/samples.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

InputError Row::error(std::string_view message) const {
    return InputError(fmt::format("{}: {} {}: {}", where, unit, number, message));
}

void Samples::count(std::span<const double> f, const Row& row) {
    ++read;
    census.values += f.size();
    for (std::size_t c = 0; c < f.size(); ++c) {
        if (!std::isfinite(f[c])) {
            throw row.error(
                fmt::format("the value of channel {} is {}, expected a finite number of 1/sr",
                            channels.names()[c], f[c]));
        }
    }
}

void Samples::scale(double factor) {
    // The degree of polarisation is a ratio of what is scaled.
    const std::vector<std::string> names = channels.names();
    const auto scaleEach = [&](std::vector<double>& numbers) {
        for (std::size_t k = 0; k < numbers.size(); ++k)
            if (!names[k % names.size()].starts_with("dolp")) numbers[k] *= factor;
    };
    scaleEach(values);
    scaleEach(sigmas);
    if (values.empty()) return;
    const auto [least, greatest] = std::ranges::minmax_element(values);
    census.least = *least;
    census.greatest = *greatest;
}

void Samples::leaveOut(std::span<const double> f, const Row& row) {
    count(f, row);
    census.belowHorizon += f.size();
}

void Samples::add(const Direction& in, const Direction& out, std::span<const double> f,
                  const Row& row) {
    constexpr double below = -1e-6;
    if (!(in.z > below) || !(out.z > below)) return leaveOut(f, row);
    count(f, row);
    for (const double value : f) census.add(value);
    const auto lifted = [](Direction d) {
        d.z = std::max(d.z, 0.0);
        return d;
    };
    wi.push_back(lifted(in));
    wo.push_back(lifted(out));
    values.insert(values.end(), f.begin(), f.end());
    rows.insert(rows.end(), f.size(), row.number);
    order.push_back(read - 1);
}

double checkedPolarAngle(double theta, const Row& row, std::string_view field) {
    if (std::fabs(theta) <= pi / 2 + 1e-3) return theta;
    const bool inDegrees = std::fabs(theta) <= 90.1;
    throw row.error(fmt::format("{} is {}, expected radians from -pi/2 to pi/2{}", field, theta,
                                inDegrees ? " (are these degrees?)" : ""));
}

double checkedSidedAngle(double theta, const Row& row, std::string_view field) {
    if (std::fabs(theta) <= pi + 1e-3) return theta;
    const bool inDegrees = std::fabs(theta) <= 180.1;
    throw row.error(fmt::format("{} is {}, expected radians from -pi to pi{}", field, theta,
                                inDegrees ? " (are these degrees?)" : ""));
}

double checkedAzimuth(double phi, const Row& row, std::string_view field) {
    if (std::fabs(phi) <= 4 * pi + 1e-3) return phi;
    const bool inDegrees = std::fabs(phi) <= 720.1;
    throw row.error(fmt::format("{} is {}, expected radians within two turns{}", field, phi,
                                inDegrees ? " (are these degrees?)" : ""));
}

}  // namespace hshfit::brdfs
