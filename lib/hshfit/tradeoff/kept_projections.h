#pragma once

#include <hshfit/representation/forms/form.h>
#include <hshfit/time_limit.h>
#include <hshfit/tradeoff/projection_folder.h>

#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::tradeoff {

/// The reason why a form is left out.
inline constexpr const char* timeIsOver = "the time was over";

struct KeepOptions {
    ProjectionOptions projection = {};  ///< but for the quantity, which forms state
    /// The bases of a search. Empty: projections are made as `represent` makes them. Else all these
    /// bases are projected together, which evaluates f once, to `maxOrder` bands, or to eight for
    /// matrices that are not isotropic. Matrices leave out the last thousandth of the hemisphere
    /// above the horizon, where lobes are narrowest. Cut to a lower order, the projections agree
    /// within the tolerance.
    std::vector<std::string> bases = {};
    int maxOrder = 0;
    /// Outlives what is made with it.
    const ProjectionFolder* folder = nullptr;
    std::string split = {};  ///< Form::split, by which the BRDF is what is left
};

/// Projections that many forms start from, each made once, in this run or in an earlier one: at the
/// highest order that any form asks of it, because the coefficients of lower orders are its prefix.
/// Bases whose functions depend on the order (not nested) are projected for each.
/// Once a form's projection is made, safe to use for it from many threads.
class KeptProjections final : public ProjectionSource {
public:
    /// `brdf` has to outlive this.
    KeptProjections(const Brdf& brdf, KeepOptions options);

    /// Takes note of the orders of these forms; no form of a higher one may follow once the
    /// projection is made.
    void expect(std::span<const Form> forms);
    /// Projects for all these forms, beginning with projections that take little time. A projection
    /// that does not exist or does not converge is noted as the reason why its forms fail, and so
    /// is the end of the time. `done` is called after each.
    void prepare(std::span<const Form> forms, const std::function<void()>& done,
                 const TimeLimit& limit = {});
    /// The number of projections that `prepare` would make.
    static std::size_t projectionsFor(std::span<const Form> forms);

    /// Whether the form's projection is made, or has failed.
    bool isMade(const Form& form) const;
    /// Wall-clock seconds, on all threads, of the projection that the form derives from.
    double seconds(const Form& form);

    /// These make what is not there, and throw NumericError or UsageError where that fails, each
    /// time again.
    Coefficients outgoing(const Form& form) override;
    Representation both(const Form& form) override;
    Representation halfway(const Form& form) override;
    const Brdf& remainder() const override { return brdf_; }

    /// For a search: coefficients in every basis for any set of directions, of at most `order`
    /// bands; not kept.
    std::vector<Coefficients> allBases(const OutgoingSet& set, Quantity quantity,
                                       int order = 0) const;

private:
    struct Made {
        KeptProjection projection;
        Coefficients coefficients = {};  ///< of a projection by outgoing direction
    };
    bool searches() const { return !options_.bases.empty(); }
    int highestOrder(const Form& form) const;
    /// The projection that the form derives from.
    Form rootOf(const Form& form) const;
    std::string fileKeyOf(Form root) const;
    std::size_t fitEvaluations() const;
    const Made& made(const Form& form);
    /// Takes the projection from the folder, or projects.
    void make(const Form& root);
    void keep(const Form& root, const Made& made) const;
    std::vector<std::pair<Form, Made>> projectedAlone(const Form& root) const;
    /// Projections in all bases of a search.
    std::vector<std::pair<Form, Made>> projectedTogether(const Form& root) const;

    const Brdf& brdf_;
    KeepOptions options_;
    std::string content_;                ///< of ProjectionFolder::contentOf
    std::map<std::string, int> orders_;  ///< expected, by key
    std::map<std::string, Made> made_;   ///< by key
};

}  // namespace hshfit::tradeoff
