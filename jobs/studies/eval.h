#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/number_text.h>
#include <jobs/common/option_row.h>

#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct EvalOptions {
    bool cosine = false;  ///< f cos(theta_i) instead of f
    bool rgb = false;     ///< wavelengths as linear Rec. 709
    /// A pair of directions, or a CSV of pairs (readPairs).
    std::optional<Angles> wi = {}, wo = {};
    std::string pairs = {};
};
OptionRows<EvalOptions> evalOptions();

struct Evaluated {
    std::string brdf;
    std::string side = {};  ///< "transmission-front" or "transmission-back"; "": a reflection
    std::vector<std::string> channels = {};
    std::vector<double> values = {};  ///< one per channel, in 1/sr
};

/// f at the pair of directions, of a source as in openSource. Of a transmission, wo is below the
/// surface, and an InputError is thrown where it is above. The listener hears why f is 0 (whyZero).
/// Throws UsageError without both directions and for a reflection to below the surface, InputError,
/// and NumericError where f is not finite.
Evaluated evaluatePair(const std::string& source, const EvalOptions& options,
                       const Listener& listener = {});

/// Values at the pairs of a file; `facts.values` has the values of all pairs, pair by pair.
struct EvaluatedPairs {
    Evaluated facts;
    std::size_t count = 0;
    std::string csv;
};

/// f at every pair of the CSV, as a CSV: the pairs as they stand, then one column per
/// wavelength, or r, g and b, which are equal for a grey BRDF. The text is also written to
/// `output`, unless that is empty. Throws InputError and OutputError.
EvaluatedPairs evaluatePairs(const std::string& source, const std::string& output,
                             const EvalOptions& options, const Listener& listener = {});

/// Vectors in memory of the caller: component j of vector k is at data[k * stride + j * step].
/// A stride of 0 is one vector for all k.
struct VectorArray {
    const double* data = nullptr;
    std::ptrdiff_t stride = 3, step = 1;  ///< in doubles

    Direction at(std::size_t k) const {
        const double* d = data + static_cast<std::ptrdiff_t>(k) * stride;
        return {d[0], d[step], d[2 * step]};
    }
};

/// Pairs that a thread evaluates at a time: some 0.2 ms for the cheapest models.
inline constexpr std::size_t pairsAtOnce = 4096;

/// f at `count` pairs, out[k * channels + c]: the same bits as by evaluatePair, on all threads.
/// Pairs that follow each other with one wo are evaluated together. Throws InputError as
/// unitDirection does, with the name "wi" or "wo" and the number of the pair.
void evaluateArrays(const Brdf& brdf, const VectorArray& wi, const VectorArray& wo,
                    std::size_t count, double* out, const EvalOptions& options);

}  // namespace hshfit::jobs
