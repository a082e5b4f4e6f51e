#pragma once

#include <hshfit/representation/representation.h>

#include <string>
#include <vector>

/// Representations with random numbers, on which a swapped or missing term changes values.
namespace hshfit::samples {

struct FormSample {
    std::string name;
    Representation form;
};

/// The halfway form with every symmetry, kind of channels, precision and mask,
/// below and above the ceilings, at orders up to 12.
std::vector<FormSample> halfwaySamples();

/// The form basis likewise.
std::vector<FormSample> basisSamples();

/// The form basis in factors, likewise.
std::vector<FormSample> factoredSamples();

}  // namespace hshfit::samples
