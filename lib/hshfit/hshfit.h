#pragma once

// The usual of the library in one header: a BRDF or a function of two directions, a basis, its
// projection, the error of that, and files of coefficients. Each of these headers can be included
// by itself, and is the manual of its part; docs/reference/library.md lists them all.

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/basis.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/brdf/directions.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/coefficients/outgoing.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/projection/one_basis.h>
#include <hshfit/projection/projection.h>
#include <hshfit/rotation/rotation.h>
#include <hshfit/version.h>

// An installation of the part `math` alone has no files.
#if __has_include(<hshfit/coefficient_files/coefficient_file.h>)
#include <hshfit/coefficient_files/coefficient_file.h>
#endif
