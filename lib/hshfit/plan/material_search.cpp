#include <hshfit/plan/internal/material_search.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/one_channel.h>
#include <hshfit/error.h>
#include <hshfit/light/light_above.h>
#include <hshfit/representation/split.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hshfit::plan {
namespace {

/// The number of bands of the light, and the level of light sampling that resolves them: 41
/// Gauss nodes are exact to degree 81.
constexpr int lightOrder = 24, lightLevel = 4;
/// Directions for which truncation is measured where the BRDF is not isotropic.
constexpr std::size_t mostFloorViews = 48;
/// The ratio of the budget to the tolerance of projections for choosing.
constexpr double projectionShare = 20;
/// Evaluations of f per direction at most, which are few because these are only for a search.
constexpr std::size_t mostEvaluations = std::size_t{1} << 22;

/// A version of one channel may take up to this share of the budget.
constexpr double oneChannelShare = 0.8;

bool lit(const Rgb& flux, std::size_t channel) {
    return flux[channel] > 1e-3 * *std::max_element(flux.begin(), flux.end());
}

std::size_t addedNumbers(const std::string& added) {
    Representation nothing;
    nothing.added = added;
    return nothing.bytes() / 4;
}

double sumOf(const std::vector<double>& values, std::size_t first = 0) {
    return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(first), values.end(), 0.0);
}

/// The first `order` bands of every channel.
std::vector<double> cut(const double* rows, std::size_t channels, std::size_t slots, int order) {
    const auto kept = static_cast<std::ptrdiff_t>(order) * order;
    std::vector<double> result;
    for (std::size_t c = 0; c < channels; ++c) {
        result.insert(result.end(), rows + c * slots, rows + c * slots + kept);
    }
    return result;
}

}  // namespace

MaterialSearch::MaterialSearch(const Scene& scene, const Material& material, const BrdfOpener& open,
                               const PlanOptions& options, const gpu::ShaderCosts* costs,
                               const TimeLimit& limit)
    : scene_(scene), open_(open), options_(options), costs_(costs), limit_(limit) {
    plan_.material = material;
    ladderOptions_ = {.bases = options.bases,
                      .maxOrder = options.maxOrder,
                      .maxBytes = scene.limits.bytes,
                      .views = scene.views};
    auto brdf = open(material.brdf);
    if (brdf->channels().kind == Channels::Kind::spectral) {
        throw UsageError(
            fmt::format("{}: material '{}' is spectral; 'rgb:{}' plans with its colour", scene.file,
                        material.name, material.brdf));
    }
    light_ = std::make_unique<MaterialLight>(scene, material, *brdf, limit.share(4));
    addVersion(material.brdf, std::move(brdf));
}

MaterialSearch::~MaterialSearch() = default;

void MaterialSearch::addVersion(std::string spec, std::unique_ptr<Brdf> brdf) {
    versions_.push_back({.spec = std::move(spec), .brdf = std::move(brdf), .parts = {}});
    addPart(versions_.back(), "");
    addPart(versions_.back(), "diffuse");
    if (!plan_.material.lobe.empty()) addPart(versions_.back(), plan_.material.lobe);
}

void MaterialSearch::addPart(Version& version, const std::string& split) {
    Part part;
    if (!split.empty()) {
        try {
            Split taken = takeOut(*version.brdf, split, open_);
            part.added = std::move(taken.added);
            part.remainder = std::move(taken.remainder);
        } catch (const NumericError&) {
            return;
        }
        if (part.added.empty()) return;
        part.addedRadiance = light_->radianceOf(*open_(part.added));
    }
    const Brdf& remainder = part.remainder ? *part.remainder : *version.brdf;
    tradeoff::KeepOptions how;
    how.projection.tolerance =
        std::max({plan_.material.budget.error / projectionShare, version.brdf->defaultTolerance(),
                  remainder.defaultTolerance()});
    how.projection.maxEvaluations = mostEvaluations;
    how.bases = ladderOptions_.bases;
    how.maxOrder = ladderOptions_.maxOrder;
    how.folder = &options_.folder;
    how.split = split;
    part.kept = std::make_unique<tradeoff::KeptProjections>(remainder, std::move(how));
    version.parts.emplace(split, std::move(part));
}

/// Adds a version of one channel if all lit channels agree within the budget.
void MaterialSearch::considerOneChannel() {
    const Version& whole = versions_.front();
    const std::size_t channels = whole.brdf->channels().count();
    if (channels == 1) {
        plan_.rules.emplace_back("the BRDF is grey: one channel for any colour of light");
        return;
    }
    const Rgb flux = light_->flux();
    std::vector<double> weights;
    for (std::size_t c = 0; c < channels; ++c) weights.push_back(lit(flux, c) ? 1 : 0);
    auto grey = asGrey(open_(whole.spec), weights);
    if (light_->errorOf(light_->radianceOf(*grey)) >
        oneChannelShare * plan_.material.budget.error) {
        return;
    }
    plan_.rules.emplace_back(
        "the channels that are lit agree within the budget: one channel was tried too");
    addVersion(greyPrefixOf(weights) + whole.spec, std::move(grey));
}

void MaterialSearch::describeLight() {
    lightBands_.assign(lightOrder, 0.0);
    const auto basis = bases::make("hsh", lightOrder);
    const LightAbove above(scene_.lights, lightLevel);
    for (const Frame& frame : light_->frames()) {
        const LightSamples samples = above.at(frame);
        const std::vector<double> power = BasisLight(*basis, Quantity::brdf, samples).bandPower();
        for (std::size_t l = 0; l < power.size(); ++l) lightBands_[l] += power[l];
    }
    const double sum = sumOf(lightBands_);
    for (double power : lightBands_) plan_.lightPower.push_back(sum > 0 ? power / sum : 0);
    const Laws& laws = versions_.front().brdf->laws();
    if (laws.isotropic) plan_.rules.emplace_back("isotropic: outgoing directions of one azimuth");
    const ViewRange& views = scene_.views;
    plan_.rules.push_back(fmt::format("only views from {:.4g}° to {:.4g}° off the normal count",
                                      degrees(views.thetaMin), degrees(views.thetaMax)));
}

int MaterialSearch::usefulOrder(double energy, const Views& views,
                                const std::vector<Radiance>& truth) const {
    double squares = 0;
    for (const Radiance& each : truth) {
        for (std::size_t v = 0; v < views.size(); ++v) {
            for (double value : each[v]) squares += views.weights[v] * value * value;
        }
    }
    for (std::size_t order = 1; order < lightBands_.size(); ++order) {
        const double change = std::sqrt(energy * sumOf(lightBands_, order) / squares);
        if (change < plan_.material.budget.error / 4) return static_cast<int>(order);
    }
    return lightOrder;
}

/// Measures truncation alone: coefficients of the views' own directions, cut at every order.
void MaterialSearch::measureFloor(Part& part, Quantity quantity) {
    const Brdf& brdf = part.kept->remainder();
    const bool isotropic = brdf.laws().isotropic;
    const Views& all = light_->views();
    std::vector<std::size_t> indices;
    const std::size_t step = isotropic ? 1 : all.size() / mostFloorViews + 1;
    for (std::size_t v = 0; v < all.size(); v += step) indices.push_back(v);
    const Views views = subset(all, indices);
    OutgoingSet set{.map = OutgoingSet::Map::parabolic, .directions = {}, .solidAngles = {}};
    if (isotropic) {
        for (double theta : all.thetas) set.directions.push_back(directionFromAngles(theta, 0));
    } else {
        set.directions = views.directions;
    }
    set.width = static_cast<int>(set.directions.size());
    set.solidAngles.assign(set.directions.size(), 0);
    for (std::size_t v = 0; v < views.size(); ++v) {
        set.solidAngles[isotropic ? views.rings[v] : v] += views.weights[v];
    }
    std::vector<Radiance> truth(light_->orientations()), radiance = truth;
    for (std::size_t o = 0; o < truth.size(); ++o) {
        for (std::size_t v : indices) truth[o].push_back(light_->truth()[o][v]);
        radiance[o].resize(views.size());
    }
    for (const Coefficients& c : part.kept->allBases(set, quantity)) {
        if (quantity == Quantity::brdf && c.energy.finite && usefulOrder_ == 0 &&
            part.added.empty()) {
            usefulOrder_ = usefulOrder(c.energy.value, views, truth);
        }
        std::vector<double>& floor = part.floor[c.basis + " " + quantityName(quantity)];
        const std::vector<BasisLight>& light = light_->in(c.basis, c.order, quantity);
        for (int order = 1; order <= c.order; ++order) {
            for (std::size_t o = 0; o < truth.size(); ++o) {
                for (std::size_t v = 0; v < views.size(); ++v) {
                    const std::size_t row = isotropic ? views.rings[v] : v;
                    const double turn = isotropic ? azimuth(views.directions[v]) : 0;
                    Rgb& sum = radiance[o][v];
                    sum = light[o].radiance(cut(c.at(row, 0), c.channels.count(), c.slots(), order),
                                            order, turn);
                    if (part.addedRadiance.empty()) continue;
                    for (std::size_t k = 0; k < 3; ++k) {
                        sum[k] += part.addedRadiance[o][indices[v]][k];
                    }
                }
            }
            floor.push_back(light::errorOf(plan_.material.budget, views, truth, radiance));
        }
    }
}

void MaterialSearch::measureFloors(Part& part) {
    for (Quantity quantity : {Quantity::brdf, Quantity::brdfCosine}) {
        try {
            measureFloor(part, quantity);
        } catch (const NumericError& error) {
            lastFailure_ = error.what();
            const std::vector<double> never(static_cast<std::size_t>(ladderOptions_.maxOrder),
                                            std::numeric_limits<double>::infinity());
            for (const std::string& basis : ladderOptions_.bases) {
                part.floor[basis + " " + quantityName(quantity)] = never;
            }
        }
    }
}

MaterialPlan MaterialSearch::run() {
    plan_.lightSamples = light_->samples();
    plan_.views = light_->views().size() * light_->orientations();
    plan_.referenceError = light_->change();
    describeLight();
    if (!light_->converged()) {
        refuse();
        return std::move(plan_);
    }
    sayFirst();
    considerOneChannel();
    std::vector<LadderSource> sources;
    for (Version& version : versions_) {
        LadderSource source{.brdf = version.brdf.get(), .splits = {}};
        for (auto& [split, part] : version.parts) {
            measureFloors(part);
            source.splits.emplace_back(split, addedNumbers(part.added));
        }
        sources.push_back(std::move(source));
    }
    if (usefulOrder_ > 0 && usefulOrder_ < ladderOptions_.maxOrder) {
        plan_.rules.push_back(
            fmt::format("smooth light: bands from {} on change radiance by less than a quarter of "
                        "the budget, so that no higher order was tried",
                        usefulOrder_));
        ladderOptions_.maxOrder = usefulOrder_;
    }
    rungs_ = ladder(sources, ladderOptions_);
    plan_.rungs = rungs_.size();
    if (options_.byTime) {
        takeFastest();
    } else {
        takeCheapest();
    }
    plan_.cut = !plan_.accepted && limit_.isOver();
    if (plan_.cut) takeLarge();
    if (!plan_.accepted) refuse();
    measureFormulas();
    return std::move(plan_);
}

void MaterialSearch::measureFormulas() {
    if (!options_.makeFormulas) return;
    const std::vector<choice::Candidate> candidates =
        options_.makeFormulas(*versions_.front().brdf, plan_.material, options_.formulas);
    if (candidates.empty()) return;
    const Budget& budget = plan_.material.budget;
    for (choice::Row& row : choice::measureRows(measurement(), candidates).rows) {
        // Without a BRDF of its own it is the material itself.
        const Brdf* const other = row.made.brdf.get();
        const double error = other ? light_->errorOf(light_->radianceOf(*other)) : 0;
        const double verified = other ? check().of(*other).error : 0;
        const bool within = std::max(error, verified) <= budget.error &&
                            (!budget.flip || row.picture.flip.mean <= *budget.flip);
        plan_.formulas.push_back(
            {.row = std::move(row), .error = error, .verified = verified, .within = within});
    }
}

}  // namespace hshfit::plan
