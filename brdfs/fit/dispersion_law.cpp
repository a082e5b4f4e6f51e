#include <brdfs/fit/dispersion_law.h>

#include <brdfs/fit/minimise.h>
#include <brdfs/fit/sellmeier.h>
#include <brdfs/rows/spec.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using Kind = DispersionLaw::Kind;

constexpr DispersionLaw table[] = {
    {Kind::free, "free", "a value at each wavelength"},
    {Kind::shared, "shared", "one value for all wavelengths"},
    {Kind::cauchy, "cauchy", "A + B/lambda^2 + C/lambda^4, so many terms", 1, 4, 2, true},
    {Kind::sellmeier, "sellmeier", "n^2 = 1 + sum of B lambda^2/(lambda^2 - C), so many terms", 1,
     3, 1, true},
    {Kind::poly, "poly", "a polynomial of this degree in the wavelength", 1, 12, 2},
    {Kind::spline, "spline", "a cubic spline with so many coefficients", 4, 200, 6},
};

const DispersionLaw& lawOf(Kind kind) {
    return *std::ranges::find(table, kind, &DispersionLaw::kind);
}

LawStatement statementOf(std::string_view part) {
    const auto refuse = [&](std::string_view why) {
        std::vector<std::string_view> known;
        for (const DispersionLaw& law : table) known.push_back(law.name);
        throw UsageError(
            fmt::format("dispersion '{}': {}; expected PARAMETER=LAW[:N], such as ior=cauchy:2, "
                        "with a law of {}",
                        part, why, joined(known)));
    };
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos || equals == 0) refuse("names no parameter and law");
    const std::string_view law = part.substr(equals + 1), name = law.substr(0, law.find(':'));
    const auto found = std::ranges::find(table, name, &DispersionLaw::name);
    if (found == std::end(table)) refuse(fmt::format("unknown law '{}'", name));
    LawStatement statement{std::string(part.substr(0, equals)), found->kind, found->fallback};
    if (name.size() == law.size()) return statement;
    const std::string_view number = law.substr(name.size() + 1);
    const auto read =
        std::from_chars(number.data(), number.data() + number.size(), statement.order);
    if (found->most == 0) refuse(fmt::format("{} takes no number", name));
    if (read.ec != std::errc() || read.ptr != number.data() + number.size() ||
        statement.order < found->least || statement.order > found->most)
        refuse(fmt::format("{} takes a number from {} to {}", name, found->least, found->most));
    return statement;
}

/// A knot vector over [first, last] with full multiplicity at its ends.
std::vector<double> knotsOf(std::size_t count, std::size_t degree, double first, double last) {
    std::vector<double> knots(degree + 1, first);
    const std::size_t inner = count - degree - 1;
    for (std::size_t i = 1; i <= inner; ++i)
        knots.push_back(first +
                        (last - first) * static_cast<double>(i) / static_cast<double>(inner + 1));
    knots.insert(knots.end(), degree + 1, last);
    return knots;
}

/// B-spline basis functions at t by the recurrence of Cox and de Boor (de Boor 1978, A Practical
/// Guide to Splines, chapter IX).
std::vector<double> basisAt(const std::vector<double>& knots, std::size_t degree, double t) {
    const std::size_t count = knots.size() - degree - 1;
    std::size_t span = degree;
    while (span + 1 < count && t >= knots[span + 1]) ++span;
    std::vector<double> basis(count, 0), local(degree + 1, 0);
    local[0] = 1;
    for (std::size_t d = 1; d <= degree; ++d) {
        double saved = 0;
        for (std::size_t r = 0; r < d; ++r) {
            const double right = knots[span + r + 1], left = knots[span + 1 + r - d];
            const double share = right > left ? local[r] / (right - left) : 0;
            local[r] = saved + (right - t) * share;
            saved = (t - left) * share;
        }
        local[d] = saved;
    }
    for (std::size_t r = 0; r <= degree; ++r) basis[span - degree + r] = local[r];
    return basis;
}

double inverseSquare(double nanometres) {
    return 1e6 / (nanometres * nanometres);
}

}  // namespace

std::span<const DispersionLaw> dispersionLaws() {
    return table;
}

std::string LawStatement::text() const {
    const DispersionLaw& law = lawOf(kind);
    return law.most == 0 ? std::string(law.name) : fmt::format("{}:{}", law.name, order);
}

std::vector<LawStatement> parseDispersion(std::string_view text) {
    std::vector<LawStatement> statements;
    for (std::size_t first = 0; first <= text.size();) {
        const std::size_t last = std::min(text.find(',', first), text.size());
        statements.push_back(statementOf(text.substr(first, last - first)));
        first = last + 1;
    }
    return statements;
}

LawCurve::LawCurve(const LawStatement& law, double least, double most,
                   std::span<const double> wavelengths)
    : kind_(law.kind), wavelengths_(wavelengths.begin(), wavelengths.end()) {
    const double first = wavelengths.front(), last = wavelengths.back();
    const auto order = static_cast<std::size_t>(law.order);
    std::size_t count = 1;
    if (kind_ == Kind::free) count = wavelengths.size();
    if (kind_ == Kind::cauchy) count = order, degree_ = order - 1;
    if (kind_ == Kind::poly) count = order + 1, degree_ = order;
    if (kind_ == Kind::spline) count = order, degree_ = 3;
    if (kind_ == Kind::sellmeier) count = 2 * order;
    if (count > wavelengths.size())
        throw UsageError(
            fmt::format("dispersion {}={}: {} wavelengths cannot determine {} coefficients",
                        law.parameter, law.text(), wavelengths.size(), count));
    if (kind_ == Kind::cauchy)
        knots_ = knotsOf(count, degree_, inverseSquare(last), inverseSquare(first));
    if (kind_ == Kind::poly || kind_ == Kind::spline) knots_ = knotsOf(count, degree_, first, last);
    lower_.assign(count, least);
    upper_.assign(count, most);
    if (kind_ == Kind::sellmeier) sellmeierBox(first, last, most, order, lower_, upper_);
}

double LawCurve::at(double nanometres, std::span<const double> coefficients, double* slopes) const {
    std::fill_n(slopes, count(), 0.0);
    switch (kind_) {
        case Kind::shared:
            slopes[0] = 1;
            return coefficients[0];
        case Kind::free: {
            const auto found = std::ranges::find(wavelengths_, nanometres);
            assert(found != wavelengths_.end());
            const auto c = static_cast<std::size_t>(found - wavelengths_.begin());
            slopes[c] = 1;
            return coefficients[c];
        }
        case Kind::sellmeier:
            return sellmeierIndex(nanometres, wavelengths_.front(), wavelengths_.back(),
                                  coefficients, slopes);
        case Kind::cauchy:
        case Kind::poly:
        case Kind::spline:
            break;
    }
    const std::vector<double> basis =
        basisAt(knots_, degree_, kind_ == Kind::cauchy ? inverseSquare(nanometres) : nanometres);
    double value = 0;
    for (std::size_t j = 0; j < basis.size(); ++j) {
        slopes[j] = basis[j];
        value += basis[j] * coefficients[j];
    }
    return value;
}

/// Terms that share n^2 - 1 at the lower end of the band, with poles apart from each other.
double LawCurve::sellmeierStart(std::size_t i, double index, double share) const {
    const bool infrared = i >= 4, pole = i % 2 == 1;
    if (pole) {
        const double place = infrared ? 0.1 * share : i == 1 ? share : 0.4 * share;
        return lower_[i] + place * (upper_[i] - lower_[i]);
    }
    if (infrared) return 0.05;
    return (index * index - 1) / static_cast<double>(std::min<std::size_t>(count() / 2, 2));
}

std::vector<double> LawCurve::nearest(std::span<const double> values) const {
    const std::size_t n = count();
    if (kind_ == Kind::free) return {values.begin(), values.end()};
    const auto equations = [&](std::span<const double> x, bool) {
        Equations result;
        result.gradient.assign(n, 0);
        result.hessian.assign(n * n, 0);
        std::vector<double> slopes(n);
        for (std::size_t c = 0; c < values.size(); ++c) {
            const double r = at(wavelengths_[c], x, slopes.data()) - values[c];
            result.cost += r * r / 2;
            for (std::size_t i = 0; i < n; ++i) {
                result.gradient[i] += r * slopes[i];
                for (std::size_t j = 0; j < n; ++j)
                    result.hessian[i * n + j] += slopes[i] * slopes[j];
            }
        }
        return result;
    };
    Minimum best;
    // Sums with poles have several minima.
    for (const double share : {0.5, 0.1, 0.9}) {
        std::vector<double> start(n);
        for (std::size_t i = 0; i < n; ++i)
            start[i] = std::clamp(kind_ == Kind::sellmeier ? sellmeierStart(i, values[0], share)
                                                           : values[i * values.size() / n],
                                  lower_[i], upper_[i]);
        const Minimum found = minimise(equations, start, lower_, upper_, {.curvature = false});
        if (best.x.empty() || found.cost < best.cost) best = found;
        if (kind_ != Kind::sellmeier) break;
    }
    return best.x;
}

LawCurve::Reported LawCurve::cauchyTerms(std::span<const double> coefficients) const {
    const std::size_t n = count();
    const double first = knots_.front(), width = knots_.back() - first;
    std::vector<std::vector<double>> binomial(n + 1, std::vector<double>(n + 1, 0));
    for (std::size_t i = 0; i <= n; ++i) {
        binomial[i][0] = 1;
        for (std::size_t j = 1; j <= i; ++j)
            binomial[i][j] = binomial[i - 1][j - 1] + (j < i ? binomial[i - 1][j] : 0);
    }
    Reported result{{}, std::vector<double>(n, 0), std::vector<double>(n * n, 0)};
    for (std::size_t m = 0; m < n; ++m) {
        result.names.push_back(std::string(".") + static_cast<char>('A' + m));
        // Powers of s = (t - first) / width, then of t.
        for (std::size_t k = m; k < n; ++k) {
            const double ofPower = binomial[k][m] * std::pow(-first, static_cast<double>(k - m)) /
                                   std::pow(width, static_cast<double>(k));
            for (std::size_t j = 0; j <= k; ++j)
                result.slopes[m * n + j] +=
                    ((k - j) % 2 == 0 ? 1 : -1) * binomial[n - 1][k] * binomial[k][j] * ofPower;
        }
        for (std::size_t j = 0; j < n; ++j)
            result.values[m] += result.slopes[m * n + j] * coefficients[j];
    }
    return result;
}

LawCurve::Reported LawCurve::reported(std::span<const double> coefficients) const {
    const std::size_t n = count();
    if (kind_ == Kind::cauchy) return cauchyTerms(coefficients);
    Reported result{{}, {coefficients.begin(), coefficients.end()}, std::vector<double>(n * n, 0)};
    if (kind_ == Kind::sellmeier) {
        sellmeierTerms(wavelengths_.front(), wavelengths_.back(), coefficients, result.values,
                       result.slopes);
        for (std::size_t i = 0; i < n; ++i)
            result.names.push_back(fmt::format(".{}{}", i % 2 == 0 ? 'B' : 'C', i / 2 + 1));
        return result;
    }
    for (std::size_t i = 0; i < n; ++i) {
        result.slopes[i * n + i] = 1;
        if (kind_ == Kind::shared || kind_ == Kind::free) {
            result.names.emplace_back();
            continue;
        }
        // The wavelength at which a coefficient counts most (Greville's abscissa).
        double place = 0;
        for (std::size_t k = 1; k <= degree_; ++k)
            place += knots_[i + k] / static_cast<double>(degree_);
        result.names.push_back(fmt::format("@{:.0f}nm", place));
    }
    return result;
}

}  // namespace hshfit::brdfs
