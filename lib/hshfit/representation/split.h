#pragma once

#include <hshfit/brdf.h>
#include <hshfit/representation/representation.h>

#include <memory>
#include <string>

namespace hshfit {

/// A BRDF in two parts: f = added + remainder.
struct Split {
    std::string added;                ///< a specification that the opener takes
    std::unique_ptr<Brdf> remainder;  ///< refers to the BRDF that was split
};

/// `what`: "diffuse", or a BRDF specification to take out.
Split takeOut(const Brdf& brdf, const std::string& what, const BrdfOpener& open);

}  // namespace hshfit
