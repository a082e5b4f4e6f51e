#pragma once

#include "illuminate.h"

namespace hshfit::jobs {

/// The options with the samples of the method, and with all settings of a cache in `cache`. Throws
/// UsageError for those that contradict each other.
IlluminateOptions settled(IlluminateOptions options);

}  // namespace hshfit::jobs
