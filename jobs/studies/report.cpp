#include "report.h"

#include <jobs/source/quality.h>
#include <jobs/source/source.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/wavelets/slices.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace hshfit::jobs {
namespace {

/// The chosen bases at the largest order that each of them has.
std::vector<std::unique_ptr<Basis>> makeBases(const ReportOptions& options) {
    std::vector<std::unique_ptr<Basis>> made;
    for (const bases::Entry* entry : bases::select(options.bases)) {
        made.push_back(bases::make(entry->name, std::min(options.maxOrder, entry->maxOrder)));
    }
    return made;
}

std::vector<const Basis*> pointersTo(const std::vector<std::unique_ptr<Basis>>& bases) {
    std::vector<const Basis*> pointers;
    for (const auto& basis : bases) pointers.push_back(basis.get());
    return pointers;
}

/// Empty projections of a BRDF whose coefficients do not exist or did not converge.
std::vector<Projection> withoutNumbers(const Brdf& brdf, std::span<const Basis* const> bases,
                                       const OutgoingSet& outgoing, Quantity quantity,
                                       const std::string& reason) {
    std::vector<Projection> projections(bases.size());
    for (std::size_t b = 0; b < bases.size(); ++b) {
        Coefficients& c = projections[b].coefficients;
        c.basis = bases[b]->name();
        c.order = bases[b]->order();
        c.quantity = quantity;
        c.channels = brdf.channels();
        c.outgoing = outgoing;
        c.source = brdf.name();
        c.energy.finite = false;
        c.energy.reason = reason;
        c.energy.value = c.energy.error = c.error = std::numeric_limits<double>::quiet_NaN();
        projections[b].captured.assign(bases[b]->order(), c.energy.value);
    }
    return projections;
}

/// Adds the curve of spherical wavelets, relative to the same energy as the projections' curves.
void addWavelets(ReportEntry& entry, const Brdf& brdf, int maxOrder) {
    std::optional<wavelets::SliceCurve> slices;
    if (entry.energy.finite) {
        slices = wavelets::sliceCurve(brdf, entry.outgoing,
                                      static_cast<std::size_t>(maxOrder) * maxOrder,
                                      {.quantity = entry.quantity});
        entry.evaluations += slices->evaluations;
    }
    entry.curves.push_back(waveletCurve(slices ? &*slices : nullptr, entry.energy, maxOrder));
}

ReportEntry entryOf(const Brdf& brdf, std::span<const Basis* const> bases,
                    const ReportOptions& options, const ProgressCall& progress) {
    const OutgoingSet outgoing = outgoingOrDefault(options.outgoing, brdf);
    const Quantity quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf;
    std::vector<Projection> projections;
    try {
        projections =
            hshfit::project(brdf, bases, outgoing,
                            {.quantity = quantity,
                             .tolerance = options.tolerance,
                             .maxEvaluations = static_cast<std::size_t>(options.maxEvaluations),
                             .progress = progress});
    } catch (const NumericError& error) {
        projections = withoutNumbers(brdf, bases, outgoing, quantity, error.what());
    }
    ReportEntry entry = reportEntry(projections);
    // Orders below the default are left out on purpose, and nothing is advised against them.
    if (entry.energy.finite && !suffices(entry) && options.maxOrder >= ReportOptions{}.maxOrder)
        entry.better = betterCall(projections.front().coefficients, brdf, "OUT.json");
    if (options.wavelets) addWavelets(entry, brdf, options.maxOrder);
    return entry;
}

}  // namespace

Reported report(const std::vector<std::string>& specs, const ReportOptions& options,
                const Listener& listener) {
    const auto bases = makeBases(options);
    const auto pointers = pointersTo(bases);

    Reported result;
    result.specs = expandInputs(specs);
    if (result.specs.empty()) return result;
    std::vector<ReportEntry>& found = result.report.reports;
    if (!areMany(specs)) {
        const std::string& spec = result.specs.front();
        found.push_back(entryOf(*openBrdf(spec, options.rgb, Sides::eitherAndNamed), pointers,
                                options, listener.part(spec)));
        return result;
    }
    std::vector<std::optional<ReportEntry>> entries(result.specs.size());
    result.failures = forEachInput(
        result.specs, listener, "report", [&](std::size_t i, const ProgressCall& progress) {
            entries[i] = entryOf(*openBrdf(result.specs[i], options.rgb, Sides::eitherAndNamed),
                                 pointers, options, progress);
        });
    for (auto& entry : entries)
        if (entry) found.push_back(std::move(*entry));
    return result;
}

ReportEntry reportOf(const Brdf& brdf, const ReportOptions& options, const Listener& listener) {
    const auto bases = makeBases(options);
    return entryOf(brdf, pointersTo(bases), options, listener.part(brdf.name()));
}

}  // namespace hshfit::jobs
