#include <hshfit/brdf/one_channel.h>

#include <hshfit/brdf/channel_view.h>
#include <hshfit/brdf/kink_curve.h>
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

class OneChannel final : public Brdf, public HasKinkCurves, public ChannelView {
public:
    OneChannel(std::unique_ptr<Brdf> brdf, std::vector<double> weights)
        : brdf_(std::move(brdf)),
          name_(greyPrefixOf(weights) + brdf_->name()),
          weights_(std::move(weights)) {
        const double sum = std::accumulate(weights_.begin(), weights_.end(), 0.0);
        for (double& weight : weights_) weight /= sum;
    }

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return brdf_->laws(); }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        std::vector<double> values(weights_.size() * wi.count);
        brdf_->eval(wo, wi, values.data());
        for (std::size_t k = 0; k < wi.count; ++k) {
            out[k] = 0;
            for (std::size_t c = 0; c < weights_.size(); ++c) {
                out[k] += weights_[c] * values[c * wi.count + k];
            }
        }
    }
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override {
        brdf_->coverage(wo, wi, covered);
    }
    std::vector<Lobe> lobes(const Direction& wo) const override { return brdf_->lobes(wo); }
    std::vector<double> kinks(const Direction& wo) const override { return brdf_->kinks(wo); }
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return kinkCurvesOf(*brdf_, wo);
    }
    double defaultTolerance() const override { return brdf_->defaultTolerance(); }
    std::vector<Fact> facts() const override { return brdf_->facts(); }
    void checkIntact() const override { brdf_->checkIntact(); }

    const Brdf& seen() const override { return *brdf_; }
    void convert(std::span<const double> from, std::span<double> to) const override {
        to[0] = 0;
        for (std::size_t c = 0; c < from.size(); ++c) to[0] += weights_[c] * from[c];
    }

private:
    std::unique_ptr<Brdf> brdf_;
    std::string name_;
    std::vector<double> weights_;  ///< their sum is 1
    Channels channels_ = Channels::grey();
};

}  // namespace

std::unique_ptr<Brdf> asGrey(std::unique_ptr<Brdf> brdf, std::vector<double> weights) {
    const std::size_t channels = brdf->channels().count();
    if (weights.empty()) weights.assign(channels, 1.0);
    const bool good = std::all_of(weights.begin(), weights.end(),
                                  [](double w) { return w >= 0 && std::isfinite(w); });
    if (weights.size() != channels || !good ||
        !(*std::max_element(weights.begin(), weights.end()) > 0)) {
        throw UsageError(fmt::format(
            "{}: grey takes one weight for each of its {} channels, none below 0, not all 0",
            brdf->name(), channels));
    }
    return std::make_unique<OneChannel>(std::move(brdf), std::move(weights));
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
