#include <hshfit/rotation/hemisphere_rotation.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/rotation/basis_change.h>
#include <hshfit/rotation/internal/lune.h>
#include <hshfit/rotation/sh_rotation.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::inline rotation {
namespace {

using Matrix = linear_algebra::RowMajor;

constexpr int exactOrders = 150, matrixOrders = 32;

struct MethodRow {
    HemisphereMethod method;
    const char* name;
};
constexpr std::array methods{MethodRow{HemisphereMethod::exact, "exact"},
                             MethodRow{HemisphereMethod::throughSh, "through-sh"},
                             MethodRow{HemisphereMethod::table, "table"},
                             MethodRow{HemisphereMethod::paperShift, "paper-shift"}};

/// About z by the angle with this cosine and sine, in place; a column a vector.
void turn(int order, double cosine, double sine, Matrix& c) {
    double cm = 1, sm = 0;
    for (int m = 1; m < order; ++m) {
        const double next = cm * cosine - sm * sine;
        sm = sm * cosine + cm * sine;
        cm = next;
        for (int l = m; l < order; ++l) {
            const Eigen::RowVectorXd a = c.row(slotOf(l, m)), b = c.row(slotOf(l, -m));
            c.row(slotOf(l, m)) = cm * a - sm * b;
            c.row(slotOf(l, -m)) = sm * a + cm * b;
        }
    }
}

Matrix columnsOf(const std::vector<double>& c, Eigen::Index slots) {
    return Eigen::Map<const Matrix>(c.data(), static_cast<Eigen::Index>(c.size()) / slots, slots)
        .transpose();
}

std::vector<double> vectorsOf(const Matrix& c) {
    const Matrix rows = c.transpose();
    return {rows.data(), rows.data() + rows.size()};
}

Rotation tiltBy(double beta) {
    return Rotation::euler(0, beta, 0);
}

}  // namespace

HemisphereMethod hemisphereMethod(std::string_view name) {
    for (const MethodRow& row : methods)
        if (row.name == name) return row.method;
    throw spelling::unknown("way to rotate", name, spelling::namesOf(methods));
}

std::string methodName(HemisphereMethod method) {
    for (const MethodRow& row : methods)
        if (row.method == method) return row.name;
    return "";
}

struct HemisphereRotation::Parts {
    std::unique_ptr<Basis> basis;
    HemisphereRotationOptions options;
    bool orthonormal = true;
    /// <B_i, B_j> over the hemisphere, where it is not the identity.
    std::unique_ptr<BasisChange> gram = {};
    std::vector<Matrix> tables = {};

    /// Vectors as columns, with 0 for functions that the basis lacks.
    Matrix columns(const std::vector<double>& c) const {
        Matrix result = columnsOf(c, basis->slots());
        for (int l = 0; l < basis->order(); ++l)
            for (int m = -l; m <= l; ++m)
                if (!basis->has(l, m)) result.row(slotOf(l, m)).setZero();
        return result;
    }

    /// c -> G c.
    Matrix byGram(const Matrix& c) const {
        if (!gram) return c;
        const std::vector<double> in = vectorsOf(c);
        std::vector<double> out(in.size());
        gram->apply(static_cast<std::size_t>(c.cols()), in.data(), out.data());
        return columnsOf(out, c.rows());
    }

    /// True where the moments over the lune are the result.
    bool deletesDigon(double beta) const {
        return options.method == HemisphereMethod::exact && orthonormal && beta != 0;
    }

    Matrix exact(double beta, const Matrix& c) const {
        if (beta == 0 && !(basis->name() == "sh")) return c;
        if (orthonormal) return luneIntegrals(*basis, beta, c).moments;
        const Matrix moments = luneIntegrals(*basis, beta, c, LuneFunctions::analysis).moments;
        Matrix result(c.rows(), c.cols());
        for (Eigen::Index v = 0; v < c.cols(); ++v) {
            const Eigen::VectorXd in = moments.col(v);
            Eigen::VectorXd out(in.size());
            basis->coefficientsFromMoments(in.data(), basis->order(), out.data());
            result.col(v) = out;
        }
        return result;
    }

    /// Rotates by way of SH with `bands` bands.
    Matrix through(int bands, double beta, const Matrix& c) const {
        const auto sh = bases::make("sh", bands, {.condonShortley = basis->condonShortley()});
        const BasisChange to(*basis, *sh), back(*sh, *basis);
        const auto vectors = static_cast<std::size_t>(c.cols());
        std::vector<double> in = vectorsOf(c);
        std::vector<double> middle(vectors * static_cast<std::size_t>(sh->slots()));
        to.apply(vectors, in.data(), middle.data());
        const ShRotation rotate(bands, {.condonShortley = basis->condonShortley()});
        middle = rotate.rotate(tiltBy(beta), middle);
        back.apply(vectors, middle.data(), in.data());
        return columnsOf(in, c.rows());
    }

    Matrix throughSh(double beta, const Matrix& c, int* bands) const {
        int count = std::max(8, 2 * basis->order());
        Matrix last = through(count, beta, c);
        while (count < ShRotation::maxOrder) {
            count = std::min(2 * count, ShRotation::maxOrder);
            Matrix next = through(count, beta, c);
            const double change = (next - last).norm();
            last = std::move(next);
            if (change <= options.tolerance * c.norm()) break;
        }
        if (bands) *bands = count;
        return last;
    }

    Matrix interpolated(double beta, const Matrix& c) const {
        const double place = beta / pi * (options.tables - 1);
        const int first = std::min(static_cast<int>(place), options.tables - 2);
        const double fraction = place - first;
        const auto at = static_cast<std::size_t>(first);
        return (1 - fraction) * (tables[at] * c) + fraction * (tables[at + 1] * c);
    }

    Matrix shifted(double beta, const Matrix& c) const {
        if (beta > pi / 2 + 1e-12)
            throw UsageError(fmt::format(
                "the paper's shift has no tilt beyond 90 degrees, and {:.6g} is asked for; the "
                "method exact has",
                degrees(beta)));
        const double half = std::sin(beta / 2);  // 1 - cos(beta') = 2 (1 - cos(beta))
        const double angle = 2 * std::asin(std::min(1.0, std::sqrt(2.0) * half));
        // Only the part that stays is rotated.
        const Matrix kept = luneIntegrals(*basis, beta, c, LuneFunctions::source).moments;
        const ShRotation rotate(basis->order(), {.condonShortley = basis->condonShortley()});
        return columnsOf(rotate.rotate(tiltBy(angle), vectorsOf(kept)), c.rows());
    }

    Matrix tilt(double beta, const Matrix& c, int* bands = nullptr) const {
        if (beta == 0) return c;
        switch (options.method) {
            case HemisphereMethod::exact:
                return exact(beta, c);
            case HemisphereMethod::throughSh:
                return throughSh(beta, c, bands);
            case HemisphereMethod::table:
                return interpolated(beta, c);
            case HemisphereMethod::paperShift:
                return shifted(beta, c);
        }
        return c;
    }
};

HemisphereRotation::HemisphereRotation(const Basis& basis, const HemisphereRotationOptions& options)
    : parts_(std::make_unique<Parts>()) {
    const std::string name = basis.name();
    parts_->basis =
        bases::find(name).make(basis.order(), {.condonShortley = basis.condonShortley()});
    parts_->options = options;
    parts_->orthonormal = bases::find(name).orthonormal;
    if (basis.order() > exactOrders)
        throw UsageError(fmt::format(
            "rotation on the hemisphere at order {}; at most {}, since the integrals over "
            "what stays above the horizon take order^4 operations, about a minute of "
            "CPU there",
            basis.order(), exactOrders));
    const bool exact = options.method == HemisphereMethod::exact;
    if (!exact && !parts_->orthonormal)
        throw UsageError(
            fmt::format("{} is fitted anew when it is rotated, which the method {} "
                        "cannot; the method exact can",
                        name, methodName(options.method)));
    if (options.method == HemisphereMethod::paperShift && name != "hsh")
        throw UsageError(fmt::format("the paper's shift is one of hsh, not of {}", name));
    if (name == "sh" || name == "lsosh")
        parts_->gram = std::make_unique<BasisChange>(
            basis, *bases::make("sh", basis.order(), {.condonShortley = basis.condonShortley()}));
    if (options.method != HemisphereMethod::table) return;
    if (basis.order() > matrixOrders || options.tables < 2 || options.tables > 10001)
        throw UsageError(fmt::format("{} tables of order {}; 2 to 10001 of order {} at most",
                                     options.tables, basis.order(), matrixOrders));
    const Matrix identity = Matrix::Identity(basis.slots(), basis.slots());
    for (int k = 0; k < options.tables; ++k)
        parts_->tables.push_back(parts_->exact(pi * k / (options.tables - 1), identity));
}
HemisphereRotation::~HemisphereRotation() = default;
HemisphereRotation::HemisphereRotation(HemisphereRotation&&) noexcept = default;
HemisphereRotation& HemisphereRotation::operator=(HemisphereRotation&&) noexcept = default;

HemisphereRotated HemisphereRotation::rotate(const Rotation& rotation,
                                             const std::vector<double>& c) const {
    const Parts& p = *parts_;
    const Rotation::Turns t = rotation.turns();
    const double beta = std::atan2(t.sinBeta, t.cosBeta);
    Matrix before = p.columns(c);
    turn(p.basis->order(), t.cosGamma, t.sinGamma, before);
    HemisphereRotated result;
    const LuneIntegrals lune = luneIntegrals(*p.basis, beta, before);
    Matrix after = p.deletesDigon(beta) ? lune.moments : p.tilt(beta, before, &result.bands);
    const double energy = before.cwiseProduct(p.byGram(before)).sum();
    if (energy > 0) {
        // |f' - g|^2 = |f'|^2 - 2 <f', g> + |g|^2
        double stayed = 0, kept = 0;
        for (std::size_t v = 0; v < lune.stayed.size(); ++v) {
            stayed += lune.stayed[v];
            kept += lune.energy[v];
        }
        const double distance = kept - 2 * after.cwiseProduct(lune.moments).sum() +
                                after.cwiseProduct(p.byGram(after)).sum();
        const auto rounded = [](double share) { return share < 1e-15 ? 0 : share; };
        result.lostEnergy = rounded(1 - stayed / energy);
        result.error = std::sqrt(rounded(distance / energy));
    }
    turn(p.basis->order(), t.cosAlpha, t.sinAlpha, after);
    result.values = vectorsOf(after);
    return result;
}

std::vector<double> HemisphereRotation::values(const Rotation& rotation,
                                               const std::vector<double>& c) const {
    const Rotation::Turns t = rotation.turns();
    Matrix vectors = parts_->columns(c);
    turn(parts_->basis->order(), t.cosGamma, t.sinGamma, vectors);
    vectors = parts_->tilt(std::atan2(t.sinBeta, t.cosBeta), vectors);
    turn(parts_->basis->order(), t.cosAlpha, t.sinAlpha, vectors);
    return vectorsOf(vectors);
}

std::vector<double> HemisphereRotation::matrix(const Rotation& rotation) const {
    const int order = parts_->basis->order(), slots = parts_->basis->slots();
    if (order > matrixOrders)
        throw UsageError(
            fmt::format("a matrix of rotation of order {}; at most {}", order, matrixOrders));
    const Matrix identity = Matrix::Identity(slots, slots);
    // Vectors are columns here and rows there.
    const std::vector<double> columns = values(rotation, vectorsOf(identity));
    return vectorsOf(columnsOf(columns, slots).transpose());
}

std::size_t HemisphereRotation::tableBytes() const {
    std::size_t cosines = 0, sines = 0;
    for (int l = 0; l < parts_->basis->order(); ++l)
        for (int m = -l; m <= l; ++m) (m >= 0 ? cosines : sines) += parts_->basis->has(l, m);
    return parts_->tables.size() * (cosines * cosines + sines * sines) * sizeof(double);
}

}  // namespace hshfit::inline rotation
