#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <hshfit/plan/plan.h>

#include <string>

namespace hshfit::jobs {

OptionRows<plan::PlanOptions> planOptions();

/// The plan of a scene file (scene::readScene), whose files are written to a folder
/// (plan::writePlan). Materials are BRDF specifications. `options.progress` is not called: the
/// listener is. Throws UsageError, InputError and OutputError.
plan::Plan planScene(const std::string& path, const std::string& output,
                     const plan::PlanOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
