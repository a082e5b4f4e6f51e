#include "info.h"

#include <jobs/common/shared_options.h>
#include <jobs/source/quality.h>
#include <jobs/source/source.h>

#include <hshfit/accuracy/isotropy.h>
#include <hshfit/brdf/channel_view.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/gpu/forms/form_files.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <brdfs/fit/fit_samples.h>
#include <brdfs/measured/own_samples.h>
#include <brdfs/repair.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>

namespace hshfit::jobs {
namespace {

constexpr OptionRow infoRows[] = {rgbRow(options::at<&InfoOptions::rgb>)};

/// The cost of an evaluation relative to the cost of a few lobes: sums and mixtures have a lobe
/// for every term that they add up.
std::size_t costOf(const Brdf& brdf) {
    constexpr std::size_t fewLobes = 32;
    return 1 + brdf.lobes(directionFromAngles(pi / 4, 0)).size() / fewLobes;
}

/// Every `step`-th ring of the grid, with 64 azimuths about wo's.
void widenRange(BrdfInfo& info, const Direction& wo, const HemisphereGrid& grid, std::size_t step) {
    for (const auto& panel : grid.panels) {
        for (std::size_t r = 0; r < panel.rings; ++r) {
            const std::size_t ring = panel.firstRing + r;
            if (ring % step != 0) continue;
            for (int j = 0; j < 64; ++j) {
                const double angle = azimuth(wo) + 2 * pi * (j + 0.5) / 64;
                const Direction wi{grid.sines[ring] * std::cos(angle),
                                   grid.sines[ring] * std::sin(angle), grid.elevations[ring].mu};
                for (const double f : evaluate(*info.brdf, wi, wo)) {
                    info.least = std::min(info.least, f);
                    info.greatest = std::max(info.greatest, f);
                }
            }
        }
    }
}

void findRange(BrdfInfo& info) {
    const std::size_t mostRings = std::max<std::size_t>(2048 / costOf(*info.brdf), 1);
    for (double theta : {0.0, 30.0, 60.0, 80.0}) {
        for (double phi : {0.0, 40.0, 90.0}) {
            const Direction wo = directionFromAngles(radians(theta), radians(phi));
            const HemisphereGrid grid = gridFor(info.brdf->lobes(wo), wo, {.order = 8, .level = 1});
            widenRange(info, wo, grid, 1 + grid.weights.size() / mostRings);
        }
    }
}

/// The other kind of file that a measured one looks like; empty for most.
std::string likenessOf(const Brdf& brdf) {
    for (const auto& [name, value] : brdf.facts())
        if (name == "looks_like") return std::get<std::string>(value);
    return {};
}

/// The first channels of a BRDF, which are a reflectance: laws of energy and of signs, symmetry and
/// repair are about them alone. All of them: the BRDF itself.
std::shared_ptr<const Brdf> reflectanceOf(const Brdf& brdf) {
    const std::shared_ptr<const Brdf> whole(&brdf, [](const Brdf*) {});
    const Channels& channels = brdf.channels();
    const std::size_t first = channels.reflectances();
    if (first == channels.count()) return whole;
    if (first == 0) return nullptr;
    ChannelView::Look look{
        .name = brdf.name(),
        .channels = Channels::named({channels.quantities.front()}, channels.wavelengths),
        .laws = brdf.laws(),
        .weights = {}};
    for (std::size_t c = 0; c < first; ++c) {
        look.weights.emplace_back(channels.count(), 0.0);
        look.weights.back()[c] = 1;
    }
    return std::make_shared<ChannelView>(whole, std::move(look));
}

void warn(BrdfInfo& info, const Brdf* reflectance, const std::string& likeness) {
    if (!likeness.empty()) info.warnings.push_back("the file looks like " + likeness);
    constexpr double alike = 0.01;  // the files of real materials stay below 0.001
    const bool isotropic = reflectance && reflectance->laws().isotropic;
    const double variation = isotropic ? azimuthVariation(*reflectance) : 0;
    if (variation > alike)
        info.warnings.push_back(
            fmt::format("it is taken as isotropic, but at normal incidence f varies with the "
                        "azimuth by {:.2g} % (root mean square)",
                        100 * variation));
}

Health healthOf(const Brdf& brdf, const Listener& listener) {
    HealthOptions options{.progress = listener.part("info")};
    // A search among samples takes some twenty times as long as a look into a table.
    if (!brdfs::areMeasured(brdf)) options.albedoEvaluations *= 4;
    options.albedoEvaluations /= costOf(brdf);
    return examine(brdf, options);
}

}  // namespace

OptionRows<InfoOptions> infoOptions() {
    return {infoRows};
}

BrdfInfo describeSource(const std::string& source, const InfoOptions& options,
                        const Listener& listener) {
    BrdfInfo info{.brdf = openSource(source, options.rgb, Sides::eitherAndNamed)};
    const Brdf& brdf = *info.brdf;
    if (const auto* plain = dynamic_cast<const Reconstruction*>(&brdf))
        info.coefficients = &plain->coefficients();
    if (const auto* represented = dynamic_cast<const RepresentedBrdf*>(&brdf)) {
        info.representation = &represented->representation();
        info.coefficients = &info.representation->head;
    }
    const std::shared_ptr<const Brdf> reflectance = reflectanceOf(brdf);
    if (reflectance) info.health = healthOf(*reflectance, listener);
    if (const auto* measured = dynamic_cast<const brdfs::MeasuredBrdf*>(&brdf)) {
        info.census = measured->census();
        info.axes = measured->axes();
        if (reflectance.get() == &brdf) info.bothOrders = measured->bothOrders();
        if (std::string why = whyZero(brdf); !why.empty()) info.warnings.push_back(std::move(why));
    }
    const std::string likeness = likenessOf(brdf);
    // A picture of light is not to be repaired into a BRDF.
    for (const brdfs::Repair& repair : brdfs::repairs()) {
        if (reflectance.get() != &brdf) break;  // elements of matrices are not repaired
        std::string reason = likeness.empty() ? repair.reason(brdf, *info.health) : "";
        if (!reason.empty()) info.repairs.push_back({repair.name, std::move(reason)});
    }
    if (std::string poor = poorContents(brdf); !poor.empty())
        info.warnings.push_back(std::move(poor));
    findRange(info);
    warn(info, reflectance.get(), likeness);
    info.exportedForm = gpu::readIfForm(source, sourceOpener());
    if (!info.exportedForm && gpu::looksLikePayload(source))
        info.exported = gpu::readPayload(source);
    requireReadable(brdf);  // NaN values are in the census
    return info;
}

LightInfo describeLight(const std::string& specification) {
    LightInfo info{.lights = parseLights(specification, "", InvalidPixels::zero).lights};
    info.health = examine(info.lights);
    info.warnings = remarksOf(info.lights);
    if (const auto invalid = info.health.invalid.total(); invalid > 0)
        info.warnings.push_back(
            fmt::format("{} pixels are no radiance and count as 0 here; commands "
                        "that use the light refuse it without invalid=clamp or invalid=inpaint",
                        invalid));
    return info;
}

}  // namespace hshfit::jobs
