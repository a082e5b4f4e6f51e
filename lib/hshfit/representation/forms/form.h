#pragma once

#include <hshfit/projection/projection.h>
#include <hshfit/representation/constraints/constraints.h>
#include <hshfit/representation/representation.h>
#include <hshfit/wording.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline representation::inline forms {

/// "outgoing", "basis" or "halfway"; "H,D,A" for the orders. Both throw UsageError.
Representation::Kind parseKind(std::string_view name);
HalfwayOrders parseHalfway(std::string_view text);

/// Everything that may be asked of a representation, applied in the order of the members, from
/// `split` on.
struct Form {
    Representation::Kind kind = Representation::Kind::outgoing;
    std::string basis = "hsh";
    int order = 7;
    Quantity quantity = Quantity::brdf;
    bool condonShortley = false;
    std::string outgoing = {};  ///< as in outgoingOf
    HalfwayOrders halfway = {};
    bool reciprocal = false;  ///< the symmetric half only
    std::string split = {};   ///< "", "diffuse", or a BRDF specification
    Window window = Window::none;
    bool nonNegative = false, energyPreserving = false;
    int rank = 0;          ///< 0: not factored
    double rankError = 0;  ///< the least rank within this relative change
    bool nonNegativeFactors = false;
    std::size_t keep = 0;  ///< numbers of each array to keep; 0: all
    Precision precision = Precision::float32;
};

/// The members that differ from plain coefficients, and the basis, order and precision of all.
std::vector<Setting> settingsOf(const Form& form);
/// The same as messages name them (wording.h).
std::string optionsOf(const Form& form);

/// The source of the projections that a form starts from. The default projects anew; a caller that
/// tries many forms keeps its projections.
class ProjectionSource {
public:
    virtual ~ProjectionSource() = default;
    /// Coefficients per outgoing direction, exactly of this basis and order.
    virtual Coefficients outgoing(const Form& form) = 0;
    /// The matrix of coefficients for both directions in one basis.
    virtual Representation both(const Form& form) = 0;
    virtual Representation halfway(const Form& form) = 0;
    /// The BRDF that is being represented, less what `split` took out.
    virtual const Brdf& remainder() const = 0;
};
std::unique_ptr<ProjectionSource> projecting(const Brdf& brdf, const ProjectionOptions& options);

/// The BRDF in the form asked for, with what every step cost in `steps`.
/// Throws UsageError where options contradict each other or the BRDF.
Representation represent(const Brdf& brdf, const Form& form, const BrdfOpener& open,
                         const ProjectionOptions& options = {});
/// The form from projections at hand. `added` is the part of the BRDF that `split` took out.
Representation represent(ProjectionSource& source, const Form& form, const std::string& added = {});

/// The set that the form names (OutgoingSet::parse). Where it names none, 32 elevations of an
/// isotropic BRDF, whose functions over wi turn with wo, and a 32x32 map of any other.
OutgoingSet outgoingOf(const Form& form, const Laws& laws);

/// Throws UsageError for options that contradict each other or the BRDF's laws.
void requireConsistent(const Form& form, const Laws& laws);

}  // namespace hshfit::inline representation::inline forms
