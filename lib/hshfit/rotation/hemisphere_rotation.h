#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/rotation/rotation.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline rotation {

/// Ways to rotate a function on the hemisphere. Turns about z are exact blocks in +-m in all of
/// them; they differ in the tilt about y by beta.
enum class HemisphereMethod {
    exact,      ///< the digon that leaves is deleted (Gautron et al. 2004, Eq. 14), by quadrature
    throughSh,  ///< C R C^T with as many SH bands as the tolerance asks for
    table,      ///< matrices of `exact` at equal steps of beta, interpolated linearly (Eq. 10)
    /// SH matrices for cos(beta') = 2 cos(beta) - 1 (Eqs. 11-13), HSH alone, beta up to 90 degrees.
    /// Only the pole goes where it should: the error is 25 % at 15 degrees for order 4.
    paperShift,
};

/// "exact", "through-sh", "table", "paper-shift"; throws UsageError naming them.
HemisphereMethod hemisphereMethod(std::string_view name);
std::string methodName(HemisphereMethod method);

struct HemisphereRotationOptions {
    HemisphereMethod method = HemisphereMethod::exact;
    /// For `throughSh`: bands are doubled until the result changes by less than this, relative to
    /// the coefficients, or there are 1000.
    double tolerance = 1e-3;
    /// For `table`: beta = 0 .. 180 degrees in tables - 1 steps.
    int tables = 91;
};

struct HemisphereRotated {
    std::vector<double> values;  ///< as the input
    /// Share of the function's energy that left the hemisphere, in the inner product of the basis.
    double lostEnergy = 0;
    /// Distance of the result from the rotated function over the hemisphere, relative to the norm
    /// of the function, both in L2: what the basis cannot hold, and the error of the method.
    /// Differences below 1e-8 are rounding.
    double error = 0;
    int bands = 0;  ///< SH bands of `throughSh`
};

/// Rotates functions on the hemisphere, given by coefficients: f(R^-1 d) where R^-1 d is above the
/// horizon, 0 elsewhere, projected onto the same basis again (lsosh: fitted). A tilt of `sh` takes
/// the part of the sum above the horizon; rotate whole spheres by ShRotation.
/// Exact: 1e-12, O(order^4) operations a vector: 10 s of CPU at order 100 and 30 degrees. Throws
/// UsageError for a basis or an angle that the method does not have, and for an order above 150
/// (table: 32).
class HemisphereRotation {
public:
    explicit HemisphereRotation(const Basis& basis, const HemisphereRotationOptions& options = {});
    ~HemisphereRotation();
    HemisphereRotation(HemisphereRotation&&) noexcept;
    HemisphereRotation& operator=(HemisphereRotation&&) noexcept;

    /// Vectors of order^2 slots one after the other; loss and error are of all of them together.
    HemisphereRotated rotate(const Rotation& rotation, const std::vector<double>& c) const;
    /// The same without loss and error, which cost as much as `exact`.
    std::vector<double> values(const Rotation& rotation, const std::vector<double>& c) const;

    /// All order^2 x order^2 entries, row by row. Throws UsageError for an order above 32.
    std::vector<double> matrix(const Rotation& rotation) const;

    /// Bytes of the tables of `table`, in double precision without entries that are always 0.
    std::size_t tableBytes() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hshfit::inline rotation
