#include <hshfit/rotation/basis_change.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/bases/jacobi.h>
#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/stop_request.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace hshfit::inline rotation {
namespace {

using Matrix = linear_algebra::RowMajor;

/// Blocks are kept while all of them have no more doubles than this (32 MiB).
constexpr std::size_t keptDoubles = std::size_t{1} << 22;
constexpr std::size_t denseDoubles = std::size_t{1} << 26;

/// Theta parts of one m are polynomials in mu times sqrt(mu)^k, sqrt(1 - mu)^m and, for functions
/// of the whole sphere, sqrt(1 + mu)^m: k modulo 2, if it is known.
std::optional<int> rootsOfCosine(const Basis& basis, int m) {
    const auto* jacobi = dynamic_cast<const bases::JacobiBasis*>(&basis);
    if (!jacobi) return {};
    const bases::JacobiFamily& family = jacobi->family();
    const bool hump = family.factor == bases::JacobiFamily::Factor::hump;
    return ((hump ? m : 0) + (family.timesRootCosine ? 1 : 0)) % 2;
}

struct Nodes {
    std::vector<Elevation<double>> points;
    std::vector<double> weights;  ///< of d mu, times mu for Inner::projectedSolidAngle
};

/// Nodes for products of one m. sqrt(1 + mu), where it is left, has its branch point at mu = -1,
/// which costs 24 nodes.
Nodes nodesFor(const Basis& from, const Basis& to, Basis::Inner weighting, int m) {
    const bool projected = weighting == Basis::Inner::projectedSolidAngle;
    Nodes nodes;
    const auto add = [&](double mu, double oneMinusMu, double weight) {
        nodes.points.push_back({mu, oneMinusMu});
        nodes.weights.push_back(weight * (projected ? mu : 1));
    };
    const auto a = rootsOfCosine(from, m), b = rootsOfCosine(to, m);
    const int degree = bases::highestDegree(from) + bases::highestDegree(to) + 2;
    if (a && b && (*a + *b) % 2 == 0) {
        // A polynomial in mu.
        const GaussRule& rule = gaussLegendre(degree / 2 + 24);
        for (std::size_t i = 0; i < rule.nodes.size(); ++i)
            add((1 + rule.nodes[i]) / 2, (1 - rule.nodes[i]) / 2, rule.weights[i] / 2);
        return nodes;
    }
    // sqrt(mu) times one is even in u = sqrt(mu) after d mu = 2 u du: half a rule on [-1, 1].
    const bool even = a && b;
    const GaussRule& rule = gaussLegendre(even ? degree + 48 : degree + 32);
    for (std::size_t i = even ? rule.nodes.size() / 2 : 0; i < rule.nodes.size(); ++i) {
        const double x = rule.nodes[i], u = even ? x : (1 + x) / 2;
        add(u * u, (even ? 1 - x : (1 - x) / 2) * (1 + u), rule.weights[i] * u * (even ? 2 : 1));
    }
    return nodes;
}

/// Theta parts of both bases at some of the nodes: a row a function.
struct Values {
    Matrix from, to;  ///< `to` times the weights
};

/// Calls visit(values) for the nodes of one m, chunk by chunk.
template <class Visit>
void eachChunk(const Basis& from, const Basis& to, Basis::Inner weight, int m, Visit visit) {
    constexpr std::size_t chunk = 64;
    const Nodes nodes = nodesFor(from, to, weight, m);
    for (std::size_t first = 0; first < nodes.points.size(); first += chunk) {
        const std::size_t n = std::min(chunk, nodes.points.size() - first);
        const auto points = std::span(nodes.points).subspan(first, n);
        const auto columns = static_cast<Eigen::Index>(n);
        Values values{Matrix(from.order() - m, columns), Matrix(to.order() - m, columns)};
        from.theta(m, points, values.from.data());
        to.analysisTheta(m, points, values.to.data());
        const Eigen::Map<const Eigen::RowVectorXd> weights(nodes.weights.data() + first, columns);
        values.to.array().rowwise() *= weights.array();
        visit(values);
    }
}

/// Coefficients of m and -m in slots of `order` bands: rows l, a column a vector and sign.
Matrix gather(int m, int order, std::size_t vectors, const double* in) {
    const int signs = m == 0 ? 1 : 2;
    const auto slots = static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
    Matrix result(order - m, static_cast<Eigen::Index>(vectors) * signs);
    for (int l = m; l < order; ++l)
        for (Eigen::Index c = 0; c < result.cols(); ++c)
            result(l - m, c) = in[static_cast<std::size_t>(c / signs) * slots +
                                  static_cast<std::size_t>(slotOf(l, c % signs == 0 ? m : -m))];
    return result;
}

void scatter(int m, int order, const Matrix& values, double* out) {
    const int signs = m == 0 ? 1 : 2;
    const auto slots = static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
    for (int l = m; l < order; ++l)
        for (Eigen::Index c = 0; c < values.cols(); ++c)
            out[static_cast<std::size_t>(c / signs) * slots +
                static_cast<std::size_t>(slotOf(l, c % signs == 0 ? m : -m))] = values(l - m, c);
}

}  // namespace

struct BasisChange::Parts {
    std::unique_ptr<Basis> from, to;
    Basis::Inner weight = Basis::Inner::solidAngle;
    std::vector<std::vector<double>> kept = {};  ///< by m, if all are

    int blocks() const { return std::min(from->order(), to->order()); }

    double signOf(int m) const {
        return m % 2 != 0 && from->condonShortley() != to->condonShortley() ? -1 : 1;
    }

    std::vector<double> make(int m) const {
        Matrix sum = Matrix::Zero(to->order() - m, from->order() - m);
        eachChunk(*from, *to, weight, m, [&](const Values& values) {
            sum.noalias() += signOf(m) * values.to * values.from.transpose();
        });
        return {sum.data(), sum.data() + sum.size()};
    }

    /// Column by column for all m at once: the solve of TO takes moments in slots.
    void solve() {
        const auto slots = static_cast<std::size_t>(to->slots());
        std::vector<double> moments(slots), solved(slots);
        for (int column = 0; column < from->order(); ++column) {
            std::fill(moments.begin(), moments.end(), 0.0);
            const auto each = [&](auto visit) {
                for (int m = 0; m < blocks() && m + column < from->order(); ++m)
                    for (int l = m; l < to->order(); ++l)
                        visit(kept[static_cast<std::size_t>(m)][static_cast<std::size_t>(
                                  (l - m) * (from->order() - m) + column)],
                              static_cast<std::size_t>(slotOf(l, m)));
            };
            each([&](double& entry, std::size_t slot) { moments[slot] = entry; });
            to->coefficientsFromMoments(moments.data(), to->order(), solved.data());
            each([&](double& entry, std::size_t slot) { entry = solved[slot]; });
        }
    }

    void apply(bool transposed, std::size_t vectors, const double* in, double* out) const {
        const int orderIn = (transposed ? to : from)->order();
        const int orderOut = (transposed ? from : to)->order();
        std::fill_n(out, vectors * static_cast<std::size_t>(orderOut * orderOut), 0.0);
        tbb::parallel_for(0, blocks(), [&](int m) {
            stopIfRequested();
            const Matrix c = gather(m, orderIn, vectors, in);
            Matrix sum = Matrix::Zero(orderOut - m, c.cols());
            if (!kept.empty()) {
                const Eigen::Map<const Matrix> block(kept[static_cast<std::size_t>(m)].data(),
                                                     to->order() - m, from->order() - m);
                if (transposed)
                    sum.noalias() = block.transpose() * c;
                else
                    sum.noalias() = block * c;
            } else {
                eachChunk(*from, *to, weight, m, [&](const Values& values) {
                    const Matrix &a = transposed ? values.to : values.from,
                                 &b = transposed ? values.from : values.to;
                    const Matrix function = signOf(m) * (a.transpose() * c);
                    sum.noalias() += b * function;
                });
            }
            scatter(m, orderOut, sum, out);
        });
    }
};

BasisChange::BasisChange(const Basis& from, const Basis& to, std::optional<Basis::Inner> weight)
    : parts_(std::make_unique<Parts>()) {
    parts_->weight = weight.value_or(to.inner());
    const auto copyOf = [](const Basis& basis) {
        return bases::find(basis.name())
            .make(basis.order(), {.condonShortley = basis.condonShortley()});
    };
    parts_->from = copyOf(from);
    parts_->to = copyOf(to);
    const bool solved = !bases::find(to.name()).orthonormal;
    std::size_t doubles = 0;
    for (int m = 0; m < parts_->blocks(); ++m)
        doubles +=
            static_cast<std::size_t>(from.order() - m) * static_cast<std::size_t>(to.order() - m);
    if (doubles <= keptDoubles || solved) {
        parts_->kept.resize(static_cast<std::size_t>(parts_->blocks()));
        std::vector<std::vector<double>> made(parts_->kept.size());
        tbb::parallel_for(0, parts_->blocks(), [&](int m) {
            stopIfRequested();
            made[static_cast<std::size_t>(m)] = parts_->make(m);
        });
        parts_->kept = std::move(made);
    }
    if (solved) parts_->solve();
}
BasisChange::~BasisChange() = default;
BasisChange::BasisChange(BasisChange&&) noexcept = default;
BasisChange& BasisChange::operator=(BasisChange&&) noexcept = default;

int BasisChange::fromOrder() const {
    return parts_->from->order();
}
int BasisChange::toOrder() const {
    return parts_->to->order();
}

std::vector<double> BasisChange::block(int m) const {
    assert(std::abs(m) < parts_->blocks());
    if (!parts_->kept.empty()) return parts_->kept[static_cast<std::size_t>(std::abs(m))];
    return parts_->make(std::abs(m));
}

void BasisChange::apply(std::size_t vectors, const double* in, double* out) const {
    parts_->apply(false, vectors, in, out);
}

void BasisChange::applyTransposed(std::size_t vectors, const double* in, double* out) const {
    parts_->apply(true, vectors, in, out);
}

std::vector<double> BasisChange::dense() const {
    const auto rows = static_cast<std::size_t>(parts_->to->slots()),
               columns = static_cast<std::size_t>(parts_->from->slots());
    if (rows * columns > denseDoubles)
        throw UsageError(fmt::format(
            "a matrix of {} x {} entries; at most {} in all: its blocks by m are smaller", rows,
            columns, denseDoubles));
    std::vector<double> result(rows * columns, 0.0);
    for (int m = 0; m < parts_->blocks(); ++m) {
        const std::vector<double> entries = block(m);
        const auto width = static_cast<std::size_t>(fromOrder() - m);
        for (std::size_t i = 0; i < entries.size(); ++i)
            for (const int order : {m, -m}) {
                const int l = m + static_cast<int>(i / width), k = m + static_cast<int>(i % width);
                result[static_cast<std::size_t>(slotOf(l, order)) * columns +
                       static_cast<std::size_t>(slotOf(k, order))] = entries[i];
            }
    }
    return result;
}

}  // namespace hshfit::inline rotation
