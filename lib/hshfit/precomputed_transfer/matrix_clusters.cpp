#include <hshfit/precomputed_transfer/matrix_clusters.h>

#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/transport/random_numbers.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hshfit::inline precomputed_transfer {
namespace {

using Matrix = linear_algebra::RowMajor;
using Rows =
    Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
using Members = std::vector<std::uint32_t>;

constexpr Eigen::Index coordinates = 24;
constexpr int powerSteps = 10, meansSteps = 12;
/// Clusters that a vertex may change to: the nearest ones.
constexpr std::size_t candidates = 6;

/// A mean and its principal components, one a row.
struct Principal {
    Eigen::RowVectorXd mean;
    Matrix components;
};

Matrix centred(const Rows& all, const Members& members, const Eigen::RowVectorXd& mean) {
    Matrix some(static_cast<Eigen::Index>(members.size()), all.cols());
    for (std::size_t k = 0; k < members.size(); ++k)
        some.row(static_cast<Eigen::Index>(k)) = all.row(members[k]).cast<double>() - mean;
    return some;
}

/// Orthonormal columns with the same span as the columns of `a`.
Matrix orthonormal(const Matrix& a) {
    const Eigen::HouseholderQR<Matrix> qr(a);
    return qr.householderQ() * Matrix::Identity(a.rows(), a.cols());
}

/// The mean and the principal components of some matrices. Subspace iteration finds the space that
/// the components span; the eigenvectors of the covariance in that space are the components.
Principal principalOf(const Rows& all, const Members& members, std::size_t wanted) {
    Principal result;
    result.mean = Eigen::RowVectorXd::Zero(all.cols());
    for (const std::uint32_t v : members) result.mean += all.row(v).cast<double>();
    if (!members.empty()) result.mean /= static_cast<double>(members.size());
    const auto number = static_cast<Eigen::Index>(wanted);
    result.components = Matrix::Zero(number, all.cols());
    const Eigen::Index rank =
        std::min({number, static_cast<Eigen::Index>(members.size()) - 1, all.cols()});
    if (rank < 1) return result;
    const Matrix some = centred(all, members, result.mean);
    RandomNumbers random(1, members.size());
    Matrix span(all.cols(), rank);
    for (Eigen::Index i = 0; i < span.size(); ++i) span.data()[i] = random.next() - 0.5;
    span = orthonormal(span);
    for (int step = 0; step < powerSteps; ++step)
        span = orthonormal(some.transpose() * (some * span));
    const Matrix seen = some * span;
    const Eigen::MatrixXd covariance = seen.transpose() * seen;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(covariance);
    // Eigenvalues rise.
    const Matrix turned = span * axes.eigenvectors().rowwise().reverse();
    result.components.topRows(rank) = turned.transpose();
    return result;
}

/// The nearest of some centres, and others in the order of their distance.
std::vector<std::size_t> nearest(const Matrix& centres, const Eigen::RowVectorXd& at,
                                 std::size_t number) {
    std::vector<std::pair<double, std::size_t>> order;
    for (Eigen::Index c = 0; c < centres.rows(); ++c)
        order.emplace_back((centres.row(c) - at).squaredNorm(), static_cast<std::size_t>(c));
    number = std::min(number, order.size());
    std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(number));
    std::vector<std::size_t> result;
    for (std::size_t k = 0; k < number; ++k) result.push_back(order[k].second);
    return result;
}

class Clustering {
public:
    Clustering(const Rows& all, const ClusterOptions& options)
        : all_(all),
          options_(options),
          count_(static_cast<std::size_t>(all.rows())),
          clusters_(std::min(options.clusters, count_)),
          of_(count_) {}

    MatrixClusters run() {
        reduce();
        meansOf();
        for (int round = 0; round <= options_.rounds; ++round) {
            fitClusters();
            if (round < options_.rounds) reassign();
            if (options_.progress)
                options_.progress(static_cast<std::size_t>(round) + 1,
                                  static_cast<std::size_t>(options_.rounds) + 1);
        }
        return result();
    }

private:
    void reduce() {
        Members members(count_);
        std::iota(members.begin(), members.end(), 0U);
        // Principal axes of at most 2,000 vertices, evenly through the list.
        Members some;
        for (std::size_t k = 0; k < std::min<std::size_t>(count_, 2000); ++k)
            some.push_back(members[k * count_ / std::min<std::size_t>(count_, 2000)]);
        const Principal principal = principalOf(all_, some, coordinates);
        places_.resize(all_.rows(), coordinates);
        tbb::parallel_for(Eigen::Index{0}, all_.rows(), [&](Eigen::Index v) {
            places_.row(v) =
                (all_.row(v).cast<double>() - principal.mean) * principal.components.transpose();
        });
    }

    void meansOf() {
        centres_.resize(static_cast<Eigen::Index>(clusters_), coordinates);
        for (std::size_t c = 0; c < clusters_; ++c)
            centres_.row(static_cast<Eigen::Index>(c)) =
                places_.row(static_cast<Eigen::Index>(c * count_ / clusters_));
        for (int step = 0; step < meansSteps; ++step) {
            tbb::parallel_for(std::size_t{0}, count_, [&](std::size_t v) {
                of_[v] = static_cast<std::uint32_t>(
                    nearest(centres_, places_.row(static_cast<Eigen::Index>(v)), 1)[0]);
            });
            moveCentres();
        }
    }

    void moveCentres() {
        Matrix sums = Matrix::Zero(centres_.rows(), coordinates);
        std::vector<double> number(clusters_);
        for (std::size_t v = 0; v < count_; ++v) {
            sums.row(of_[v]) += places_.row(static_cast<Eigen::Index>(v));
            number[of_[v]] += 1;
        }
        for (std::size_t c = 0; c < clusters_; ++c)
            if (number[c] > 0)
                centres_.row(static_cast<Eigen::Index>(c)) =
                    sums.row(static_cast<Eigen::Index>(c)) / number[c];
    }

    void fitClusters() {
        members_.assign(clusters_, {});
        for (std::size_t v = 0; v < count_; ++v)
            members_[of_[v]].push_back(static_cast<std::uint32_t>(v));
        fits_.resize(clusters_);
        tbb::parallel_for(std::size_t{0}, clusters_, [&](std::size_t c) {
            fits_[c] = principalOf(all_, members_[c], options_.components);
        });
        moveCentres();
    }

    void reassign() {
        tbb::parallel_for(std::size_t{0}, count_, [&](std::size_t v) {
            const auto row = static_cast<Eigen::Index>(v);
            double best = -1;
            for (const std::size_t c : nearest(centres_, places_.row(row), candidates)) {
                const Eigen::RowVectorXd gap = all_.row(row).cast<double>() - fits_[c].mean;
                const double left =
                    gap.squaredNorm() - (gap * fits_[c].components.transpose()).squaredNorm();
                if (best >= 0 && left >= best) continue;
                best = left;
                of_[v] = static_cast<std::uint32_t>(c);
            }
        });
    }

    MatrixClusters result() const {
        const std::size_t dimension = static_cast<std::size_t>(all_.cols());
        const std::size_t components = options_.components;
        MatrixClusters out{.clusters = clusters_, .components = components, .dimension = dimension};
        for (const Principal& fit : fits_) {
            for (Eigen::Index i = 0; i < all_.cols(); ++i)
                out.means.push_back(static_cast<float>(fit.mean[i]));
            for (Eigen::Index i = 0; i < fit.components.size(); ++i)
                out.basis.push_back(static_cast<float>(fit.components.data()[i]));
        }
        out.of = of_;
        out.weights.resize(count_ * components);
        // [vertex][components]: squares that are left.
        std::vector<double> left(count_ * (components + 1));
        tbb::parallel_for(std::size_t{0}, count_, [&](std::size_t v) {
            const Principal& fit = fits_[of_[v]];
            const Eigen::RowVectorXd gap =
                all_.row(static_cast<Eigen::Index>(v)).cast<double>() - fit.mean;
            const Eigen::RowVectorXd weights = gap * fit.components.transpose();
            double rest = gap.squaredNorm();
            left[v * (components + 1)] = rest;
            for (std::size_t k = 0; k < components; ++k) {
                const double w = weights[static_cast<Eigen::Index>(k)];
                out.weights[v * components + k] = static_cast<float>(w);
                rest = std::max(0.0, rest - w * w);
                left[v * (components + 1) + k + 1] = rest;
            }
        });
        const double whole = all_.cast<double>().squaredNorm();
        for (std::size_t k = 0; k <= components; ++k)
            out.errors.push_back(errorOf(left, whole, k, components, dimension));
        return out;
    }

    ClusterError errorOf(const std::vector<double>& left, double whole, std::size_t k,
                         std::size_t components, std::size_t dimension) const {
        ClusterError error{.clusters = clusters_, .components = k};
        error.bytes = 4 * (clusters_ * (1 + k) * dimension + count_ * (k + 1));
        double sum = 0, most = 0;
        for (std::size_t v = 0; v < count_; ++v) {
            const double rest = left[v * (components + 1) + k];
            sum += rest;
            if (rest <= most) continue;
            most = rest;
            error.vertex = static_cast<std::uint32_t>(v);
        }
        if (!(whole > 0)) return error;
        error.relativeL2 = std::sqrt(sum / whole);
        error.largest = std::sqrt(most * static_cast<double>(count_) / whole);
        return error;
    }

    Rows all_;
    const ClusterOptions& options_;
    std::size_t count_, clusters_;
    std::vector<std::uint32_t> of_;
    Matrix places_, centres_;
    std::vector<Members> members_;
    std::vector<Principal> fits_;
};

}  // namespace

MatrixClusters MatrixClusters::truncated(std::size_t fewer) const {
    MatrixClusters out{.clusters = clusters,
                       .components = std::min(fewer, components),
                       .dimension = dimension,
                       .means = means,
                       .of = of};
    const std::size_t number = out.components;
    for (std::size_t c = 0; c < clusters; ++c) {
        const auto first = basis.begin() + static_cast<std::ptrdiff_t>(c * components * dimension);
        out.basis.insert(out.basis.end(), first,
                         first + static_cast<std::ptrdiff_t>(number * dimension));
    }
    for (std::size_t v = 0; v < of.size(); ++v) {
        const auto first = weights.begin() + static_cast<std::ptrdiff_t>(v * components);
        out.weights.insert(out.weights.end(), first, first + static_cast<std::ptrdiff_t>(number));
    }
    out.errors.assign(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(number + 1));
    return out;
}

std::vector<float> MatrixClusters::matrix(std::size_t vertex) const {
    const std::size_t c = of[vertex];
    std::vector<float> out(means.begin() + static_cast<std::ptrdiff_t>(c * dimension),
                           means.begin() + static_cast<std::ptrdiff_t>((c + 1) * dimension));
    for (std::size_t k = 0; k < components; ++k) {
        const float* row = basis.data() + (c * components + k) * dimension;
        const float weight = weights[vertex * components + k];
        for (std::size_t i = 0; i < dimension; ++i) out[i] += weight * row[i];
    }
    return out;
}

MatrixClusters clusterMatrices(const TransferView& transfer, const ClusterOptions& options) {
    const std::size_t dimension = transfer.channels * transfer.localSlots() * transfer.slots();
    if (transfer.matrices.empty() || dimension == 0 || options.clusters == 0) {
        throw UsageError(fmt::format("{} clusters of {} matrices; both have to be 1 or more",
                                     options.clusters,
                                     dimension == 0 ? 0 : transfer.matrices.size() / dimension));
    }
    const Rows all(transfer.matrices.data(),
                   static_cast<Eigen::Index>(transfer.matrices.size() / dimension),
                   static_cast<Eigen::Index>(dimension));
    return Clustering(all, options).run();
}

}  // namespace hshfit::inline precomputed_transfer
