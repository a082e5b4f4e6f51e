#pragma once

#include <brdfs/fit/instrument/instrument_problem.h>

#include <brdfs/fit/fit_options.h>
#include <brdfs/fit/fit_result.h>

#include <vector>

namespace hshfit::brdfs {

/// Describes the minimum x of a problem: parameters of material and instrument with their errors,
/// correlations, sets that the data do not tell apart, and the study that was asked for.
///
/// The scales of scans follow the other parameters. Priors of scales and zeros count as values of
/// chi-square and as known errors in the sandwich. By scan, errors of the other parameters are CR3
/// with the scan's scale and zeros eliminated; errors of a scale or zero add its own variance, for
/// which the errors of its samples are taken as independent. The bootstrap of scans and profiles
/// are about all but scales.
void describeReadings(const InstrumentProblem& problem, const std::vector<double>& x,
                      const FitOptions& options, FitResult& result);

}  // namespace hshfit::brdfs
