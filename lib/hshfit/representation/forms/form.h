#pragma once

#include <hshfit/projection/projection.h>
#include <hshfit/representation/constraints/constraints.h>
#include <hshfit/representation/representation.h>

#include <functional>
#include <string>
#include <string_view>

namespace hshfit::inline representation::inline forms {

/// "outgoing", "basis" or "halfway"; "H,D,A" for the orders. Both throw UsageError.
Representation::Kind parseKind(std::string_view name);
HalfwayOrders parseHalfway(std::string_view text);

/// Everything that may be asked of a representation: the options of `project`, one for one.
/// Applied in the order of the members, from `split` on.
struct Form {
    Representation::Kind kind = Representation::Kind::outgoing;  ///< --form
    std::string basis = "hsh";
    int order = 7;
    Quantity quantity = Quantity::brdf;  ///< --cosine
    bool condonShortley = false;
    std::string outgoing;          ///< --outgoing; empty: 32x32
    HalfwayOrders halfway = {};    ///< --halfway H,D,A
    bool reciprocal = false;       ///< --reciprocal
    std::string split;             ///< --split: "", "diffuse", or a BRDF specification
    Window window = Window::none;  ///< --window
    bool nonNegative = false, energyPreserving = false;
    int rank = 0;          ///< --rank; 0: not factored
    double rankError = 0;  ///< --rank-error: the least rank within this relative change
    bool nonNegativeFactors = false;
    std::size_t keep = 0;  ///< --keep: numbers of each array to keep; 0: all
    Precision precision = Precision::float32;
};

/// As options of `project`: "--basis zernike --order 6 --outgoing 16 --rank 3 --precision half".
std::string optionsOf(const Form& form);

/// Where the projections that a form starts from come from. The default projects; a caller that
/// tries many forms keeps what it has projected.
class ProjectionSource {
public:
    virtual ~ProjectionSource() = default;
    /// Coefficients per outgoing direction, exactly of this basis and order.
    virtual Coefficients outgoing(const Form& form) = 0;
    /// Both directions in one basis.
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
/// From projections that are at hand. What `split` took out of the BRDF stands in `added`.
Representation represent(ProjectionSource& source, const Form& form, const std::string& added = {});

/// The set that the form names; 32x32, as in `project`, where it names none.
OutgoingSet outgoingOf(const Form& form);

/// Throws UsageError for options that contradict each other or the BRDF's laws.
void requireConsistent(const Form& form, const Laws& laws);

}  // namespace hshfit::inline representation::inline forms
