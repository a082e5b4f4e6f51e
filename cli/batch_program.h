#pragma once

#include <jobs/batches/program.h>

namespace hshfit::cli {

/// This program as the one whose command lines are the items of a batch.
jobs::BatchProgram batchProgram();

}  // namespace hshfit::cli
