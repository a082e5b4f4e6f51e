#pragma once

#include "fit.h"

#include <hshfit/files/atomic_file.h>

#include <memory>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The pairs at which bands are asked for: a CSV of pairs (readPairs), or plane:T[/T…], for each
/// polar angle T of incidence in degrees the outgoing directions of its plane by a degree from -89
/// to 89, those above 0 opposite of wi. Throws UsageError and InputError, also for a pair below the
/// horizon.
std::vector<DirectionPair> bandPairs(const std::string& text);

/// Evaluates the bands that the options ask for: sets Fitted::bands and a summary in the preset.
/// The CSV of FitOptions::bandsTo is complete but not yet under its name; none if it is empty.
std::unique_ptr<AtomicFile> addBands(const FitOptions& options, const Channels& channels,
                                     Fitted& fitted);

}  // namespace hshfit::jobs
