#pragma once

#include <hshfit/error.h>
#include <hshfit/representation/forms/form.h>
#include <hshfit/time_limit.h>

#include <functional>
#include <map>
#include <span>
#include <string>

namespace hshfit::tradeoff {

/// The reason why a form is left out.
inline constexpr const char* timeIsOver = "the time was over";

/// Projections that many forms start from, each made once: at the highest order that any form asks
/// of it, because the coefficients of lower orders are its prefix. Bases whose functions depend on
/// the order (not nested) are projected for each.
/// After `prepare`, safe to use from many threads.
class ProjectionCache final : public ProjectionSource {
public:
    /// `brdf` has to outlive this.
    ProjectionCache(const Brdf& brdf, const ProjectionOptions& options);

    /// Projects for all these forms. A projection that does not exist or does not converge is
    /// noted as the reason why its forms fail, and so is the end of the time. `done` is called
    /// after each.
    void prepare(std::span<const Form> forms, const std::function<void()>& done,
                 const TimeLimit& limit = {});
    /// The number of projections that `prepare` would make.
    static std::size_t projectionsFor(std::span<const Form> forms);

    /// Wall-clock seconds, on all threads, of the projection that the form derives from.
    double seconds(const Form& form) const;

    /// For a form that was prepared. These throw NumericError or UsageError with the reason.
    Coefficients outgoing(const Form& form) override;
    Representation both(const Form& form) override;
    Representation halfway(const Form& form) override;
    const Brdf& remainder() const override { return brdf_; }

private:
    struct Made {
        int order = 0;
        Coefficients coefficients;
        Representation representation;
        double seconds = 0;
        ExitCode failure = ExitCode::done;
        std::string reason;
    };
    const Made& made(const Form& form) const;
    void make(const Form& form, Made& into) const;

    const Brdf& brdf_;
    ProjectionOptions options_;
    std::map<std::string, Made> projections_;
};

}  // namespace hshfit::tradeoff
