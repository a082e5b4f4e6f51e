#pragma once

#include <brdfs/analytic/term_brdf.h>
#include <hshfit/brdf/directions.h>

namespace hshfit::brdfs {

template <class N>
struct EonShape {
    N roughness;
    bool exact;
    N single, scale;
};

}  // namespace hshfit::brdfs
