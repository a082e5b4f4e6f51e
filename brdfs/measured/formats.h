#pragma once

#include <brdfs/catalog.h>

namespace hshfit::brdfs {

// The rows of the measured formats in the table of brdfs/catalog.cpp.
const Format& merlFormat();
const Format& rglFormat();

}  // namespace hshfit::brdfs
