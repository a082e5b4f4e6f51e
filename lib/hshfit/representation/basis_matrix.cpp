#include <hshfit/representation/basis_matrix.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/projection/one_basis.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/representation/factoring_blocks.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace hshfit::inline representation {
namespace {

constexpr double halfRoot = 1 / std::numbers::sqrt2;

void addIsotropic(const Basis& basis, const ProductSymmetry& symmetry,
                  std::vector<ProductTerm>& terms) {
    const int order = basis.order();
    for (int m = 0; m < order; ++m) {
        for (int l = m; l < order; ++l) {
            for (int k = symmetry.reciprocal ? l : m; k < order; ++k) {
                if (!basis.has(l, m) || !basis.has(k, m)) continue;
                terms.push_back({l, m, k, m, false});
                const bool vanishes = m == 0 || (symmetry.reciprocal && l == k);
                if (!symmetry.bilateral && !vanishes) terms.push_back({l, m, k, m, true});
            }
        }
    }
}

void addAnisotropic(const Basis& basis, const ProductSymmetry& symmetry,
                    std::vector<ProductTerm>& terms) {
    const int slots = basis.slots();
    std::vector<std::pair<int, int>> functions;
    for (int l = 0; l * l < slots; ++l) {
        for (int m = -l; m <= l; ++m) {
            if (basis.has(l, m)) functions.emplace_back(l, m);
        }
    }
    for (std::size_t a = 0; a < functions.size(); ++a) {
        for (std::size_t b = symmetry.reciprocal ? a : 0; b < functions.size(); ++b) {
            const auto [l, m] = functions[a];
            const auto [k, p] = functions[b];
            const bool mirrored = (m < 0) == (p < 0) && (m + p) % 2 == 0;
            if (!symmetry.bilateral || mirrored) terms.push_back({l, m, k, p, false});
        }
    }
}

/// The product function before it is made reciprocal.
double onesided(const ProductTerm& t, bool isotropic, const double* wi, const double* wo) {
    if (!isotropic || t.m == 0) return wi[slotOf(t.l, t.m)] * wo[slotOf(t.k, t.p)];
    const double* a = wi + slotOf(t.l, 0);
    const double* b = wo + slotOf(t.k, 0);
    return halfRoot *
           (t.sine ? a[t.m] * b[-t.m] - a[-t.m] * b[t.m] : a[t.m] * b[t.m] + a[-t.m] * b[-t.m]);
}

/// Adds value times the one-sided function, as coefficients over wi.
void addOnesided(const ProductTerm& t, bool isotropic, double value, const double* wo,
                 double* out) {
    if (!isotropic || t.m == 0) {
        out[slotOf(t.l, t.m)] += value * wo[slotOf(t.k, t.p)];
        return;
    }
    double* a = out + slotOf(t.l, 0);
    const double* b = wo + slotOf(t.k, 0);
    a[t.m] += halfRoot * value * (t.sine ? b[-t.m] : b[t.m]);
    a[-t.m] += halfRoot * value * (t.sine ? -b[t.m] : b[-t.m]);
}

/// The same function with wi and wo exchanged. A sine term changes its sign with its places:
/// B_{l,m}(wo) B_{k,-m}(wi) - B_{l,-m}(wo) B_{k,m}(wi) is minus the term of (k, l).
void addExchanged(const ProductTerm& t, bool isotropic, double value, const double* wo,
                  double* out) {
    const double sign = isotropic && t.sine ? -1 : 1;
    addOnesided({t.k, t.p, t.l, t.m, t.sine}, isotropic, sign * value, wo, out);
}

/// The outgoing directions of one elevation, with their weights.
OutgoingSet ringAt(double u, double weight, int quarter) {
    OutgoingSet set;
    set.map = OutgoingSet::Map::parabolic;  // any but elevations; only directions and weights count
    const double mu = u * u, s = std::sqrt((1 - mu) * (1 + mu));
    if (quarter == 0) {
        set.directions = {{s, 0, mu}};
        set.solidAngles = {weight};
        return set;
    }
    // Mirrored copies of one quadrant, so that symmetric directions agree to the last bit.
    for (int j = 0; j < quarter; ++j) {
        const double phi = (j + 0.5) * (pi / 2) / quarter;
        for (double sx : {1.0, -1.0}) {
            for (double sy : {1.0, -1.0}) {
                set.directions.push_back({sx * s * std::cos(phi), sy * s * std::sin(phi), mu});
                set.solidAngles.push_back(weight / (4 * quarter));
            }
        }
    }
    set.width = static_cast<int>(set.size());
    return set;
}

/// One level of the outer quadrature: rings of outgoing directions and what they weigh together.
struct OuterGrid {
    std::vector<OutgoingSet> rings;
    std::vector<double> weights;
};

OuterGrid outerGrid(const Basis& basis, bool isotropic, int level) {
    const double growth = std::pow(1.5, level);
    const int rings = static_cast<int>(std::ceil((basis.order() + 6) * growth));
    const int quarter =
        isotropic ? 0 : static_cast<int>(std::ceil((basis.order() + 4) / 2.0 * growth));
    const GaussRule& rule = gaussLegendre(rings);
    OuterGrid grid;
    for (int r = 0; r < rings; ++r) {
        const double u = (1 + rule.nodes[r]) / 2;
        double weight = rule.weights[r] / 2 * 2 * u * 2 * pi;
        if (basis.inner() == Basis::Inner::projectedSolidAngle) weight *= u * u;
        grid.rings.push_back(ringAt(u, weight, quarter));
        grid.weights.push_back(weight);
    }
    return grid;
}

/// Projections over wi of every ring. Each is asked for the tolerance that its weight calls for:
/// grazing rings, which weigh next to nothing, are the hardest of all.
std::vector<Projection> projectRings(const Brdf& brdf, const Basis& basis, const OuterGrid& grid,
                                     const ProjectionOptions& options) {
    constexpr double loosest = 0.1;
    const double heaviest = *std::max_element(grid.weights.begin(), grid.weights.end());
    std::vector<Projection> results(grid.rings.size());
    std::atomic<std::size_t> done = 0;
    eachInParallel(results.size(), [&](std::size_t r) {
        ProjectionOptions own = options;
        own.progress = {};
        own.tolerance = std::clamp(options.tolerance * heaviest / grid.weights[r],
                                   options.tolerance, std::max(loosest, options.tolerance));
        results[r] = project(brdf, basis, grid.rings[r], own);
        results[r].coefficients.error *= grid.weights[r] / heaviest;
        if (options.progress) options.progress(++done, results.size());
    });
    return results;
}

/// Adds to [channel][term] what the coefficients of one ring hold: a product function is linear in
/// what it takes of wi, so that coefficients over wi can stand for the basis values there.
void gather(const Coefficients& c, const Basis& basis, const std::vector<ProductTerm>& terms,
            const ProductSymmetry& symmetry, std::vector<double>& sums) {
    std::vector<double> products(terms.size()), atWo(basis.slots());
    for (std::size_t o = 0; o < c.outgoing.size(); ++o) {
        basis.evaluate(c.outgoing.directions[o], atWo.data());
        for (std::size_t channel = 0; channel < c.channels.count(); ++channel) {
            evaluateProducts(terms, symmetry, c.at(o, channel), atWo.data(), products.data());
            double* out = sums.data() + channel * terms.size();
            for (std::size_t t = 0; t < terms.size(); ++t) {
                out[t] += c.outgoing.solidAngles[o] * products[t];
            }
        }
    }
}

/// The fields common to all rings, with the energies of the rings added up.
CoefficientHead headOf(const std::vector<Projection>& rings) {
    CoefficientHead head = rings[0].coefficients;
    for (std::size_t r = 1; r < rings.size(); ++r) {
        const Coefficients& c = rings[r].coefficients;
        head.energy.value += c.energy.value;
        head.energy.error += c.energy.error;
        if (head.energy.finite && !c.energy.finite) {
            head.energy.finite = false;
            head.energy.reason = c.energy.reason;
        }
        head.error = std::max(head.error, c.error);
    }
    head.outgoing = {};
    return head;
}

double relativeChange(const std::vector<double>& now, const std::vector<double>& before) {
    double change = 0, norm = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
        change += (now[i] - before[i]) * (now[i] - before[i]);
        norm += now[i] * now[i];
    }
    return norm > 0 ? std::sqrt(change / norm) : std::sqrt(change);
}

bool isOrthonormal(const Basis& basis) {
    return bases::find(basis.name()).orthonormal;
}

}  // namespace

std::vector<ProductTerm> productTerms(const Basis& basis, const ProductSymmetry& symmetry) {
    std::vector<ProductTerm> terms;
    if (symmetry.isotropic) {
        addIsotropic(basis, symmetry, terms);
    } else {
        addAnisotropic(basis, symmetry, terms);
    }
    const auto key = [](const ProductTerm& t) {
        return std::tuple(std::max(t.l, t.k), t.k, t.l, t.m, t.p, t.sine);
    };
    std::sort(terms.begin(), terms.end(),
              [&](const ProductTerm& a, const ProductTerm& b) { return key(a) < key(b); });
    return terms;
}

std::size_t productTermCount(const Basis& basis, const ProductSymmetry& symmetry) {
    // Isotropic: functions of the same m may be paired. Anisotropic and bilateral: two cosines or
    // two sines with the same parity of m. Otherwise all functions.
    std::map<int, std::size_t> classes;
    for (int l = 0; l < basis.order(); ++l) {
        for (int m = symmetry.isotropic ? 0 : -l; m <= l; ++m) {
            if (!basis.has(l, m)) continue;
            const int parity = symmetry.bilateral ? 2 * (m < 0) + std::abs(m) % 2 : 0;
            ++classes[symmetry.isotropic ? m : parity];
        }
    }
    std::size_t count = 0;
    for (const auto& [key, n] : classes) {
        count += symmetry.reciprocal ? n * (n + 1) / 2 : n * n;
        const bool sines = symmetry.isotropic && !symmetry.bilateral && key > 0;
        if (sines) count += symmetry.reciprocal ? n * (n - 1) / 2 : n * n;
    }
    return count;
}

void evaluateProducts(const std::vector<ProductTerm>& terms, const ProductSymmetry& symmetry,
                      const double* atWi, const double* atWo, double* out) {
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const ProductTerm& t = terms[i];
        out[i] = onesided(t, symmetry.isotropic, atWi, atWo);
        if (!symmetry.reciprocal) continue;
        const bool same = t.l == t.k && t.m == t.p;
        if (!same) out[i] = halfRoot * (out[i] + onesided(t, symmetry.isotropic, atWo, atWi));
    }
}

void contractWithOutgoing(const std::vector<ProductTerm>& terms, const ProductSymmetry& symmetry,
                          const double* values, const double* atWo, double* out) {
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const ProductTerm& t = terms[i];
        const bool doubled = symmetry.reciprocal && !(t.l == t.k && t.m == t.p);
        const double value = doubled ? halfRoot * values[i] : values[i];
        addOnesided(t, symmetry.isotropic, value, atWo, out);
        if (doubled) addExchanged(t, symmetry.isotropic, value, atWo, out);
    }
}

Representation projectBoth(const Brdf& brdf, const Basis& basis, bool reciprocal,
                           const ProjectionOptions& options) {
    if (!isOrthonormal(basis)) {
        throw UsageError(fmt::format(
            "{} is not orthonormal: both directions in one basis need one that is, such as hsh",
            basis.name()));
    }
    if (reciprocal && options.quantity == Quantity::brdfCosine) {
        throw UsageError(fmt::format(
            "f cos(theta_i) is not symmetric in its directions: leave out {} or {}",
            Setting{"ProjectionOptions::quantity", "brdf_cosine"}, Setting{"Form::reciprocal"}));
    }
    constexpr int lastLevel = 5;
    const double tolerance =
        options.tolerance > 0 ? options.tolerance : std::max(1e-4, brdf.defaultTolerance());
    const ProductSymmetry symmetry{brdf.laws().isotropic, brdf.laws().mirrorSymmetric, reciprocal};
    const std::vector<ProductTerm> terms = productTerms(basis, symmetry);
    ProjectionOptions inner = options;
    inner.tolerance = tolerance / 4;

    Representation result;
    StoredArray matrix{.shape = {brdf.channels().count(), terms.size()}, .values = {}};
    double change = 0;
    for (int level = 0; level <= lastLevel; ++level) {
        const OuterGrid grid = outerGrid(basis, symmetry.isotropic, level);
        const std::vector<Projection> rings = projectRings(brdf, basis, grid, inner);
        std::vector<double> values(matrix.shape[0] * terms.size(), 0.0);
        for (const Projection& ring : rings) {
            gather(ring.coefficients, basis, terms, symmetry, values);
        }
        change = level > 0 ? relativeChange(values, matrix.values) : 1;
        matrix.values = std::move(values);
        if (level == 0 || change > tolerance) continue;
        result.head = headOf(rings);
        result.head.reciprocal = reciprocal;
        result.head.tolerance = tolerance;
        result.head.error = std::max(result.head.error, change);
        result.content = MatrixArray{std::move(matrix)};
        return result;
    }
    throw NumericError(fmt::format(
        "{}: both directions in {} of order {} did not converge over the outgoing directions: the "
        "last change is {:.1e}, {:.1e} was asked for ({})",
        brdf.name(), basis.name(), basis.order(), change, tolerance,
        Setting{"ProjectionOptions::tolerance"}));
}

std::vector<double> matrixValues(const Representation& matrix) {
    if (const auto* whole = matrix.as<MatrixArray>()) return whole->matrix.values;
    const CoefficientHead& head = matrix.head;
    const auto basis = bases::make(head.basis, head.order, {.condonShortley = head.condonShortley});
    return multipliedOut(matrix, productTerms(*basis, symmetryOf(matrix)));
}

ProductSymmetry symmetryOf(const Representation& matrix) {
    return {matrix.head.isotropic, matrix.head.bilateral, matrix.head.reciprocal};
}

Representation truncated(const Representation& matrix, int order) {
    const auto basis = bases::make(matrix.head.basis, matrix.head.order);
    if (!bases::find(matrix.head.basis).nested) {
        throw UsageError(fmt::format("the functions of {} depend on the order: project anew",
                                     matrix.head.basis));
    }
    if (!matrix.as<MatrixArray>() || order > matrix.head.order) {
        throw UsageError(
            fmt::format("a matrix of order {}, not factored, has no prefix of order {}",
                        matrix.head.order, order));
    }
    const std::vector<ProductTerm> terms = productTerms(*basis, symmetryOf(matrix));
    const auto kept = static_cast<std::size_t>(
        std::count_if(terms.begin(), terms.end(),
                      [&](const ProductTerm& t) { return std::max(t.l, t.k) < order; }));
    Representation result = matrix;
    result.head.order = order;
    StoredArray& array = result.as<MatrixArray>()->matrix;
    const std::size_t rows = array.rows();
    std::vector<double> values;
    for (std::size_t row = 0; row < rows; ++row) {
        const auto from = array.values.begin() + static_cast<std::ptrdiff_t>(row * terms.size());
        values.insert(values.end(), from, from + static_cast<std::ptrdiff_t>(kept));
    }
    array.shape.back() = kept;
    array.values = std::move(values);
    return result;
}

}  // namespace hshfit::inline representation
