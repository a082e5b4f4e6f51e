#include <hshfit/pages/print_figure.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::inline pages {

std::size_t channelInk(Channels::Kind kind, std::size_t place) {
    constexpr std::size_t red = 1, yellow = 2, blue = 0;
    constexpr std::array rgb{red, yellow, blue};
    return kind == Channels::Kind::rgb ? rgb[place % rgb.size()] : place;
}

PrintAxis linearAxis(double low, double high, const std::string& label, int ticks) {
    return {label, low, high, PrintAxis::Scale::linear, linearTicks(low, high, ticks)};
}

PrintAxis axisOf(const std::vector<double>& values, FigureAxis scale, const std::string& label) {
    constexpr double spanOfLinear = 30;
    constexpr int mostDecades = 6;
    double least = HUGE_VAL, most = 0, lowest = 0;
    for (const double value : values) {
        if (!std::isfinite(value)) continue;
        lowest = std::min(lowest, value);
        if (!(value > 0)) continue;
        least = std::min(least, value);
        most = std::max(most, value);
    }
    if (!(most > 0)) {
        const double low = lowest < 0 ? -roundedUp(-lowest) : 0;
        return linearAxis(low, low < 0 ? 0 : 1, label);
    }
    const bool logarithmic = scale == FigureAxis::logarithmic ||
                             (scale == FigureAxis::automatic && most > spanOfLinear * least);
    if (!logarithmic)
        return linearAxis(lowest < 0 ? -roundedUp(-lowest) : 0, roundedUp(most), label);
    const auto [low, high] = decadesOf(least, most, mostDecades);
    return {label, std::pow(10, low), std::pow(10, high), PrintAxis::Scale::logarithmic,
            logTicks(low, high, 4)};
}

}  // namespace hshfit::inline pages
