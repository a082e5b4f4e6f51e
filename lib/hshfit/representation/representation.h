#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/representation/content.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline representation {

/// A step that changed coefficients, and its cost: the relative change, in L2 over both
/// hemispheres, of the projected quantity between before and after.
struct RepresentationStep {
    std::string what;  ///< "window lanczos", "rank 4", "keep 120", "unorm8", …
    double change = 0;
};

/// The numbers of functions of the halfway form along the half vector, the difference vector and
/// the elevations; see halfway_terms.h. All 0 where none are asked for: halfwayOrdersOr.
struct HalfwayOrders {
    int half = 0, difference = 0, azimuth = 0;
};

/// One way to keep a BRDF, as a coefficient file holds it.
///
/// outgoing  q(wi, wo) = sum_i c_i(wo) B_i(wi), c kept per outgoing direction and interpolated.
///           CoefficientArray or CoefficientFactors, with the slots of `slots`
/// basis     q(wi, wo) = sum_t c_t P_t(wi, wo): both directions in one basis (the "two successive
///           transformations" of Gautron et al. 2004); terms as in basis_matrix.h.
///           MatrixArray or MatrixFactors
/// halfway   a smooth part and a lobe about the half vector, two exponentials; see halfway.h.
///           HalfwayArray
///
/// The BRDF of the specification `added`, if any, is added to f exactly.
struct Representation {
    enum class Kind { outgoing, basis, halfway };

    /// `outgoing` is empty unless the kind is `outgoing`; `quantity` is brdf for halfway.
    CoefficientHead head;
    std::vector<int> slots;  ///< the stored slots, ascending (kind outgoing)
    HalfwayOrders halfway = {};
    std::string added;
    Content content;
    std::vector<RepresentationStep> steps = {};

    Kind kind() const;  ///< of the content
    /// The content where it is a `Form`, one of the members of `Content`; nullptr otherwise.
    template <class Form>
    const Form* as() const {
        return std::get_if<Form>(&content);
    }
    template <class Form>
    Form* as() {
        return std::get_if<Form>(&content);
    }

    /// Length of all arrays as packed, plus four bytes for each number in `added` and, of the
    /// halfway form, for the widths of its lobe and its ceilings. Names, shapes and provenance are
    /// not counted, as in the sizes that others publish.
    std::size_t bytes() const;
    /// The same after Zstandard.
    std::size_t entropyBytes() const;
    /// The count of stored numbers.
    std::size_t numbers() const;
};

std::string_view kindName(Representation::Kind kind);  ///< "outgoing", "basis", "halfway"

/// Opens a BRDF specification; the library itself knows no models.
using BrdfOpener = std::function<std::unique_ptr<Brdf>(const std::string& spec)>;

/// Coefficients, unchanged, in the form outgoing. Slots that are 0 everywhere are left out.
Representation fromCoefficients(const Coefficients& coefficients);

/// The coefficients that kind outgoing decodes to (without `added`). Products of factors are
/// multiplied out. UsageError for another kind: `expand` (represented_brdf.h) projects those.
Coefficients decoded(const Representation& representation);

}  // namespace hshfit::inline representation
