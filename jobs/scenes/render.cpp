#include "render.h"

#include <jobs/common/clock.h>
#include <jobs/common/inputs.h>
#include <jobs/source/quality.h>
#include <jobs/source/source.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/files/extension.h>
#include <hshfit/light/catalog.h>
#include <hshfit/meshes/mesh_file.h>
#include <hshfit/percent.h>
#include <hshfit/pictures/sphere_picture.h>
#include <hshfit/projection/projection.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/transport/possible_radiance.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

namespace hshfit::jobs {
namespace {

/// The relative error at which an order counts as enough, of coefficients and of pictures.
constexpr double enough = 0.01;

std::vector<Light> lightsOf(const RenderOptions& options, const View& view) {
    std::vector<Light> lights;
    for (const std::string& text : options.lights) {
        for (Light& light : parseLights(text).lights) lights.push_back(std::move(light));
    }
    for (const SphereLight& light : options.rig.lights) {
        const double e = pi * light.strength;
        lights.push_back(DirectionalLight{view.toWorld(light.towards), {e, e, e}});
    }
    const double dome = options.rig.dome;
    if (dome > 0) {
        lights.push_back(SkyLight{.zenith = {dome, dome, dome}, .ground = {dome, dome, dome}});
    }
    return lights;
}

SurfacePoints pointsOf(const RenderOptions& options, const View& view, Rendered& result) {
    if (options.mesh.empty()) return spherePoints(view, options.size, options.samples);
    MeshFile file = readMesh(options.mesh);
    if (options.up == RenderOptions::Up::y) turnUpright(file.mesh);
    result.mesh = options.mesh;
    result.triangles = file.mesh.triangles.size();
    result.degenerate = file.degenerate;
    return meshPoints(file.mesh, view, options.size, options.samples);
}

/// A material, its picture by integration, and its coefficients in each basis and order.
struct Material {
    std::unique_ptr<Brdf> brdf;
    std::string name = {};
    std::optional<LitPicture> truth = {};
    std::vector<Projection> projections = {};
};

/// A basis at one order: a group of columns.
using Columns = std::vector<std::unique_ptr<Basis>>;

Columns columnsOf(const RenderOptions& options) {
    Columns columns;
    if (options.by == RenderOptions::By::integration) return columns;
    for (const std::string& basis : options.bases) {
        for (const int order : options.orders) columns.push_back(bases::make(basis, order));
    }
    return columns;
}

std::vector<Projection> projectionsOf(const Brdf& brdf, const Columns& columns,
                                      const RenderOptions& options, ProgressCall progress) {
    if (columns.empty()) return {};
    std::vector<const Basis*> bases;
    for (const auto& basis : columns) bases.push_back(basis.get());
    const std::string fallback = brdf.laws().isotropic ? "64" : "48x48";
    const OutgoingSet outgoing =
        OutgoingSet::parse(options.outgoing.empty() ? fallback : options.outgoing);
    return project(brdf, bases, outgoing,
                   {.quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf,
                    .progress = std::move(progress)});
}

std::optional<double> missedBy(const Projection& projection) {
    const CoefficientHead& head = projection.coefficients;
    if (!head.energy.finite || !(head.energy.value > 0) || projection.captured.empty()) return {};
    const double captured = projection.captured[static_cast<std::size_t>(head.order - 1)];
    return std::sqrt(std::max(0.0, 1 - captured / head.energy.value));
}

/// The squares of the sheet, row by row, and what they show.
class SheetBuilder {
public:
    SheetBuilder(const RenderOptions& options, bool linear, Rendered& result)
        : options_(options), linear_(linear), result_(result) {}

    void startRow() { rows_.emplace_back(); }
    void add(RenderedPicture facts, const SpherePicture& picture) {
        facts.row = (rows_.size() - 1) * static_cast<std::size_t>(options_.size);
        for (const double exposure : options_.exposures) {
            facts.exposure = exposure;
            put(facts, picture, std::exp2(exposure));
        }
    }
    void addDifference(RenderedPicture facts, const SpherePicture& difference, double stops) {
        facts.row = (rows_.size() - 1) * static_cast<std::size_t>(options_.size);
        facts.kind = RenderedPicture::Kind::difference;
        if (linear_) {
            put(facts, difference, 1);
            return;
        }
        facts.amplification = amplificationFor(difference, stops);
        put(facts, amplified(difference, facts.amplification), 1);
    }
    Sheet sheet() const { return {rows_.begin(), rows_.end()}; }

private:
    void put(RenderedPicture& facts, SpherePicture picture, double factor) {
        facts.column = rows_.back().size() * static_cast<std::size_t>(options_.size);
        if (factor != 1) {
            for (float& value : picture.radiance) value = static_cast<float>(factor * value);
        }
        rows_.back().push_back(std::move(picture));
        result_.pictures.push_back(facts);
    }

    const RenderOptions& options_;
    bool linear_;
    Rendered& result_;
    std::vector<std::vector<SpherePicture>> rows_;
};

/// Tells the listener about values left out, integrals cut short and pictures far off.
void remark(const RenderedPicture& picture, std::size_t points, const Listener& listener) {
    if (picture.notFinite > 0) {
        listener.say(fmt::format("{}: {} values that are not finite were left out", picture.brdf,
                                 picture.notFinite));
    }
    if (picture.cut > 0) {
        listener.say(
            fmt::format("{}: the integral was cut short at {} of {} points; the estimated "
                        "error is {:.2g} %",
                        picture.brdf, picture.cut, points, 100 * picture.error));
    }
    if (picture.early > 0) {
        listener.say(fmt::format(
            "{}: the time was over before {} of {} points kept to the bound; the "
            "estimated error is {:.2g} %, of a pixel at most {:.2g} %",
            picture.brdf, picture.early, points, 100 * picture.error, 100 * picture.largest.error));
    }
    if (picture.difference && picture.difference->relativeL2 > enough && picture.missed &&
        *picture.missed <= enough) {
        listener.say(
            fmt::format("{}: the picture by {} of order {} is {:.2g} % off, although the "
                        "coefficients are within {:.2g} % of f",
                        picture.brdf, picture.basis, picture.order,
                        100 * picture.difference->relativeL2, 100 * *picture.missed));
    }
}

bool holdsCoefficients(const std::string& spec, const Brdf& brdf) {
    return looksLikeCoefficients(spec) || dynamic_cast<const Reconstruction*>(&brdf) != nullptr ||
           dynamic_cast<const RepresentedBrdf*>(&brdf) != nullptr;
}

/// Tells the listener that integration of a file of coefficients is of their own sum.
void remarkOwnSum(const Material& material, const RenderOptions& options,
                  const Listener& listener) {
    if (options.by != RenderOptions::By::both || !holdsCoefficients(material.name, *material.brdf))
        return;
    listener.say(
        fmt::format("{0}: both pictures show the sum of its coefficients, the second one projected "
                    "again; to see what it loses of {1}, render {1} {0}",
                    material.name, material.brdf->name()));
}

/// Tells the listener about a pane that shows no light: all of it falls on the viewer's side.
void remarkBlack(const Brdf& brdf, const SpherePicture& picture, const RenderOptions& options,
                 const Listener& listener) {
    constexpr double most = 0.8;
    if (!transmits(brdf)) return;
    std::size_t shown = 0, black = 0;
    for (std::size_t pixel = 0; pixel < picture.coverage.size(); ++pixel) {
        if (!(picture.coverage[pixel] > 0)) continue;
        const auto first = picture.radiance.begin() + static_cast<std::ptrdiff_t>(3 * pixel);
        ++shown;
        if (std::all_of(first, first + 3, [](float value) { return value == 0; })) ++black;
    }
    const double share = static_cast<double>(black) / static_cast<double>(shown);
    if (shown == 0 || share < most) return;
    const std::string opposite =
        fmt::format("{},{}", 180 - options.view.theta, std::fmod(options.view.phi + 180, 360));
    listener.say(
        fmt::format("{}: {} of the pane is black: it shows light from behind it, and here light "
                    "and viewer are on one side; give a light behind it, or {}",
                    brdf.name(), percent(share, 3), Setting{"RenderOptions::view", opposite}));
}

std::map<std::string, std::string> attributesOf(const Rendered& rendered) {
    std::map<std::string, std::string> attributes;
    for (const RenderedPicture& picture : rendered.pictures) {
        std::string text = fmt::format("{}, {}", picture.brdf, kindName(picture.kind));
        if (!picture.basis.empty()) text += fmt::format(", {} {}", picture.basis, picture.order);
        if (picture.exposure != 0) text += fmt::format(", {:+g} stops", picture.exposure);
        attributes[fmt::format("hshfit:picture_{}_{}", picture.row, picture.column)] = text;
    }
    return attributes;
}

/// Tells the listener once, after a while, how to end an integration that takes long.
class SlowNote {
public:
    SlowNote(std::string brdf, const RenderOptions& options, const Listener& listener)
        : brdf_(std::move(brdf)), options_(options), listener_(listener) {}

    void update(std::size_t done, std::size_t total) {
        const double seconds = secondsSince(start_);
        if (said_ || seconds < slowSeconds) return;
        const std::string text = slowRemark(brdf_, seconds, done, total, options_);
        if (!text.empty() && !said_.exchange(true)) listener_.say(text);
    }

private:
    const std::string brdf_;
    const RenderOptions& options_;
    const Listener& listener_;
    const Clock::time_point start_ = Clock::now();
    std::atomic<bool> said_ = false;
};

/// The steps of `render`, in order, with the points and lights that all materials share.
class Renderer {
public:
    Renderer(const RenderOptions& options, const Listener& listener, Rendered& result)
        : options_(options),
          listener_(listener),
          limit_(options.seconds),
          view_(radians(options.view.theta), radians(options.view.phi),
                radians(options.fieldOfView)),
          columns_(columnsOf(options)),
          lights_(lightsOf(options, view_)),
          points_(pointsOf(options, view_, result)) {
        result.points = points_.count();
        if (options.by != RenderOptions::By::coefficients) light_.emplace(lights_, options.bound());
    }

    void open(const std::vector<std::string>& specs) {
        for (const std::string& spec : specs) {
            materials_.push_back({.brdf = openSource(spec, /*rgb=*/true, Sides::either)});
            materials_.back().name = shownName(spec, *materials_.back().brdf);
            remarkOwnSum(materials_.back(), options_, listener_);
            remarkContents(materials_.back().name, *materials_.back().brdf, listener_);
            const Brdf &first = *materials_.front().brdf, &last = *materials_.back().brdf;
            if (transmits(first) != transmits(last))
                throw UsageError(
                    fmt::format("{} and {}: a sheet shows reflections, or panes with the lights "
                                "behind them; render a sheet of each",
                                first.name(), last.name()));
        }
    }

    void light() {
        for (Material& material : materials_) {
            const std::string& name = material.name;
            if (light_) {
                SlowNote slow(name, options_, listener_);
                const auto steps = [&slow, shown = listener_.part(name)](std::size_t done,
                                                                         std::size_t total) {
                    if (shown) shown(done, total);
                    slow.update(done, total);
                };
                material.truth =
                    renderByIntegration(*material.brdf, points_, view_, *light_,
                                        {.tolerance = options_.bound()}, steps, limitOf(material));
                check(material, material.truth->picture, 0);
            }
            material.projections = projectionsOf(*material.brdf, columns_, options_,
                                                 listener_.part("project " + name));
            material.brdf->checkIntact();
        }
        for (std::size_t k = 0; k < columns_.size(); ++k) {
            std::vector<const Coefficients*> all;
            for (const Material& m : materials_) all.push_back(&m.projections[k].coefficients);
            const std::string part =
                fmt::format("{} {}", columns_[k]->name(), columns_[k]->order());
            byCoefficients_.push_back(renderByCoefficients(
                all, points_, view_, lights_,
                {.tolerance = options_.bound() / 2, .progress = listener_.part(part)}));
            // A series of few terms is beyond the largest value at places.
            for (std::size_t m = 0; m < materials_.size(); ++m)
                check(materials_[m], byCoefficients_.back()[m].picture, 1);
        }
    }

    double automaticStops() const {
        std::vector<SpherePicture> shown;
        for (std::size_t m = 0; m < materials_.size(); ++m) {
            if (materials_[m].truth)
                shown.push_back(materials_[m].truth->picture);
            else
                shown.push_back(byCoefficients_.front()[m].picture);
        }
        return automaticExposure(shown);
    }

    void fill(SheetBuilder& sheet, double stops) const {
        for (std::size_t m = 0; m < materials_.size(); ++m) {
            const Material& material = materials_[m];
            const std::string& name = material.name;
            sheet.startRow();
            if (material.truth) {
                RenderedPicture facts{.brdf = name,
                                      .basis = {},
                                      .error = material.truth->error,
                                      .largest = material.truth->largest,
                                      .evaluations = material.truth->evaluations,
                                      .cut = material.truth->cut,
                                      .early = material.truth->early,
                                      .notFinite = material.truth->picture.notFinite};
                remark(facts, points_.count(), listener_);
                sheet.add(facts, material.truth->picture);
            }
            remarkBlack(
                *material.brdf,
                material.truth ? material.truth->picture : byCoefficients_.front()[m].picture,
                options_, listener_);
            for (std::size_t k = 0; k < columns_.size(); ++k) {
                const LitPicture& lit = byCoefficients_[k][m];
                RenderedPicture facts{.kind = RenderedPicture::Kind::coefficients,
                                      .brdf = name,
                                      .basis = columns_[k]->name(),
                                      .order = columns_[k]->order(),
                                      .error = lit.error,
                                      .missed = missedBy(material.projections[k])};
                if (material.truth) {
                    facts.difference = differenceOf(material.truth->picture, lit.picture);
                }
                remark(facts, points_.count(), listener_);
                sheet.add(facts, lit.picture);
                if (material.truth) {
                    sheet.addDifference(
                        facts, sphereDifference(material.truth->picture, lit.picture), stops);
                }
            }
        }
    }

private:
    /// Materials share the time that is left evenly.
    TimeLimit limitOf(const Material& material) const {
        return limit_.share(static_cast<double>(&materials_.back() - &material + 1));
    }
    void check(const Material& material, const SpherePicture& picture, int samples) const {
        requirePossible({.name = "the picture of " + material.name,
                         .width = picture.size,
                         .radiance = picture.radiance,
                         .samples = samples},
                        *material.brdf, lights_);
    }

    const RenderOptions& options_;
    const Listener& listener_;
    const TimeLimit limit_;
    const View view_;
    const Columns columns_;
    const std::vector<Light> lights_;
    const SurfacePoints points_;
    std::optional<DirectIntegral> light_;  ///< unless by coefficients alone
    std::vector<Material> materials_;
    std::vector<std::vector<LitPicture>> byCoefficients_;  ///< [column][material]
};

}  // namespace

std::string shownName(const std::string& spec, const Brdf& brdf) {
    return holdsCoefficients(spec, brdf) || spec.starts_with("preset:") ? spec : brdf.name();
}

void remarkContents(const std::string& name, const Brdf& brdf, const Listener& listener) {
    for (const std::string& remark : {poorContents(brdf), unmeasuredContents(brdf)})
        if (!remark.empty()) listener.say(name + ": " + remark);
}

std::string kindName(RenderedPicture::Kind kind) {
    switch (kind) {
        case RenderedPicture::Kind::integration:
            return "integration";
        case RenderedPicture::Kind::coefficients:
            return "coefficients";
        default:
            return "difference";
    }
}

std::string slowRemark(const std::string& brdf, double seconds, std::size_t done, std::size_t total,
                       const RenderOptions& options) {
    if (options.seconds || done == 0 || done >= total) return {};
    const double left = seconds * static_cast<double>(total - done) / static_cast<double>(done);
    if (left < slowSeconds) return {};
    return fmt::format(
        "{}: integration has taken {:.0f} s and needs some {:.0f} s more; {} above "
        "{:g} or {} ends it sooner",
        brdf, seconds, left, Setting{"RenderOptions::tolerance"}, options.bound(),
        Setting{"RenderOptions::seconds"});
}

Rendered render(const std::vector<std::string>& specs, const std::string& output,
                const RenderOptions& options, const Listener& listener) {
    checkSpheresPath(output);
    if (options.seconds && options.by == RenderOptions::By::coefficients)
        throw UsageError(fmt::format("{} bounds the time of integration, and goes with {}",
                                     Setting{"RenderOptions::seconds"},
                                     Setting{"RenderOptions::by", "integration"}));
    Rendered result;
    Renderer renderer(options, listener, result);
    renderer.open(expandInputs(specs, Members::both));
    AtomicFile file(output);
    renderer.light();
    result.stops = options.exposure ? *options.exposure : renderer.automaticStops();
    SheetBuilder sheet(options, extensionOf(output) == ".exr", result);
    renderer.fill(sheet, result.stops);
    writeSheet(sheet.sheet(), result.stops, file, attributesOf(result));
    file.commit();
    return result;
}

}  // namespace hshfit::jobs
