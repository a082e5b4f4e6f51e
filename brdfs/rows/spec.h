#pragma once

// The parameters of a row, and the words of specifications, under the names of this room.

#include <hshfit/specification/parameters.h>

namespace hshfit::brdfs {

using hshfit::completed;
using hshfit::editDistance;
using hshfit::FitRange;
using hshfit::joined;
using hshfit::Parameter;
using hshfit::Parameters;
using hshfit::parseParameters;
using hshfit::pathIn;
using hshfit::readParameters;
using hshfit::suggestion;
using hshfit::validValues;

}  // namespace hshfit::brdfs
