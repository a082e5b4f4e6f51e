#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/material_library/form_error.h>
#include <hshfit/material_library/log_brdf.h>

#include <memory>
#include <string>
#include <vector>

namespace hshfit::material_library {

struct LogSamples;

/// A material as it enters a library: ln(f + logOffset) in all terms, in single precision, and how
/// far these are from its source.
struct Measured {
    std::string name;    ///< unique in a library, without ':' and ','
    std::string source;  ///< the specification
    std::vector<float> exponents, tops;
    FormError error = {};
    /// Mean squares of ln(f + logOffset) beyond the terms: of the sum of the channels over root 3
    /// in each zone of pairs, then of differences; empty where a file does not say it.
    std::vector<float> rest = {};

    std::size_t channels() const { return tops.size(); }
    LogMaterial material() const;
};

/// The projection onto logTerms(). Immutable; safe to use from many threads.
class LogSpace {
public:
    LogSpace();
    ~LogSpace();

    /// Least squares of ln(f + logOffset) over fixed pairs that see lobes and the horizon
    /// (spreadPairs), half of the weight by solid angle and half by pair; residuals beyond 1 count
    /// as 1 (Huber's function, by the modified residuals of Huber and Dutter 1974). f < 0 counts as
    /// 0. The tops are the greatest values over the pairs and the ridge, where wi mirrors wo.
    /// `seen`: the error has FLIP. Throws NumericError where f is not finite, and UsageError unless
    /// it is grey or RGB.
    Measured project(const Brdf& brdf, const std::string& name, const std::string& source,
                     bool seen = false) const;

    const LogSamples& samples() const { return *samples_; }

private:
    std::unique_ptr<const LogSamples> samples_;
};

}  // namespace hshfit::material_library
