#include "command.h"
#include "command_rows.h"
#include "job_options.h"
#include "measured_numbers.h"

#include <hshfit/error.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/pages/report.h>

#include <jobs/studies/report.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

namespace hshfit::cli {
namespace {

struct ReportArguments {
    std::vector<std::string> specs;
    std::string output;
    jobs::ReportOptions options;
};

/// The energy, and for each basis the order that captures 99 % of it.
std::string summary(const ReportEntry& entry) {
    if (!entry.energy.finite) {
        return fmt::format("{}: no energy: {}\n", entry.brdf, entry.energy.reason);
    }
    std::string text =
        fmt::format("{} ({}, outgoing {}): energy {}\n", entry.brdf, quantityName(entry.quantity),
                    entry.outgoing.spec(), withError(entry.energy.value, entry.energy.error));
    for (const ReportCurve& curve : entry.curves) {
        const ReportPoint& last = curve.points.back();
        if (!last.accuracy) {
            text += fmt::format("  {:<16} {}\n", curve.basis, noCapturedEnergy);
            continue;
        }
        const auto reached = firstReaching(curve, 0.99);
        text += fmt::format("  {:<16} {:.6f} at order {:<3} ({} coefficients); 99 %: {}\n",
                            curve.bestTerms ? curve.basis + ", best k" : curve.basis,
                            *last.accuracy, last.order, last.coefficients,
                            reached ? fmt::format("{} coefficients (order {})",
                                                  reached->coefficients, reached->order)
                                    : fmt::format("more than {}", last.coefficients));
        // The square root of the missing energy is the error in L2.
        if (const auto within = firstReaching(curve, 0.9999); within && !curve.bestTerms) {
            text.pop_back();
            text += fmt::format("; within 1 %: order {}\n", within->order);
        }
    }
    if (!entry.better.empty())
        text +=
            fmt::format("  no basis captures 90 % over solid angle; to try: {}\n", entry.better);
    return text;
}

void runReport(const ReportArguments& arguments, Globals& globals) {
    const jobs::Reported reported =
        jobs::report(arguments.specs, arguments.options, listenerFor(globals));
    const Report& report = reported.report;
    for (const ReportEntry& entry : report.reports) {
        if (entry.energy.finite && entry.energy.value > 0) continue;
        endWithoutNumbers(globals,
                          entry.energy.finite
                              ? fmt::format("{}: {}: it is 0", entry.brdf, noCapturedEnergy)
                              : fmt::format("{}: {}", entry.brdf, entry.energy.reason));
    }
    const bool any = !report.reports.empty();
    stateExitCode(reported.failures.empty() ? globals.exitCode
                                            : static_cast<int>(jobs::codeOf(reported.failures)));
    if (any && !arguments.output.empty()) writeReport(report, arguments.output);
    if (any && globals.json) {
        printText(reportJson(report));
    } else if (any) {
        std::string text;
        for (const ReportEntry& entry : report.reports) text += summary(entry);
        if (!arguments.output.empty())
            text += fmt::format(
                "written to {}: report.html, curves.svg, curves.pdf, curves.csv, "
                "curves.gp, report.json\n",
                arguments.output);
        printText(text);
    }
    reportFailures(reported.failures, reported.specs.size(), globals);
}

constexpr ArgumentRow reportArguments[] = {
    required("SPEC", at<&ReportArguments::specs>,
             "One or more BRDFs; of a folder, the measured files in it", brdfRead),
    optionalOutput(at<&ReportArguments::output>,
                   "Folder for pages and figures, made if absent; without it, the table alone",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows reportRows() {
    return {reportArguments, {jobs::reportOptions().rows}};
}

void addReport(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ReportArguments>();
    addArguments(command, reportArguments, *arguments);
    addOptions(command, jobs::reportOptions(), arguments->options);
    command.callback([arguments, &globals] { runReport(*arguments, globals); });
}

}  // namespace hshfit::cli
