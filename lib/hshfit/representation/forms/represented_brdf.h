#pragma once

#include <hshfit/projection/projection.h>
#include <hshfit/representation/representation.h>

#include <memory>

namespace hshfit::inline representation::inline forms {

/// A representation as a BRDF, in double precision: the reference for every faster path.
/// `eval` returns f with `added`; coefficients of f cos(theta_i) are divided by cos(theta_i).
class RepresentedBrdf : public Brdf {
public:
    virtual const Representation& representation() const = 0;
};

/// `open` is called for `added` only. Throws InputError if the parts do not belong together.
std::unique_ptr<RepresentedBrdf> reconstruct(Representation representation, const BrdfOpener& open);

/// Dense coefficients per outgoing direction, as exports need them: decoded where the
/// representation is of that kind, has nothing added and `outgoing` is null or its own set;
/// otherwise the reconstructed BRDF is projected anew onto its basis (halfway: onto `basis`),
/// which truncates what is `added` as well.
struct ExpandOptions {
    const OutgoingSet* outgoing = nullptr;  ///< null: its own, or 16 elevations or 16x16
    std::string basis = "hsh";              ///< for halfway
    int order = 7;                          ///< for halfway
    ProjectionOptions projection = {};
};
Coefficients expand(const Representation& representation, const BrdfOpener& open,
                    const ExpandOptions& options = {});

}  // namespace hshfit::inline representation::inline forms
