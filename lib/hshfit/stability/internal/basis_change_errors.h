#pragma once

#include <hshfit/stability/basis_errors.h>

namespace hshfit::stability {

/// The growth of rounding through a change of basis (basis_change.h), by degree of TO: the largest
/// |(C c)_(l,m) - reference| over some m, c of length 1 with a fixed seed. Float: C made in double,
/// then C and c in single precision. The reference is the function of c in extended precision, at
/// more nodes than the change of basis takes, projected there (reference.h). Named "FROM to TO".
/// Both orders are the same.
DegreeErrors basisChangeErrors(const bases::JacobiBasis& from, const bases::JacobiBasis& to,
                               Precision precision);

}  // namespace hshfit::stability
