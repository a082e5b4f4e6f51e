#pragma once

#include <hshfit/plan/internal/ladder.h>
#include <hshfit/representation/forms/form.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::plan {

/// Projections of one BRDF that are computed once, at the highest order, and cut to lower
/// orders. They serve the choice only: cut coefficients agree with those of `project` within the
/// tolerance, not to the last bit, and matrices leave out the last thousandth above the horizon.
class KeptProjections : public ProjectionSource {
public:
    /// `brdf` has to outlive this.
    KeptProjections(const Brdf& brdf, const LadderOptions& ladder, double tolerance);
    ~KeptProjections() override;

    Coefficients outgoing(const Form& form) override;
    Representation both(const Form& form) override;
    Representation halfway(const Form& form) override;
    const Brdf& remainder() const override { return brdf_; }

    /// Coefficients in every basis of the ladder, at its highest order or at most `order`, for
    /// any set of directions; not cached.
    std::vector<Coefficients> allBases(const OutgoingSet& set, Quantity quantity, int order = 0);

private:
    ProjectionOptions optionsFor(Quantity quantity) const;
    int highestOrder(const std::string& basis) const;

    /// Calls `make`. If it failed before under this key, throws the same error again.
    void once(const std::string& key, const std::function<void()>& make);

    const Brdf& brdf_;
    LadderOptions ladder_;
    double tolerance_;
    std::map<std::string, std::map<std::string, Coefficients>> outgoing_;  ///< by set, by basis
    std::map<std::string, std::vector<Coefficients>> outer_;  ///< for matrices, by quantity
    std::map<std::string, Representation> both_, halfway_;
    std::map<std::string, std::string> failed_;
};

}  // namespace hshfit::plan
