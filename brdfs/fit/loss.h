#pragma once

#include <span>
#include <string_view>

namespace hshfit::brdfs {

/// One row of the table of losses: a fit minimises sum w rho((g(f) - g(measured))^2) / 2, where g
/// is below, c = cos(theta_i), w is the weight of the sample and rho the robust kernel.
struct Loss {
    enum class Kind { l2, cosine, log, cubeRoot, logRelative, picture };
    std::string_view name;
    std::string_view help;
    std::string_view source;
    Kind kind;
    bool linear;  ///< g is linear in f: linear parameters can be eliminated exactly
    /// The metric of metricCatalog() that has its least value where the loss has over nodes.
    std::string_view metric = {};
};
std::span<const Loss> losses();
/// Throws UsageError that names the known ones.
const Loss& findLoss(std::string_view name);
std::string_view lossName(Loss::Kind kind);

/// g and its derivative by f, for f cut at 0 if g is not linear.
struct Mapped {
    double value, slope;
};
Mapped mapValue(Loss::Kind kind, double f, double cosine);

/// The damping of outliers: rho(s) for a squared residual s, with scale a (in units of g).
///     huber   s for s <= a^2, else 2 a sqrt(s) - a^2
///     cauchy  a^2 ln(1 + s / a^2)
enum class Robust { none, huber, cauchy };
/// "none", "huber" or "cauchy". Throws UsageError.
Robust findRobust(std::string_view name);
std::string_view robustName(Robust robust);

/// rho and its derivative by s. Both kernels are concave: rho(s) >= s rho'(s).
struct Kernel {
    double value, slope;
};
Kernel applyKernel(Robust robust, double scale, double squared);

}  // namespace hshfit::brdfs
