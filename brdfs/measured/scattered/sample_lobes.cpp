#include <brdfs/measured/scattered/sample_lobes.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::brdfs {
namespace {

constexpr std::size_t bins = 6;  // up to 16 degrees
constexpr double firstEdge = 0.5 * pi / 180;

/// Sums of the samples by their distance from the centre of a lobe.
struct Profile {
    std::array<double, bins> sum{}, count{};

    void add(double distance, double value) {
        double edge = firstEdge;
        for (std::size_t b = 0; b < bins; ++b, edge *= 2) {
            if (!(distance <= edge)) continue;
            sum[b] += value;
            ++count[b];
            return;
        }
    }

    double mean(std::size_t bin) const { return count[bin] > 0 ? sum[bin] / count[bin] : 0; }

    double width(double median) const {
        std::size_t peak = 0;
        for (std::size_t b = 1; b < bins; ++b)
            if (mean(b) > mean(peak)) peak = b;
        constexpr double raised = 4;
        if (!(mean(peak) > raised * median)) return 0;
        std::size_t last = peak;
        while (last + 1 < bins && (count[last + 1] == 0 || mean(last + 1) >= mean(peak) / 2))
            ++last;
        return firstEdge * std::ldexp(1.0, static_cast<int>(last));
    }
};

double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

}  // namespace

SampleLobes sampleLobes(const Samples& samples) {
    const std::size_t channels = samples.channels.count();
    std::vector<double> totals;
    Profile mirror, back;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        double total = 0;
        for (std::size_t c = 0; c < channels; ++c)
            total += std::max(0.0, samples.values[k * channels + c]);
        totals.push_back(total);
        const Direction &wi = samples.wi[k], &wo = samples.wo[k];
        const Direction sum{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
        const Direction difference{wi.x - wo.x, wi.y - wo.y, wi.z - wo.z};
        mirror.add(std::hypot(sum.x, sum.y) / std::max(sum.z, 1e-9), total);
        back.add(2 * std::atan2(std::sqrt(dot(difference, difference)), std::sqrt(dot(sum, sum))),
                 total);
    }
    const double median = medianOf(std::move(totals));
    return {.mirror = mirror.width(median), .back = back.width(median)};
}

}  // namespace hshfit::brdfs
