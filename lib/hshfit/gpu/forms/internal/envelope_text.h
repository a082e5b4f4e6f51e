#pragma once

#include <hshfit/gpu/forms/internal/form_text.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hshfit::gpu::inline forms {

/// The cells of the envelope as Storage::table has them: for each cell, along a first, a vector of
/// four whole numbers per four channels; each number has the four nodes of a channel at the corners
/// of the cell, 8 bits each, from the lowest on: first, along a, along b, both. Empty where there
/// is one node or none. Throws UsageError for an envelope whose numbers are not `unorm8`.
std::vector<std::uint32_t> envelopeCells(const Representation& form);

/// Whether there are any.
bool hasEnvelopeCells(const Representation& form);

/// The bilinear lookup of ln E, and the constants where there is one node: in cells where the
/// numbers are constants, else in the nodes from number `first` of the stream on.
void setEnvelope(std::size_t first, FormText& text);

}  // namespace hshfit::gpu::inline forms
