#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/bases/internal/long_orders.h>
#include <hshfit/bases/internal/short_orders.h>

#include <array>
#include <memory>
#include <mutex>
#include <string_view>
#include <vector>

namespace hshfit::bases {

/// Parameters of a member of the Jacobi family:
///     T_l^m = c_m F^m W p_k(t) / p_0,  p_k orthonormal for (1-t)^alpha (1+t)^beta on [-1, 1],
///     l = m + k bandStep,  with F the factor below and W = sqrt(mu) or 1.
struct JacobiFamily {
    enum class Argument {
        cosine,       ///< t = mu: functions on the whole sphere
        shifted,      ///< t = 2 mu - 1
        shiftedDown,  ///< t = 1 - 2 mu
    };
    enum class Factor {
        sine,   ///< F = sin(theta) = sqrt((1 - mu)(1 + mu))
        hump,   ///< F = 2 sqrt(mu (1 - mu))
        chord,  ///< F = sqrt(1 - mu) = sqrt(2) sin(theta / 2)
    };
    /// An exponent of the Jacobi weight: slope * m + offset.
    struct Exponent {
        int slope = 1, offset = 0;
        int at(int m) const { return slope * m + offset; }
    };

    std::string_view name;
    Argument argument = Argument::shifted;
    Factor factor = Factor::hump;
    Exponent alpha{}, beta{};
    double startSquared = 1;               ///< c_0^2
    double (*startGrowth)(int) = nullptr;  ///< m -> c_m^2 / c_{m-1}^2
    int bandStep = 1;                      ///< Zernike: 2
    bool evenOnly = false;                 ///< ESH: leave out functions with l + m odd
    bool timesRootCosine = false;          ///< W = sqrt(mu)
    Basis::Inner inner = Basis::Inner::solidAngle;
};

/// HSH, SH, ESH, Zernike and Makhotkin, by one three-term recurrence in k at fixed m.
///
/// Vector kernels (bases/internal/) do the work: up to order 10 the plain recurrence for a few
/// directions at once in registers, above it the recurrence described here.
///
/// The recurrence runs in differences from the nearer end of [-1, 1] (Reinsch's form; Gentleman
/// 1969) and takes 1 - mu or mu itself as the distance to that end, so that its rounding errors do
/// not pile up there as k^{3/2}. F^m below the range of the number type is carried with an exponent
/// of its own until the values come back into range.
/// Below the horizon (mu < 0) all but the whole-sphere members (SH, ESH) are 0.
class JacobiBasis : public Basis {
public:
    JacobiBasis(const JacobiFamily& family, int order, BasisOptions options);

    std::string name() const override { return std::string(family_.name); }
    Inner inner() const override { return family_.inner; }
    bool has(int l, int m) const override;
    void theta(int m, std::span<const Elevation<double>> points, double* out) const override;
    void theta(int m, std::span<const Elevation<float>> points, float* out) const override;
    void tabulate(DirectionBatch directions, Layout layout, double* out) const override;
    void tabulate(DirectionBatch directions, Layout layout, float* out) const override;

    /// `theta` one value at a time, without vector instructions: the reference of the kernels'
    /// tests.
    void thetaScalar(int m, std::span<const Elevation<double>> points, double* out) const;
    void thetaScalar(int m, std::span<const Elevation<float>> points, float* out) const;

    using Step = kernels::Step<double>;

    const JacobiFamily& family() const { return family_; }
    /// c_m = T_m^m / (F^m W).
    double start(int m) const { return starts_[static_cast<std::size_t>(m)]; }
    /// The steps of column m from the end t = 1 or, `fromMinusOne`, t = -1.
    std::span<const Step> steps(int m, bool fromMinusOne) const {
        return {steps_[fromMinusOne].data() + offsets_[static_cast<std::size_t>(m)],
                static_cast<std::size_t>(functions(m) - 1)};
    }

private:
    /// Functions T_l^m, l < order, that the recurrence produces.
    int functions(int m) const { return (order() - m + family_.bandStep - 1) / family_.bandStep; }
    int shortStep() const { return family_.evenOnly ? 2 : family_.bandStep; }
    template <class Real>
    void fillScalar(int m, std::span<const Elevation<Real>> points, Real* out) const;
    template <class Real>
    kernels::Recurrences<Real> recurrences(
        const std::array<std::vector<kernels::Step<Real>>, 2>& steps) const;
    const std::array<std::vector<kernels::Step<float>>, 2>& floatSteps() const;
    template <class Real>
    void byRows(const kernels::LazyStepRows<Real>& tables,
                const std::array<std::vector<kernels::Step<Real>>, 2>& steps,
                DirectionBatch directions, Real* out) const;

    JacobiFamily family_;
    std::vector<double> starts_;              ///< c_m
    std::vector<std::size_t> offsets_;        ///< where the steps of each m begin
    std::array<std::vector<Step>, 2> steps_;  ///< from t = 1 and from t = -1
    kernels::ShortTable<double> short_;       ///< for orders up to kernels::shortOrders
    kernels::ShortTable<float> shortFloat_;
    /// Steps in single precision, made when they are first asked for.
    mutable std::once_flag floatStepsOnce_;
    mutable std::array<std::vector<kernels::Step<float>>, 2> floatSteps_;
    kernels::LazyStepRows<double> rows_;
    kernels::LazyStepRows<float> floatRows_;
};

/// The same functions by `thetaScalar`; `basis` has to outlive it.
std::unique_ptr<Basis> scalarReference(const JacobiBasis& basis);

}  // namespace hshfit::bases
