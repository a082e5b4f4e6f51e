#include <hshfit/representation/constraints/internal/constraints_least_change.h>

#include <hshfit/error.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline representation::inline constraints {
namespace {

using Vector = Eigen::VectorXd;
using Index = Eigen::Index;

/// The normals of the active set, N = Q R with orthonormal columns of Q.
class ActiveNormals {
public:
    explicit ActiveNormals(Index dimensions) : q_(dimensions, 0), r_(0, 0) {}

    Index size() const { return count_; }

    /// The part of `normal` that is orthogonal to the active ones, and `along` with normal =
    /// Q along + that part. Twice, against rounding.
    Vector outside(const Vector& normal, Vector& along) const {
        const auto q = q_.leftCols(count_);
        along = q.transpose() * normal;
        Vector rest = normal - q * along;
        const Vector again = q.transpose() * rest;
        rest -= q * again;
        along += again;
        return rest;
    }
    /// R^-1 along.
    Vector shares(const Vector& along) const {
        return r_.topLeftCorner(count_, count_).triangularView<Eigen::Upper>().solve(along);
    }
    void append(const Vector& outside, const Vector& along) {
        if (count_ == q_.cols()) {
            const Index room = std::min<Index>(q_.rows(), 2 * count_ + 8);
            q_.conservativeResize(Eigen::NoChange, room);
            r_.conservativeResize(room, room);
        }
        const double norm = outside.norm();
        q_.col(count_) = outside / norm;
        r_.col(count_).head(count_) = along;
        r_(count_, count_) = norm;
        ++count_;
    }
    /// Givens rotations make R triangular again.
    void remove(Index k) {
        for (Index j = k; j + 1 < count_; ++j) r_.col(j).head(j + 2) = r_.col(j + 1).head(j + 2);
        --count_;
        for (Index j = k; j < count_; ++j) {
            const double a = r_(j, j), b = r_(j + 1, j), length = std::hypot(a, b);
            if (length == 0) continue;
            const double c = a / length, s = b / length;
            for (Index column = j; column < count_; ++column) {
                const double x = r_(j, column), y = r_(j + 1, column);
                r_(j, column) = c * x + s * y;
                r_(j + 1, column) = c * y - s * x;
            }
            const Vector x = q_.col(j), y = q_.col(j + 1);
            q_.col(j) = c * x + s * y;
            q_.col(j + 1) = c * y - s * x;
        }
    }

private:
    Index count_ = 0;
    Eigen::MatrixXd q_, r_;
};

}  // namespace

struct LeastChange::State {
    std::vector<double> x;
    std::vector<Vector> rows;
    std::vector<double> bounds;
    std::vector<bool> leftOut;
    ActiveNormals normals;
    std::vector<std::size_t> active;
    std::vector<double> multipliers;  ///< of the active ones

    explicit State(std::vector<double> start)
        : x(std::move(start)), normals(static_cast<Index>(x.size())) {}

    Eigen::Map<Vector> point() { return {x.data(), static_cast<Index>(x.size())}; }
    double slack(std::size_t k) { return rows[k].dot(point()) - bounds[k]; }

    /// The most violated constraint, or their number if all are kept.
    std::size_t worst(double tolerance) {
        std::size_t found = rows.size();
        double least = -tolerance;
        for (std::size_t k = 0; k < rows.size(); ++k) {
            if (leftOut[k]) continue;
            const double s = slack(k);
            if (s < least && std::ranges::find(active, k) == active.end()) least = s, found = k;
        }
        return found;
    }

    void drop(std::size_t k) {
        normals.remove(static_cast<Index>(k));
        active.erase(active.begin() + static_cast<std::ptrdiff_t>(k));
        multipliers.erase(multipliers.begin() + static_cast<std::ptrdiff_t>(k));
    }

    /// Steps until constraint p holds with equality, or contradicts the active ones.
    void takeIn(std::size_t p) {
        constexpr double dependent = 1e-10;  // part of a unit normal outside of the active ones
        constexpr double infinity = std::numeric_limits<double>::infinity();
        double own = 0;
        for (;;) {
            Vector along;
            const Vector outside = normals.outside(rows[p], along);
            const Vector shares = normals.shares(along);
            const double length = outside.squaredNorm();
            double partial = infinity;
            std::size_t leaves = 0;
            for (std::size_t j = 0; j < active.size(); ++j) {
                const double share = shares(static_cast<Index>(j));
                if (share > 1e-14 && multipliers[j] / share < partial) {
                    partial = multipliers[j] / share;
                    leaves = j;
                }
            }
            const double full = length > dependent * dependent ? -slack(p) / length : infinity;
            const double step = std::min(partial, full);
            if (step == infinity) {
                leftOut[p] = true;
                return;
            }
            for (std::size_t j = 0; j < active.size(); ++j) {
                multipliers[j] =
                    std::max(multipliers[j] - step * shares(static_cast<Index>(j)), 0.0);
            }
            own += step;
            if (full < infinity) point() += step * outside;
            if (step == full) {
                normals.append(outside, along);
                active.push_back(p);
                multipliers.push_back(own);
                return;
            }
            drop(leaves);
        }
    }
};

LeastChange::LeastChange(std::vector<double> start)
    : state_(std::make_unique<State>(std::move(start))) {}
LeastChange::~LeastChange() = default;
LeastChange::LeastChange(LeastChange&&) noexcept = default;

void LeastChange::add(std::span<const double> row, double bound) {
    Vector normal = Eigen::Map<const Vector>(row.data(), static_cast<Index>(row.size()));
    const double norm = normal.norm();
    if (norm == 0) return;
    state_->rows.push_back(normal / norm);
    state_->bounds.push_back(bound / norm);
    state_->leftOut.push_back(false);
}

void LeastChange::solve(double tolerance) {
    const std::size_t most = 50 * (state_->x.size() + state_->rows.size()) + 100;
    for (std::size_t step = 0; step < most; ++step) {
        const std::size_t p = state_->worst(tolerance);
        if (p == state_->rows.size()) return;
        state_->takeIn(p);
    }
    throw NumericError("the least change under constraints was not found: the active set cycles");
}

const std::vector<double>& LeastChange::x() const {
    return state_->x;
}

std::size_t LeastChange::active() const {
    return state_->active.size();
}

}  // namespace hshfit::inline representation::inline constraints
