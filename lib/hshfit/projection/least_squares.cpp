#include <hshfit/projection/least_squares.h>

#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <numeric>
#include <vector>

namespace hshfit::inline projection {
namespace {

/// The samples with their images under exchange and mirror.
struct Rows {
    std::vector<Direction> wi, wo;
    std::vector<std::size_t> sample;  ///< whose values

    void add(const Direction& in, const Direction& out, std::size_t k) {
        if (!(in.z >= 0) || !(out.z >= 0)) return;
        wi.push_back(in);
        wo.push_back(out);
        sample.push_back(k);
    }
};

Rows expand(const DirectionSamples& samples) {
    const auto flipped = [](const Direction& d) { return Direction{d.x, -d.y, d.z}; };
    Rows rows;
    for (std::size_t k = 0; k < samples.wi.size(); ++k) {
        const Direction &i = samples.wi[k], &o = samples.wo[k];
        rows.add(i, o, k);
        if (samples.symmetry.reciprocal) rows.add(o, i, k);
        if (samples.symmetry.mirrorSymmetric) rows.add(flipped(i), flipped(o), k);
        if (samples.symmetry.reciprocal && samples.symmetry.mirrorSymmetric) {
            rows.add(flipped(o), flipped(i), k);
        }
    }
    return rows;
}

/// The functions that f is expanded in, by slot (see Basis::analysisTheta).
class AnalysisFunctions {
public:
    explicit AnalysisFunctions(const Basis& basis) : basis_(basis) {
        for (int l = 0; l < basis.order(); ++l) {
            for (int m = -l; m <= l; ++m) {
                if (basis.has(l, m)) slots_.push_back({l, m});
            }
        }
    }

    std::size_t count() const { return slots_.size(); }
    std::size_t slot(std::size_t j) const {
        return static_cast<std::size_t>(slotOf(slots_[j].l, slots_[j].m));
    }

    /// One row per direction.
    Eigen::MatrixXd at(const std::vector<Direction>& directions) const {
        const int order = basis_.order();
        const std::size_t points = directions.size();
        std::vector<Elevation<double>> elevations;
        for (const Direction& d : directions) elevations.push_back(elevationOf(d));
        std::vector<std::vector<double>> theta(static_cast<std::size_t>(order));
        for (int m = 0; m < order; ++m) {
            theta[static_cast<std::size_t>(m)].resize(static_cast<std::size_t>(order - m) * points);
            basis_.analysisTheta(m, elevations, theta[static_cast<std::size_t>(m)].data());
        }
        Eigen::MatrixXd matrix(static_cast<Eigen::Index>(points),
                               static_cast<Eigen::Index>(count()));
        std::vector<double> azimuths(static_cast<std::size_t>(2 * order - 1));
        for (std::size_t p = 0; p < points; ++p) {
            azimuthParts(directions[p], order, basis_.condonShortley(), azimuths.data());
            for (std::size_t j = 0; j < count(); ++j) {
                const auto [l, m] = slots_[j];
                const int abs = m < 0 ? -m : m;
                matrix(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(j)) =
                    theta[static_cast<std::size_t>(abs)]
                         [static_cast<std::size_t>(l - abs) * points + p] *
                    azimuths[static_cast<std::size_t>(order - 1 + m)];
            }
        }
        return matrix;
    }

private:
    struct Index {
        int l, m;
    };
    const Basis& basis_;
    std::vector<Index> slots_;
};

/// The weighted system of one outgoing direction.
struct System {
    Eigen::MatrixXd left, right;  ///< rows times functions, rows times channels
};

struct Solution {
    Eigen::MatrixXd moments;  ///< functions times channels
    double condition = 0;
    double missed = 0, total = 0;  ///< weighted sums of squares
};

double angleTo(const Direction& wo, const Direction& node, bool isotropic) {
    if (isotropic) return std::fabs(polarAngle(wo) - polarAngle(node));
    const Direction apart{wo.x - node.x, wo.y - node.y, wo.z - node.z};
    const Direction along{wo.x + node.x, wo.y + node.y, wo.z + node.z};
    return 2 * std::atan2(std::sqrt(dot(apart, apart)), std::sqrt(dot(along, along)));
}

System systemAt(const DirectionSamples& samples, const Rows& rows, const Direction& node,
                std::size_t nodeIndex, const AnalysisFunctions& functions,
                const LeastSquaresOptions& options) {
    const bool isotropic = samples.symmetry.isotropic;
    std::vector<double> angles(rows.wi.size());
    for (std::size_t k = 0; k < angles.size(); ++k) {
        angles[k] = angleTo(rows.wo[k], node, isotropic);
    }
    std::vector<double> sorted = angles;
    const std::size_t wanted = std::min(4 * functions.count(), sorted.size()) - 1;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(wanted),
                     sorted.end());
    const double radius =
        std::clamp(1.5 * sorted[wanted], std::min(radians(1), options.kernel), options.kernel);
    std::vector<Direction> directions;
    std::vector<std::size_t> sample;
    std::vector<double> roots;  // of the weights
    double sum = 0;
    for (std::size_t k = 0; k < angles.size(); ++k) {
        if (!(angles[k] < radius)) continue;
        const double root = 1 - (angles[k] / radius) * (angles[k] / radius);
        const double turn = isotropic ? azimuth(node) - azimuth(rows.wo[k]) : 0;
        directions.push_back(turn == 0 ? rows.wi[k] : rotateAboutZ(rows.wi[k], turn));
        sample.push_back(rows.sample[k]);
        roots.push_back(root);
        sum += root * root;
    }
    if (directions.size() < functions.count()) {
        throw NumericError(fmt::format(
            "{}: outgoing direction {} (theta {:.4g}, phi {:.4g} degrees) has {} samples within "
            "{:.3g} degrees for {} coefficients; widen the kernel, lower the order or choose other "
            "directions",
            samples.name, nodeIndex, degrees(polarAngle(node)), degrees(azimuth(node)),
            directions.size(), degrees(radius), functions.count()));
    }
    System system{functions.at(directions), {}};
    const std::size_t channels = samples.channels.count();
    system.right.resize(static_cast<Eigen::Index>(sample.size()),
                        static_cast<Eigen::Index>(channels));
    for (std::size_t k = 0; k < sample.size(); ++k) {
        const double cosine = options.quantity == Quantity::brdfCosine ? directions[k].z : 1;
        const double weight = roots[k] / std::sqrt(sum);
        const auto row = static_cast<Eigen::Index>(k);
        system.left.row(row) *= weight;
        for (std::size_t c = 0; c < channels; ++c) {
            system.right(row, static_cast<Eigen::Index>(c)) =
                weight * cosine * samples.values[sample[k] * channels + c];
        }
    }
    return system;
}

Solution solve(const System& system, double regularisation) {
    const Eigen::Index count = system.left.cols();
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(system.left);
    const Eigen::MatrixXd triangle = qr.matrixR().topRows(count).triangularView<Eigen::Upper>();
    const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(triangle).singularValues();
    Solution solution;
    const double least = singular(count - 1);
    // Singular values below rounding carry no information.
    const double smallest = singular(0) * std::numeric_limits<double>::epsilon();
    solution.condition = singular(0) / std::max(least, smallest);
    if (regularisation > 0) {
        // The same problem with R in the place of the rows, and the penalty below it.
        const double scale = singular.norm() / std::sqrt(static_cast<double>(count));
        Eigen::MatrixXd left(2 * count, count);
        left << triangle * qr.colsPermutation().transpose(),
            regularisation * scale * Eigen::MatrixXd::Identity(count, count);
        Eigen::MatrixXd right = Eigen::MatrixXd::Zero(2 * count, system.right.cols());
        right.topRows(count) = (qr.householderQ().transpose() * system.right).topRows(count);
        solution.moments = left.colPivHouseholderQr().solve(right);
    } else if (least > smallest * 10 * static_cast<double>(count)) {
        solution.moments = qr.solve(system.right);
    }
    if (solution.moments.size() > 0) {
        solution.missed = (system.left * solution.moments - system.right).squaredNorm();
        solution.total = system.right.squaredNorm();
    }
    return solution;
}

Coefficients describe(const DirectionSamples& samples, const Basis& basis,
                      const OutgoingSet& outgoing, Quantity quantity) {
    Coefficients c;
    c.basis = basis.name();
    c.order = basis.order();
    c.condonShortley = basis.condonShortley();
    c.quantity = quantity;
    c.channels = samples.channels;
    c.outgoing = outgoing;
    c.isotropic = samples.symmetry.isotropic;
    c.bilateral = samples.symmetry.mirrorSymmetric;
    c.reciprocal = samples.symmetry.reciprocal;
    c.source = samples.name;
    c.generator = std::string("hshfit ") + version;
    c.values.resize(outgoing.size() * c.channels.count() * c.slots());
    return c;
}

/// All outgoing directions in parallel; of several failures the first direction's is reported.
std::vector<Solution> solveAll(const DirectionSamples& samples, const Rows& rows,
                               const OutgoingSet& outgoing, const AnalysisFunctions& functions,
                               const LeastSquaresOptions& options) {
    std::vector<Solution> solutions(outgoing.size());
    std::vector<std::exception_ptr> failures(outgoing.size());
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, outgoing.size(), [&](std::size_t k) {
        try {
            const Direction& node = outgoing.directions[k];
            solutions[k] =
                solve(systemAt(samples, rows, node, k, functions, options), options.regularisation);
            if (solutions[k].moments.size() == 0) {
                throw NumericError(fmt::format(
                    "{}: the samples about outgoing direction {} (theta {:.4g}, phi {:.4g} "
                    "degrees) do not determine {} coefficients; regularise, or lower the order",
                    samples.name, k, degrees(polarAngle(node)), degrees(azimuth(node)),
                    functions.count()));
            }
        } catch (...) {
            failures[k] = std::current_exception();
        }
        ++done;
        if (options.progress) options.progress(done, outgoing.size());
    });
    for (const std::exception_ptr& failure : failures) {
        if (failure) std::rethrow_exception(failure);
    }
    return solutions;
}

}  // namespace

LeastSquaresProjection projectLeastSquares(const DirectionSamples& samples, const Basis& basis,
                                           const OutgoingSet& outgoing,
                                           const LeastSquaresOptions& options) {
    if (outgoing.map == OutgoingSet::Map::elevations && !samples.symmetry.isotropic) {
        throw UsageError(fmt::format(
            "{} is anisotropic: outgoing elevations alone do not describe it; give a map (32x32)",
            samples.name));
    }
    if (samples.wi.empty()) throw NumericError(samples.name + ": has no samples");
    const Rows rows = expand(samples);
    const AnalysisFunctions functions(basis);
    const std::vector<Solution> solutions = solveAll(samples, rows, outgoing, functions, options);

    LeastSquaresProjection projection;
    projection.samples = rows.wi.size();
    Coefficients& out = projection.coefficients;
    out = describe(samples, basis, outgoing, options.quantity);
    std::vector<double> moments(out.slots());
    double missed = 0, total = 0, condition = 0;
    for (std::size_t k = 0; k < solutions.size(); ++k) {
        for (std::size_t c = 0; c < out.channels.count(); ++c) {
            std::ranges::fill(moments, 0.0);
            for (std::size_t j = 0; j < functions.count(); ++j) {
                moments[functions.slot(j)] = solutions[k].moments(static_cast<Eigen::Index>(j),
                                                                  static_cast<Eigen::Index>(c));
            }
            basis.coefficientsFromMoments(moments.data(), basis.order(), out.at(k, c));
            out.energy.value +=
                outgoing.solidAngles[k] * basis.capturedEnergy(moments.data(), basis.order());
        }
        missed += solutions[k].missed;
        total += solutions[k].total;
        condition = std::max(condition, solutions[k].condition);
    }
    out.error = total > 0 ? std::sqrt(missed / total) : 0;
    out.energy.error = out.error * out.energy.value;
    out.leastSquares = LeastSquaresNote{.regularisation = options.regularisation,
                                        .kernelDegrees = degrees(options.kernel),
                                        .condition = condition,
                                        .residual = out.error,
                                        .samples = samples.wi.size()};
    return projection;
}

}  // namespace hshfit::inline projection
