#include <hshfit/brdf/one_channel.h>

#include <hshfit/brdf/channel_view.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace hshfit::inline brdf {
namespace {

constexpr std::string_view plain = "grey:", weighted = "grey=";

}  // namespace

std::unique_ptr<Brdf> asGrey(std::unique_ptr<Brdf> brdf, std::vector<double> weights) {
    const std::size_t channels = brdf->channels().count();
    if (brdf->channels().reflectances() != channels)
        throw UsageError(fmt::format("{}: {} is no reflectance; grey means those that are",
                                     brdf->name(), brdf->channels().names().back()));
    if (weights.empty()) weights.assign(channels, 1.0);
    const bool good = std::all_of(weights.begin(), weights.end(),
                                  [](double w) { return w >= 0 && std::isfinite(w); });
    if (weights.size() != channels || !good ||
        !(*std::max_element(weights.begin(), weights.end()) > 0)) {
        throw UsageError(fmt::format(
            "{}: grey takes one weight for each of its {} channels, none below 0, not all 0",
            brdf->name(), channels));
    }
    ChannelView::Look look{.name = greyPrefixOf(weights) + brdf->name(),
                           .channels = Channels::grey(),
                           .laws = brdf->laws(),
                           .weights = {}};
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& weight : weights) weight /= sum;
    look.weights.push_back(std::move(weights));
    return std::make_unique<ChannelView>(std::move(brdf), std::move(look));
}

std::string_view greyPrefix(std::string_view spec) {
    if (spec.starts_with(plain)) return spec.substr(0, plain.size());
    if (!spec.starts_with(weighted)) return {};
    return spec.substr(0, std::min(spec.find(':'), spec.size() - 1) + 1);
}

std::vector<double> greyWeights(std::string_view prefix) {
    std::vector<double> weights;
    if (prefix == plain) return weights;
    const char *at = prefix.data() + weighted.size(), *end = prefix.data() + prefix.size();
    for (bool more = true; more;) {
        double weight = 0;
        const auto [next, status] = std::from_chars(at, end, weight);
        more = status == std::errc() && next != end && *next == '/';
        weights.push_back(weight);
        if (!more && (status != std::errc() || next == end || *next != ':')) {
            throw UsageError(fmt::format(
                "'{}': give a weight per channel and a specification, as grey=1/0/0:SPEC", prefix));
        }
        at = next + 1;
    }
    return weights;
}

std::string greyPrefixOf(const std::vector<double>& weights) {
    const bool equal = std::all_of(weights.begin(), weights.end(),
                                   [&](double weight) { return weight == weights.front(); });
    if (equal) return std::string(plain);
    return fmt::format("{}{}:", weighted, fmt::join(weights, "/"));
}

}  // namespace hshfit::inline brdf
