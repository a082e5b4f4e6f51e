#include <hshfit/pages/axis_ticks.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline pages {
namespace {

std::string withMinus(std::string number) {
    if (number.starts_with('-')) number.replace(0, 1, "−");
    return number;
}

}  // namespace

std::array<int, 2> decadesOf(double least, double most, int decades) {
    const int high = std::clamp(static_cast<int>(std::ceil(std::log10(most) - 1e-9)), -290, 300);
    const int low = static_cast<int>(std::floor(std::log10(least) + 1e-9));
    return {std::clamp(low, high - decades, high - 1), high};
}

double roundedUp(double value) {
    const double power = std::pow(10, std::floor(std::log10(value)));
    for (const double digit : {1.0, 1.2, 1.6, 2.0, 2.4, 3.0, 4.0, 6.0, 8.0}) {
        if (value <= digit * power * (1 + 1e-9)) return digit * power;
    }
    return 10 * power;
}

std::vector<AxisTick> linearTicks(double low, double high, int most) {
    const double least = (high - low) / std::max(most, 1);
    const double power = std::pow(10, std::floor(std::log10(least)));
    double step = 10 * power;
    for (const double digit : {5.0, 2.5, 2.0, 1.0})
        if (digit * power >= least * (1 - 1e-9)) step = digit * power;
    std::vector<AxisTick> ticks;
    const double slack = 1e-6 * step;
    for (double k = std::ceil((low - slack) / step); k * step <= high + slack; ++k)
        ticks.push_back({k * step, withMinus(k == 0 ? "0" : fmt::format("{:.6g}", k * step))});
    return ticks;
}

std::vector<AxisTick> logTicks(int low, int high, int most) {
    const int every = std::max(1, (high - low + most) / std::max(most, 1));
    const bool plain = low >= -3 && high <= 4;
    std::vector<AxisTick> ticks;
    for (int power = low; power <= high; ++power) {
        const double decade = std::pow(10, power);
        if ((high - power) % every == 0)
            ticks.push_back({decade, plain ? fmt::format("{:g}", decade)
                                           : withMinus(fmt::format("{}", power))});
        else
            ticks.push_back({decade, "", true});
        if (!plain && !ticks.back().minor) ticks.back().label = "10^{" + ticks.back().label + "}";
        for (int digit = 2; digit < 10 && power < high && high - low <= 6; ++digit)
            ticks.push_back({digit * decade, "", true});
    }
    return ticks;
}

}  // namespace hshfit::inline pages
