#pragma once

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/choice/rows.h>
#include <hshfit/error.h>
#include <hshfit/gpu/timing/shader_time.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/time_limit.h>
#include <hshfit/tradeoff/projection_folder.h>
#include <hshfit/tradeoff/sweep.h>
#include <hshfit/tradeoff/timing.h>
#include <hshfit/tradeoff/wavelet_forms.h>

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::tradeoff {

struct Measured;

struct TradeoffOptions {
    Sweep sweep = {};
    /// A name from metricCatalog: what the fronts weigh. Of captured-energy, 1 minus it. Or
    /// "picture": the mean FLIP of the picture error, which every form is then measured by.
    std::string metric = "nbrdf";
    std::size_t maxBytes = std::numeric_limits<std::size_t>::max();  ///< larger forms are left out
    /// Slower forms are left out of the front over time; takes `byTime`.
    double maxNanoseconds = std::numeric_limits<double>::infinity();
    bool timing = true;
    /// Time the shaders of the fronts' forms on this device; takes `timing`.
    std::optional<gpu::DeviceChoice> gpu = {};
    bool costs = false;  ///< state what the fronts' shaders cost on an AMD GPU (gpu::ShaderCosts)
    /// Measured beside the forms: what the material can be without coefficients.
    std::vector<choice::Candidate> formulas = {};
    bool wavelets = false;  ///< measure the best terms of spherical wavelets too
    bool byTime = false;    ///< the choice is the knee over time instead of that over bytes
    ProjectionOptions projection = {};
    ProjectionFolder folder = {};  ///< projections of earlier runs
    /// Called with steps done and in all, from any thread.
    std::function<void(std::size_t, std::size_t)> progress = {};
    /// Forms that are not reached are left out; a quarter of the time is for times, if they are
    /// measured.
    TimeLimit limit = {};
    /// Called with a form whose error is below half of the least so far, and that error; first with
    /// coefficients of few bands, before the long work. From one thread at a time.
    std::function<void(const std::string& brdf, const Measured&, double error)> found = {};
};

/// One form of one BRDF.
struct Measured {
    Form form;
    std::string options;  ///< optionsOf(form)
    std::size_t bytes = 0, entropyBytes = 0, numbers = 0;
    std::vector<RepresentationStep> steps;
    PairErrors errors;
    std::vector<PairErrors> bands;  ///< by elevation of wo, see bandEdges
    PairSummary summary;
    std::optional<PictureError> picture = {};  ///< of forms on a front, or all with that metric
    std::optional<gpu::ShaderCost> cost = {};  ///< of forms on a front, if asked for
};

/// A material that is no coefficient file, at the same pairs.
struct MeasuredFormula {
    choice::Row row;
    PairErrors errors;
    PairSummary summary;
};

/// The cost of a form; wall-clock times of this machine.
struct MeasuredTime {
    /// The projection that the form derives from: at the highest order tried, on all threads.
    double projectionSeconds = 0;
    double derivationSeconds = 0;  ///< everything after it, on one thread
    FormTime evaluation;
};

/// The shader of one form of the fronts.
struct MeasuredShader {
    std::size_t form = 0;                 ///< into `forms`
    std::optional<gpu::ShaderTime> time;  ///< none: it has no shader
    std::string reason;                   ///< why it has none
};

/// The shaders of the forms of both fronts on one device, by form.
struct MeasuredShaders {
    std::string device;
    bool software = false;  ///< a renderer on the processor, whose times say nothing of a GPU
    gpu::ShaderTime bare;   ///< of a shader that makes the directions alone
    std::vector<MeasuredShader> forms = {};
};

/// Forms that could not be had, and why: one line for each reason.
struct LeftOut {
    std::string reason;
    std::size_t forms = 0;
    std::string example;  ///< options of the first
};

/// The trade of one BRDF. All but `times`, `timeFront` and what follows them is the same whenever
/// it is measured.
struct Tradeoff {
    std::string brdf;
    Channels channels;
    Laws laws;
    std::string metric;
    double tolerance = 0;  ///< asked of projections; 0: each BRDF's own
    std::size_t pairs = 0;
    std::string noSquares;  ///< why metrics of squares without a cosine have no value
    std::vector<Measured> forms = {};
    std::vector<LeftOut> leftOut = {};
    std::size_t beyondBytes = 0;              ///< forms larger than maxBytes
    std::vector<std::size_t> byteFront = {};  ///< into `forms`, by rising bytes
    std::optional<std::size_t> byteKnee = {};
    /// [r - 1]: the least relative L2 error that any r functions of wi can leave, for f at the
    /// outgoing directions of `sliceOutgoing` (sliceSpectrum, factoring.h). Empty where it does not
    /// exist or its grid did not converge.
    std::vector<double> sliceErrors = {};
    std::string sliceOutgoing = {};
    std::vector<MeasuredWavelets> wavelets = {};  ///< if asked for
    std::vector<MeasuredFormula> formulas = {};   ///< by rising bytes
    std::optional<choice::CostScale> costs = {};  ///< if asked for

    std::vector<MeasuredTime> times = {};     ///< like `forms`; empty without timing
    std::vector<std::size_t> timeFront = {};  ///< by rising nanoseconds a pair, batch of 4096
    std::optional<std::size_t> timeKnee = {};
    std::optional<MeasuredShaders> shaders = {};  ///< if asked for

    /// The time of the shader of a form; none where it was not measured.
    std::optional<double> shaderTimeOf(std::size_t form) const;

    /// The error that the fronts weigh; NaN where it does not exist.
    double errorOf(std::size_t form) const;
    /// Why a form is poor (pictures/poor.h), by its picture error and the energy that is left.
    std::optional<std::string> poorReasonOf(std::size_t form) const;
    /// The error in one band; NaN likewise, and by the metric picture.
    double bandErrorOf(std::size_t form, std::size_t band) const;
    /// The standard error of an error; none of the metric picture.
    std::optional<double> uncertaintyOf(const PairErrors& errors) const;
    /// The error of one of `formulas`; NaN where it does not exist.
    double formulaErrorOf(std::size_t formula) const;
    /// The error of a form of `wavelets`.
    double waveletErrorOf(std::size_t form) const;
    /// Indices of the `wavelets` that no other wavelet form beats, by rising bytes.
    std::vector<std::size_t> waveletFront() const;
};

/// Measures every form of the sweep against `brdf` at the pairs. Errors on all threads, times
/// afterwards on one. A form that fails is left out with its reason.
/// Throws UsageError for an unknown metric and for an empty sweep; NumericError where no form is
/// left, and for costs without a compiler.
Tradeoff measure(const Brdf& brdf, PairSample pairs, const TradeoffOptions& options,
                 const BrdfOpener& open);

}  // namespace hshfit::tradeoff
