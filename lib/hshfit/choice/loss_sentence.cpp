#include <hshfit/choice/rows.h>

#include <hshfit/brdf/directions.h>
#include <hshfit/percent.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace hshfit::choice {
namespace {

/// A loss, and by how many times it is above what is just seen.
struct Loss {
    double weight = 0;
    std::string text;
};

// Differences that are just seen. A Lambert surface that is 5 % too bright has CIEDE2000 0.90, and
// a difference of 1 between patches side by side is just seen (docs/explanation/picture_error.md).
constexpr double seenColour = 1, seenAlbedo = 0.05, seenExtremum = 0.03, seenRidge = 0.1,
                 seenRim = 0.2, seenFlip = 0.03;
constexpr std::size_t shown = 3;

std::size_t farthest(const std::vector<double>& shares) {
    const auto at = std::ranges::max_element(
        shares, [](double a, double b) { return std::abs(a) < std::abs(b); });
    return static_cast<std::size_t>(at - shares.begin());
}

std::string brightness(double share, const std::string& channel) {
    return fmt::format("{} too {}{}", percentOrTimes(std::abs(share)),
                       share < 0 ? "dark" : "bright", channel == "grey" ? "" : " in " + channel);
}

std::string angleOf(const SeenDifference& difference) {
    return fmt::format("{:.0f} degrees", degrees(polarAngle(difference.at.wo)));
}

}  // namespace

std::string lossSentence(const PictureError& error) {
    std::vector<Loss> losses;
    const auto add = [&](double weight, const std::string& text) {
        if (weight >= 1) losses.push_back({weight, text});
    };
    const std::size_t most = farthest(error.albedo), last = farthest(error.lastAlbedo);
    add(std::abs(error.albedo[most]) / seenAlbedo,
        brightness(error.albedo[most], error.channels[most]));
    add(error.dip.value / seenExtremum, fmt::format("a false dip of {} in the highlight at {}",
                                                    shareText(error.dip), angleOf(error.dip)));
    add(error.peak.value / seenExtremum, fmt::format("a false peak of {} in the highlight at {}",
                                                     shareText(error.peak), angleOf(error.peak)));
    add(error.ridge.value / seenRidge, fmt::format("the mirror direction off by {} at {}",
                                                   shareText(error.ridge), angleOf(error.ridge)));
    add(error.colour.mean / seenColour,
        fmt::format("colours off by CIEDE2000 {}, most under the {}",
                    significant(error.colour.mean), error.colour.light));
    add(std::abs(error.lastAlbedo[last]) / seenRim,
        "the rim " + brightness(error.lastAlbedo[last], error.channels[last]));
    std::ranges::stable_sort(losses, std::greater{}, &Loss::weight);
    if (losses.size() > shown) losses.resize(shown);
    if (losses.empty()) {
        if (error.flip.mean < seenFlip) return "nothing that is seen";
        return fmt::format("little, most under the {}", error.flip.light);
    }
    std::vector<std::string> texts;
    for (const Loss& loss : losses) texts.push_back(loss.text);
    return fmt::format("{}", fmt::join(texts, "; "));
}

}  // namespace hshfit::choice
