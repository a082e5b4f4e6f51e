#include <hshfit/representation/halfway/internal/halfway_lobe.h>

#include <hshfit/representation/halfway/internal/halfway_albedo.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <vector>

namespace hshfit::inline representation::inline halfway {
namespace {

constexpr std::size_t isotropicPairs = 3 << 14, anisotropicPairs = 3 << 16, pairsPerTerm = 24;
constexpr double floorOfAlbedo = 1e-3;
/// f of no albedo at all has a floor too.
constexpr double leastFloor = 1e-30;
/// The orders that lobes are tried with, and the steps.
constexpr HalfwayOrders few{9, 7, 5};
constexpr int trialSteps = 8;
constexpr std::array widths{0.9, 0.5, 0.25, 0.12, 0.06, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4};
constexpr double finer = 1.4;
/// The share of the least loss that the other masking has to be below.
constexpr double clearly = 0.5;
/// A masked lobe is GGX's BRDF where the shelf is 0.
constexpr std::array shelves{0.05, 0.01, 0.002}, maskedShelves{0.05, 0.002, 2e-4};
constexpr std::array ratios{1.5, 2.5, 4.0, 7.0, 12.0};
constexpr int turns = 8;
/// The factor by which widths of lobes that are tried with all terms differ at least.
constexpr double otherWidth = 1.5;
/// The factors by which each of two widths is changed in the end.
constexpr std::array refinements{1.2, 1.07};

double inSingle(double value) {
    return static_cast<double>(static_cast<float>(value));
}

HalfwayLobe lobeOf(double width, double ratio, double turn, double shelf, bool masked) {
    const auto held = [](double w) { return inSingle(std::clamp(w, 2e-5, 0.89)); };
    const double root = std::sqrt(ratio);
    return {held(width * root), held(width / root), inSingle(turn), inSingle(shelf), masked};
}

double widthOf(const HalfwayLobe& lobe) {
    return std::sqrt(lobe.along * lobe.across);
}

/// Lobes with the ratio and the turn of one, its width times each factor, and each shelf.
std::vector<HalfwayLobe> about(const HalfwayLobe& lobe, std::initializer_list<double> factors,
                               bool masked) {
    const double width = widthOf(lobe), ratio = lobe.along / lobe.across;
    std::vector<HalfwayLobe> lobes;
    for (const double factor : factors) {
        for (const double shelf : masked ? maskedShelves : shelves) {
            // The lobe itself has been tried.
            if (factor == 1 && masked == lobe.masked && inSingle(shelf) == lobe.shelf) continue;
            lobes.push_back(lobeOf(width * factor, ratio, lobe.turn, shelf, masked));
        }
    }
    return lobes;
}

/// The lobes about one whose widths are each by a step wider, as they are, or narrower.
std::vector<HalfwayLobe> besides(const HalfwayLobe& lobe, double step) {
    const double width = widthOf(lobe), ratio = lobe.along / lobe.across;
    std::vector<HalfwayLobe> lobes;
    for (const double along : {step, 1.0, 1 / step}) {
        for (const double across : {step, 1.0, 1 / step}) {
            if (along == 1 && across == 1) continue;
            lobes.push_back(lobeOf(width * std::sqrt(along * across), ratio * along / across,
                                   lobe.turn, lobe.shelf, lobe.masked));
        }
    }
    return lobes;
}

/// The best of some lobes.
class Trials {
public:
    Trials(const HalfwaySamples& grey, const HalfwayTerms& terms, double floor)
        : grey_(grey), terms_(terms), floor_(floor) {}

    /// A lobe whose loss is below `share` of the least so far takes its place.
    void add(const std::vector<HalfwayLobe>& lobes, double share = 1) {
        const std::size_t before = all_.size();
        all_.resize(before + lobes.size());
        tbb::parallel_for(std::size_t{0}, lobes.size(),
                          [&](std::size_t k) { all_[before + k] = fit(lobes[k]); });
        const auto least = std::ranges::min_element(
            all_.begin() + static_cast<std::ptrdiff_t>(before), all_.end(), {}, &LobeFound::loss);
        if (before == 0 || least->loss < share * best().loss)
            best_ = static_cast<std::size_t>(least - all_.begin());
    }
    const LobeFound& best() const { return all_[best_]; }

    /// The best, and after it the best of other widths.
    std::vector<LobeFound> bestOfWidths(std::size_t count) const {
        std::vector<LobeFound> chosen{best()};
        while (chosen.size() < count) {
            const LobeFound* next = nullptr;
            for (const LobeFound& one : all_) {
                const bool other = std::ranges::all_of(chosen, [&](const LobeFound& before) {
                    const double ratio = widthOf(one.lobe) / widthOf(before.lobe);
                    return std::max(ratio, 1 / ratio) > otherWidth;
                });
                if (other && (!next || one.loss < next->loss)) next = &one;
            }
            if (!next) break;
            chosen.push_back(*next);
        }
        return chosen;
    }

private:
    LobeFound fit(const HalfwayLobe& lobe) const {
        const HalfwayAxes axes(lobe);
        const HalfwayModel model{terms_, axes, floor_};
        HalfwayErrors errors(model, {grey_, nullptr, roughHuber});
        HalfwayValues values = descended(errors, halfwayStart(model, grey_), trialSteps);
        errors.countSquaresUpTo(fineHuber);
        values = descended(errors, std::move(values), trialSteps);
        const double loss = errors.losses(values).front();
        return {lobe, terms_.orders(), std::move(values), loss};
    }

    const HalfwaySamples& grey_;
    const HalfwayTerms& terms_;
    double floor_;
    std::vector<LobeFound> all_;
    std::size_t best_ = 0;
};

/// sin(theta_h) where f about the mirror direction has fallen to half between its peak and its
/// base, in the medians of the samples by powers of ten; 1 where there is no peak.
double halfWidth(const HalfwaySamples& grey) {
    constexpr int perDecade = 5, decades = 4;
    std::array<std::vector<double>, perDecade * decades> bins;
    for (std::size_t k = 0; k < grey.size(); ++k) {
        if (grey.spread[k] != HalfwaySpread::mirror) continue;
        const auto& [wi, wo] = grey.pairs[k];
        const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
        const double across = x * x + y * y;
        const double decade = decades + 0.5 * std::log10(across / (across + z * z) + 1e-30);
        const auto bin = static_cast<std::ptrdiff_t>(std::floor(decade * perDecade));
        bins[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(bin, 0, std::ssize(bins) - 1))]
            .push_back(grey.values[k]);
    }
    double peak = 0, base = 0;
    for (auto& bin : bins) {
        if (bin.empty()) bin.push_back(base);
        std::ranges::nth_element(bin, bin.begin() + std::ssize(bin) / 2);
        base = bin[bin.size() / 2];
        peak = std::max(peak, base);
    }
    if (peak < 1.5 * base) return 1;
    for (std::size_t b = bins.size(); b-- > 0;) {
        if (bins[b][bins[b].size() / 2] > (peak + base) / 2)
            return std::pow(10, (static_cast<double>(b) + 1) / perDecade - decades);
    }
    return 1;
}

}  // namespace

double halfwayFloor(const HalfwayAlbedo& albedo) {
    return std::max(leastFloor, floorOfAlbedo * albedo.greatestMean());
}

std::size_t halfwayPairsFor(const HalfwayTerms& terms, bool isotropic) {
    return std::max(isotropic ? isotropicPairs : anisotropicPairs, pairsPerTerm * terms.size());
}

std::vector<LobeFound> chooseLobes(const HalfwaySamples& grey, const HalfwayOrders& orders,
                                   const HalfwaySymmetry& symmetry, double floor) {
    const HalfwayOrders smaller{std::min(orders.half, few.half),
                                std::min(orders.difference, few.difference),
                                std::min(orders.azimuth, few.azimuth)};
    const HalfwayTerms terms(smaller, symmetry);
    Trials trials(grey, terms, floor);
    std::vector<HalfwayLobe> tried;
    // Masking depends on the azimuth, which nothing else does where h is the normal.
    const bool masked = !symmetry.isotropic;
    const double shelf = masked ? maskedShelves[1] : shelves[0];
    const double least = halfWidth(grey);
    for (const double width : widths) {
        if (width >= least || tried.empty()) tried.push_back(lobeOf(width, 1, 0, shelf, masked));
    }
    trials.add(tried);
    if (!symmetry.isotropic) {
        const double width = trials.best().lobe.along;
        tried.clear();
        for (const double ratio : ratios) {
            for (int n = 0; n < (symmetry.bilateral ? 2 : turns); ++n) {
                const double turn = symmetry.bilateral ? 0 : pi * n / turns;
                const double along = symmetry.bilateral && n == 1 ? 1 / ratio : ratio;
                tried.push_back(lobeOf(width, along, turn, shelf, masked));
            }
        }
        trials.add(tried);
    }
    trials.add(about(trials.best().lobe, {finer, 1.0, 1 / finer}, masked));
    // On files the loss differs by a twentieth, and masking is brighter towards the horizon.
    trials.add(about(trials.best().lobe, {1.0}, !masked), clearly);
    if (!symmetry.isotropic) {
        for (const double step : refinements) trials.add(besides(trials.best().lobe, step));
    }
    return trials.bestOfWidths(mostLobes);
}

HalfwayValues startFrom(const LobeFound& found, const HalfwayModel& model,
                        const HalfwaySamples& samples, const HalfwaySymmetry& symmetry) {
    const HalfwayTerms few(found.orders, symmetry);
    const std::size_t channels = samples.channels();
    HalfwayValues values = HalfwayValues::Zero(static_cast<Eigen::Index>(model.terms.size()),
                                               static_cast<Eigen::Index>(channels));
    for (std::size_t t = 0; t < few.size(); ++t) {
        const auto place = std::ranges::find(model.terms.list(), few.list()[t]);
        values.row(place - model.terms.list().begin())
            .setConstant(found.values(static_cast<Eigen::Index>(t), 0));
    }
    // Each channel in the median of its ratios to what the mean channel has.
    const std::vector<double> now = halfwayAt(model, samples.pairs, values);
    for (std::size_t c = 0; c < channels; ++c) {
        std::vector<double> ratios;
        for (std::size_t k = c; k < now.size(); k += channels) {
            // A ratio of two floors says nothing.
            if (std::max(samples.values[k], now[k]) > model.floor)
                ratios.push_back((samples.values[k] + 1e-2 * model.floor) / (now[k] + model.floor));
        }
        if (ratios.empty()) continue;
        const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
        std::nth_element(ratios.begin(), middle, ratios.end());
        const double shift = std::log(*middle);
        const auto column = static_cast<Eigen::Index>(c);
        values(0, column) += shift;
        values(static_cast<Eigen::Index>(model.terms.smooth()), column) += shift;
    }
    return values;
}

}  // namespace hshfit::inline representation::inline halfway
