#include "command.h"
#include "inputs.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/pages/report.h>
#include <hshfit/projection/projection.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <limits>
#include <memory>
#include <optional>

namespace hshfit::cli {
namespace {

struct ReportOptions {
    std::vector<std::string> specs;
    std::string output, bases = "all", outgoing;
    int maxOrder = 12;
    bool cosine = false, rgb = false;
    double tolerance = 0;
    double maxEvaluations = static_cast<double>(ProjectionOptions{}.maxEvaluations);
};

/// The chosen bases at the largest order that each of them has.
std::vector<std::unique_ptr<Basis>> makeBases(const ReportOptions& options) {
    std::vector<std::unique_ptr<Basis>> made;
    for (const bases::Entry* entry : bases::select(options.bases)) {
        made.push_back(bases::make(entry->name, std::min(options.maxOrder, entry->maxOrder)));
    }
    return made;
}

/// What a report says of a BRDF whose coefficients do not exist or did not converge.
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

std::vector<Projection> projectFor(const std::string& spec, std::span<const Basis* const> bases,
                                   const ReportOptions& options, const ProgressCall& progress) {
    const auto brdf = openBrdf(spec, options.rgb);
    const OutgoingSet outgoing = outgoingOrDefault(options.outgoing, *brdf);
    const Quantity quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf;
    try {
        return project(*brdf, bases, outgoing,
                       {.quantity = quantity,
                        .tolerance = options.tolerance,
                        .maxEvaluations = static_cast<std::size_t>(options.maxEvaluations),
                        .progress = progress});
    } catch (const NumericError& error) {
        return withoutNumbers(*brdf, bases, outgoing, quantity, error.what());
    }
}

/// Order needed for 99 % of the energy, per basis: the figure that people ask for first.
std::string summary(const ReportEntry& entry) {
    if (!entry.energy.finite) {
        return fmt::format("{}: no energy: {}\n", entry.brdf, entry.energy.reason);
    }
    std::string text = fmt::format("{} ({}, outgoing {}): energy {:.8g} +- {:.1e}\n", entry.brdf,
                                   quantityName(entry.quantity), entry.outgoing.spec(),
                                   entry.energy.value, entry.energy.error);
    for (const ReportCurve& curve : entry.curves) {
        const ReportPoint& last = curve.points.back();
        const auto reached = firstReaching(curve, 0.99);
        text += fmt::format(
            "  {:<16} {:.6f} at order {:<3} ({} coefficients); 99 %: {}\n", curve.basis,
            last.accuracy.value_or(std::numeric_limits<double>::quiet_NaN()), last.order,
            last.coefficients,
            reached
                ? fmt::format("{} coefficients (order {})", reached->coefficients, reached->order)
                : fmt::format("more than {}", last.coefficients));
    }
    return text;
}

/// The entries of all inputs, in their order. Of a single one, an error ends the command.
Report gather(const std::vector<std::string>& specs, std::span<const Basis* const> bases,
              const ReportOptions& options, const Globals& globals,
              std::vector<InputFailure>& failures) {
    Report report;
    if (!areMany(options.specs)) {
        Progress progress(globals, specs[0]);
        report.reports.push_back(
            reportEntry(projectFor(specs[0], bases, options, progress.callback())));
        return report;
    }
    std::vector<std::optional<ReportEntry>> entries(specs.size());
    failures =
        forEachInput(specs, globals, "report", [&](std::size_t i, const ProgressCall& progress) {
            entries[i] = reportEntry(projectFor(specs[i], bases, options, progress));
        });
    for (auto& entry : entries)
        if (entry) report.reports.push_back(std::move(*entry));
    return report;
}

void runReport(const ReportOptions& options, Globals& globals) {
    if (options.output.empty() && !globals.json) {
        throw UsageError("report: give -o DIR for the report's files, or --json");
    }
    const auto bases = makeBases(options);
    std::vector<const Basis*> pointers;
    for (const auto& basis : bases) pointers.push_back(basis.get());

    std::vector<InputFailure> failures;
    const std::vector<std::string> specs = expandInputs(options.specs);
    const Report report = gather(specs, pointers, options, globals, failures);
    for (const ReportEntry& entry : report.reports) {
        if (entry.energy.finite) continue;
        globals.exitCode = static_cast<int>(ExitCode::numeric);
        note(globals, fmt::format("{}: {}", entry.brdf, entry.energy.reason));
    }
    const bool any = !report.reports.empty();
    if (any && !options.output.empty()) writeReport(report, options.output);
    if (any && globals.json) {
        printText(reportJson(report));
    } else if (any) {
        std::string text;
        for (const ReportEntry& entry : report.reports) text += summary(entry);
        printText(text +
                  fmt::format("written to {}: report.html, curves.svg, curves.pdf, curves.csv, "
                              "curves.gp, report.json\n",
                              options.output));
    }
    reportFailures(failures, specs.size(), globals);
}

}  // namespace

void addReport(CLI::App& command, Globals& globals) {
    auto options = std::make_shared<ReportOptions>();
    command
        .add_option("SPEC", options->specs,
                    "One or more BRDFs; of a folder, the measured files in it")
        ->required();
    command.add_option("-o,--output", options->output, "Folder to write, made if absent");
    command.add_option("--bases", options->bases, "all, or names from hshfit list bases")
        ->capture_default_str();
    command.add_option("--max-order", options->maxOrder, "Orders 1 to this one")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command.add_option("--outgoing", options->outgoing,
                       "WxH, N or THETA,PHI in degrees (default: 16, or 16x16 if anisotropic)");
    addRgb(command, options->rgb);
    command.add_flag("--cosine", options->cosine, "Report f cos(theta_i) instead of f");
    command
        .add_option("--tolerance", options->tolerance,
                    "Relative agreement of two quadrature levels (default: 1e-6, tables 3e-3)")
        ->check(CLI::Range(1e-13, 1.0));
    command
        .add_option("--max-evaluations", options->maxEvaluations,
                    "BRDF evaluations per outgoing direction before giving up")
        ->check(CLI::Range(1e3, 1e12))
        ->capture_default_str();
    command.callback([options, &globals] { runReport(*options, globals); });
}

}  // namespace hshfit::cli
