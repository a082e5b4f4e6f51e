#include "lighting_cosines.h"

#include <brdfs/fit/askew_ltc.h>
#include <brdfs/fit/ltc_lobe.h>
#include <hshfit/lighting/lobe_nodes.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace hshfit::jobs {
namespace {

/// The lobe above its even part, as grey: the mean of the channels, at least 0.
class LobeRest final : public Brdf {
public:
    LobeRest(const Brdf& whole, const Rgb& even) : whole_(whole) {
        for (const double part : even) level_ += part / pi / 3;
        laws_ = whole.laws();
    }
    std::string name() const override { return whole_.name(); }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    std::vector<Lobe> lobes(const Direction& wo) const override { return whole_.lobes(wo); }
    std::vector<double> kinks(const Direction& wo) const override { return whole_.kinks(wo); }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        const std::size_t count = whole_.channels().count();
        std::vector<double> values(count * wi.count);
        whole_.eval(wo, wi, values.data());
        for (std::size_t k = 0; k < wi.count; ++k) {
            double sum = 0;
            for (std::size_t c = 0; c < count; ++c) sum += values[c * wi.count + k];
            const double rest = sum / static_cast<double>(count) - level_;
            out[k] = wi.z[k] > 0 ? std::max(0.0, rest) : 0;
        }
    }

private:
    const Brdf& whole_;
    double level_ = 0;
    Laws laws_;
    Channels channels_ = Channels::grey();
};

/// A lobe with the mean direction and about the width of the rest.
brdfs::Ltc startOf(const lighting::LobeSummary& lobe) {
    const double width = std::acos(std::min(lobe.meanCosine, 1 - 1e-8)) * 0.8;
    return brdfs::turned({.a = 1, .c = 0, .b = 0, .d = std::max(width, 1e-4)},
                         std::atan2(lobe.axis.x, lobe.axis.z));
}

/// The better of fits from the lobe's first moment and from the row before.
struct CosineFit {
    lighting::CosineRow row;
    brdfs::Ltc ltc = {};
    double misplaced = 0;
    bool any = false;  ///< there is something above the even part
};
CosineFit fitCosine(const Brdf& brdf, const lighting::LobeNodes& nodes, double evenShare,
                    const std::optional<brdfs::Ltc>& before) {
    const lighting::LobeSummary lobe = lighting::summarise(nodes, evenShare);
    CosineFit fit{.row = {.even = lobe.even, .rest = lobe.rest}};
    if (lobe.meanCosine >= 1) return fit;
    fit.any = true;
    const LobeRest rest(brdf, lobe.even);
    const brdfs::LtcFitOptions how{.symmetric = nodes.wo.x < 1e-6};
    brdfs::LtcLobe best = brdfs::fitLtc(rest, nodes.wo, startOf(lobe), how);
    if (before) {
        const brdfs::LtcLobe other = brdfs::fitLtc(rest, nodes.wo, *before, how);
        if (other.error < best.error) best = other;
    }
    fit.ltc = best.ltc;
    fit.row.lobe = {.a = best.ltc.a, .b = best.ltc.b, .c = best.ltc.c, .d = best.ltc.d};
    const double share = fit.row.lobe.share();
    fit.misplaced = lighting::misplaced(
        nodes, lobe, [&](const Direction& d) { return best.ltc.density(d) / share; });
    return fit;
}

/// The one of evenShares that misplaces the least light, over some rows.
double chooseEvenShare(const Brdf& brdf, std::span<const lighting::LobeNodes> nodes) {
    double best = 0, least = HUGE_VAL;
    for (const double share : lighting::evenShares) {
        double sum = 0;
        for (const std::size_t k : {nodes.size() / 4, nodes.size() / 2, 3 * nodes.size() / 4})
            sum += fitCosine(brdf, nodes[k], share, {}).misplaced;
        if (sum >= least) continue;
        least = sum;
        best = share;
    }
    return best;
}

/// The table of a BRDF whose lobes are their own mirror images.
lighting::CosineTable planeTable(const Brdf& brdf, lighting::ElevationRows rows) {
    std::vector<lighting::LobeNodes> nodes;
    for (std::size_t k = 0; k < rows.count; ++k)
        nodes.push_back(lighting::viewNodes(brdf, rows.cosine(k), 0, 2));
    const double share = chooseEvenShare(brdf, nodes);
    std::vector<lighting::CosineRow> result;
    std::optional<brdfs::Ltc> before;
    for (std::size_t k = 0; k < rows.count; ++k) {
        if (before && k > 0)
            before =
                brdfs::turned(*before, std::acos(rows.cosine(k - 1)) - std::acos(rows.cosine(k)));
        const CosineFit fit = fitCosine(brdf, nodes[k], share, before);
        if (fit.any) before = fit.ltc;
        result.push_back(fit.row);
    }
    return lighting::cosineTable(result);
}

// Lobes that are not their own mirror image.

/// f cos above the even part as grey, at the nodes that are there.
brdfs::LobeSamples samplesOf(const lighting::LobeNodes& all, const Rgb& even) {
    constexpr std::size_t most = 16384;
    const lighting::LobeNodes nodes = lighting::thinned(all, most);
    brdfs::LobeSamples samples;
    for (std::size_t k = 0; k < nodes.count(); ++k) {
        if (!(nodes.z[k] > 0)) continue;
        const double f = nodes.f[0][k] + nodes.f[1][k] + nodes.f[2][k];
        const double rest = (f - (even[0] + even[1] + even[2]) / pi) / 3;
        samples.wi.push_back({nodes.x[k], nodes.y[k], nodes.z[k]});
        samples.weights.push_back(nodes.weights[k]);
        samples.values.push_back(std::max(0.0, rest) * nodes.z[k]);
    }
    return samples;
}

/// A lobe with the mean direction of the rest, about its mean width, and its widths' ratio.
brdfs::AskewLtc askewStart(const lighting::LobeNodes& nodes, const lighting::LobeSummary& lobe) {
    const double width = std::max(std::acos(std::min(lobe.meanCosine, 1 - 1e-8)) * 0.8, 1e-4);
    const lighting::LobeSpread spread = lighting::spreadOf(nodes, lobe);
    const double ratio =
        std::pow(std::max(spread.narrowest(), 1e-6) / std::max(spread.widest(), 1e-6), 0.25);
    const lighting::AcrossAxis across(lobe.axis);
    const Direction wide = across.at(spread.angle()), narrow = across.at(spread.angle() + pi / 2);
    const auto times = [](double factor, const Direction& d) {
        return std::array{factor * d.x, factor * d.y, factor * d.z};
    };
    return {times(ratio, wide), times(1 / ratio, narrow), times(width, lobe.axis)};
}

struct AskewRow {
    lighting::CosineRow row;
    std::optional<brdfs::AskewLtc> w = {};
    double misplaced = 0;
};
AskewRow fitAskewRow(const lighting::LobeNodes& nodes, double evenShare,
                     const std::optional<brdfs::AskewLtc>& before) {
    const lighting::LobeSummary lobe = lighting::summarise(nodes, evenShare);
    AskewRow result{.row = {.even = lobe.even, .rest = lobe.rest}};
    if (lobe.meanCosine >= 1) return result;
    const brdfs::LobeSamples samples = samplesOf(nodes, lobe.even);
    brdfs::AskewFit best = brdfs::fitAskewLtc(samples, askewStart(nodes, lobe));
    if (before) {
        const brdfs::AskewFit other = brdfs::fitAskewLtc(samples, *before);
        if (other.error < best.error) best = other;
    }
    result.w = best.w;
    const brdfs::AskewLtc& w = best.w;
    result.row.lobe = {.a = w[0][0],
                       .b = w[0][2],
                       .c = w[2][0],
                       .d = w[2][2],
                       .e = w[1][0],
                       .f = w[1][2],
                       .g = w[2][1]};
    const double share = result.row.lobe.share();
    result.misplaced = lighting::misplaced(
        nodes, lobe, [&](const Direction& d) { return brdfs::density(w, d) / share; });
    return result;
}

/// As chooseEvenShare, over nodes of a few elevations and azimuths.
double chooseAskewShare(const Brdf& brdf, lighting::ElevationRows rows,
                        const lighting::AzimuthNodes& azimuths) {
    std::vector<lighting::LobeNodes> nodes;
    for (const std::size_t k : {rows.count / 4, rows.count / 2, 3 * rows.count / 4})
        for (const std::size_t around : {std::size_t{0}, azimuths.count / 3})
            nodes.push_back(lighting::viewNodes(brdf, rows.cosine(k), azimuths.angle(around), 2));
    double best = 0, least = HUGE_VAL;
    for (const double share : lighting::evenShares) {
        double sum = 0;
        for (const lighting::LobeNodes& lobe : nodes) sum += fitAskewRow(lobe, share, {}).misplaced;
        if (sum >= least) continue;
        least = sum;
        best = share;
    }
    return best;
}

lighting::CosineTable askewTable(const Brdf& brdf, lighting::ElevationRows rows,
                                 const lighting::AzimuthNodes& azimuths) {
    const double share = chooseAskewShare(brdf, rows, azimuths);
    std::vector<lighting::CosineRow> result(rows.count * azimuths.count);
    tbb::parallel_for(std::size_t{0}, azimuths.count, [&](std::size_t around) {
        std::optional<brdfs::AskewLtc> before;
        for (std::size_t k = 0; k < rows.count; ++k) {
            if (before && k > 0)
                before = brdfs::turnedAboutY(
                    *before, std::acos(rows.cosine(k - 1)) - std::acos(rows.cosine(k)));
            const AskewRow fit =
                fitAskewRow(lighting::viewNodes(brdf, rows.cosine(k), azimuths.angle(around), 2),
                            share, before);
            if (fit.w) before = fit.w;
            result[around * rows.count + k] = fit.row;
        }
    });
    return lighting::cosineTable(result, azimuths, false);
}

}  // namespace

lighting::CosineTable fitCosineTable(const Brdf& brdf, lighting::ElevationRows rows,
                                     std::size_t azimuthSteps) {
    if (lighting::lobesInPlane(brdf.laws())) return planeTable(brdf, rows);
    return askewTable(brdf, rows, lighting::AzimuthNodes(brdf.laws(), azimuthSteps));
}

}  // namespace hshfit::jobs
