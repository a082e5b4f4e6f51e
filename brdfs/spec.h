#pragma once

#include <brdfs/catalog.h>

namespace hshfit::brdfs {

using hshfit::completed;
using hshfit::editDistance;
using hshfit::joined;
using hshfit::parseParameters;
using hshfit::pathIn;
using hshfit::readParameters;
using hshfit::suggestion;
using hshfit::validValues;

}  // namespace hshfit::brdfs
