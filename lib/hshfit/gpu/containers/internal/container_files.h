#pragma once

#include <hshfit/gpu/containers/containers.h>

namespace hshfit::gpu::inline containers {

// The rows of the table, each in a source file of its own.
const Container& binContainer();
const Container& exrContainer();
const Container& exrPartsContainer();
const Container& ktx2Container();
const Container& ddsContainer();
const Container& jsContainer();
const Container& headerContainer();
const Container& tensorContainer();

}  // namespace hshfit::gpu::inline containers
