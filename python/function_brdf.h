#pragma once

#include "module.h"

#include <hshfit/brdf/brdf.h>

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace hshfit::python {

/// Everything that a user says of a function.
struct FunctionFacts {
    std::string name;
    Channels channels;
    Laws laws;
    double halfwayWidth = 0;  ///< Lobe::width about the half vector; 0: no lobe
    double tolerance = 1e-6;  ///< Brdf::defaultTolerance
};

/// f(wi, wo) as a function of Python, called with all directions of a batch at once: wi of shape
/// (n, 3) and wo of shape (3,). It returns (n,) for one channel, (n, channels), or what broadcasts
/// to these. The interpreter's lock is held during the call alone, from whatever thread.
///
/// `eval` must not throw: what the function raises, and a result of another shape, is kept for
/// `rethrow`, and from then on f is NaN without a call, which ends the work at hand.
class FunctionBrdf final : public Brdf {
public:
    /// The lock is held by the caller.
    FunctionBrdf(py::object function, FunctionFacts facts);
    ~FunctionBrdf() override;
    FunctionBrdf(const FunctionBrdf&) = delete;
    FunctionBrdf& operator=(const FunctionBrdf&) = delete;

    /// The same function, with nothing raised so far: one for each piece of work.
    std::shared_ptr<FunctionBrdf> fresh() const;
    /// From now on f is NaN, and nothing is called.
    void stop() const { stopped_ = true; }
    /// Throws what was raised, if anything was.
    void rethrow() const;

    std::string name() const override { return facts_.name; }
    const Channels& channels() const override { return facts_.channels; }
    const Laws& laws() const override { return facts_.laws; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    std::vector<Lobe> lobes(const Direction& wo) const override;
    double defaultTolerance() const override { return facts_.tolerance; }
    std::vector<Fact> facts() const override { return {{"model", std::string("function")}}; }

private:
    void call(const Direction& wo, const DirectionBatch& wi, double* out) const;

    py::object function_;
    FunctionFacts facts_;
    mutable std::atomic<bool> stopped_ = false;
    mutable std::mutex mutex_;
    mutable std::exception_ptr raised_;
};

}  // namespace hshfit::python
