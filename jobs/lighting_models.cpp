#include "lighting_models.h"

#include <brdfs/fit/ltc_lobe.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/lighting/lobe_nodes.h>
#include <hshfit/specification/parameters.h>

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <functional>

namespace hshfit::jobs {
namespace {

using Kind = LightingModel::Kind;

constexpr std::array lightingTable{
    LightingModel{Kind::coefficients, "coefficients",
                  "harmonics of f cos by elevation against rotated coefficients of light"},
    LightingModel{Kind::splitSum, "split-sum",
                  "light convolved with the BRDF's own lobe in levels of a cube map, scaled by "
                  "elevation; irradiance in nine coefficients"},
    LightingModel{Kind::cosines, "ltc",
                  "linearly transformed cosines of the BRDF for polygons of light"},
};

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

double secondsOf(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::span<const LightingModel> lightingModels() {
    return lightingTable;
}

std::vector<const LightingModel*> selectLightingModels(std::string_view names) {
    std::vector<std::string_view> known;
    for (const LightingModel& model : lightingTable) known.push_back(model.name);
    std::vector<bool> wanted(lightingTable.size(), names == "all");
    for (std::size_t from = 0; names != "all" && from <= names.size();) {
        const std::size_t to = std::min(names.find(',', from), names.size());
        const std::string_view name = names.substr(from, to - from);
        bool found = false;
        for (std::size_t k = 0; k < lightingTable.size(); ++k) {
            if (lightingTable[k].name != name) continue;
            wanted[k] = found = true;
        }
        if (!found)
            throw UsageError(fmt::format("unknown model of lighting '{}'{}; known: all, {}", name,
                                         suggestion(name, known), joined(known)));
        from = to + 1;
    }
    std::vector<const LightingModel*> models;
    for (std::size_t k = 0; k < lightingTable.size(); ++k)
        if (wanted[k]) models.push_back(&lightingTable[k]);
    return models;
}

namespace {

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

}  // namespace

lighting::CosineTable fitCosineTable(const Brdf& brdf, lighting::ElevationRows rows) {
    lighting::requireIsotropic(brdf);
    std::vector<lighting::LobeNodes> nodes;
    for (std::size_t k = 0; k < rows.count; ++k)
        nodes.push_back(
            lighting::lobeNodes(brdf, directionFromAngles(std::acos(rows.cosine(k)), 0), 2));
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

std::size_t LightingTables::bytes(Kind kind) const {
    switch (kind) {
        case Kind::coefficients:
            return harmonics->bytes();
        case Kind::splitSum:
            return splitSum->bytes();
        case Kind::cosines:
            break;
    }
    return cosines->bytes();
}

LightingTables fitLightingTables(const Brdf& brdf, std::span<const LightingModel* const> models,
                                 const LightingTableOptions& options) {
    const lighting::ElevationRows rows{.count = options.rows};
    if (options.rows < 2 || options.rows > 1024)
        throw UsageError(fmt::format("{} elevations: from 2 to 1024 are possible", options.rows));
    LightingTables tables;
    for (const LightingModel* model : models) {
        tables.seconds[static_cast<int>(model->kind)] = secondsOf([&] {
            if (model->kind == Kind::coefficients)
                tables.harmonics = lighting::fitHarmonics(brdf, options.order, rows);
            else if (model->kind == Kind::splitSum)
                tables.splitSum = lighting::fitSplitSum(brdf, rows);
            else
                tables.cosines = fitCosineTable(brdf, rows);
        });
    }
    return tables;
}

std::size_t LightingEnvironment::bytes(Kind kind) const {
    constexpr std::size_t single = 4, half = 2;
    switch (kind) {
        case Kind::coefficients:
            return harmonics->light().size() * 3 * single;
        case Kind::splitSum:
            return cube.texels() * 4 * half + 9 * 3 * single;
        case Kind::cosines:
            break;
    }
    return areas.size() * 5 * 3 * single;
}

LightingEnvironment lightFor(const LightingTables& tables, std::span<const Light> lights,
                             const LightingTableOptions& options) {
    LightingEnvironment result;
    if (tables.harmonics) {
        result.seconds[0] = secondsOf([&] {
            result.harmonics = std::make_shared<lighting::HarmonicShading>(
                *tables.harmonics,
                projectLight(lights, *bases::make("sh", tables.harmonics->order)));
        });
    }
    if (tables.splitSum) {
        result.seconds[1] = secondsOf([&] {
            result.cube = lighting::prefilter(*tables.splitSum, lights, options.face);
            result.irradiance = lighting::irradianceNine(lights);
        });
    }
    if (tables.cosines)
        result.seconds[2] =
            secondsOf([&] { result.areas = lighting::areaLights(lights, options.tiles); });
    return result;
}

lighting::Shading shadingOf(Kind kind, const LightingTables& tables,
                            const LightingEnvironment& light) {
    if (kind == Kind::coefficients) {
        return [&light](const Direction& normal, const Direction& viewer) {
            return light.harmonics->radiance(normal, viewer);
        };
    }
    if (kind == Kind::splitSum) {
        return [&](const Direction& normal, const Direction& viewer) {
            return lighting::radiance(*tables.splitSum, light.cube, light.irradiance, normal,
                                      viewer);
        };
    }
    return [&](const Direction& normal, const Direction& viewer) {
        return lighting::radiance(*tables.cosines, light.areas, normal, viewer);
    };
}

}  // namespace hshfit::jobs
