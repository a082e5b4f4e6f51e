#pragma once

#include "transfer.h"

#include <hshfit/files/file_set.h>
#include <hshfit/precomputed_transfer/gathering.h>
#include <hshfit/precomputed_transfer/matrix_clusters.h>

namespace hshfit::jobs {

/// Tries every number of clusters that the options name, and returns the chosen form. The errors of
/// all forms and the verdict go to `done`. Forms that are finished are kept and found again.
MatrixClusters compressed(const TransferView& view, const KeptParts& kept, const Listener& listener,
                          Transferred& done);

/// clusters.tensor.
void writeClusters(const MatrixClusters& clusters, const TransferView& view, FileSet& files);

}  // namespace hshfit::jobs
