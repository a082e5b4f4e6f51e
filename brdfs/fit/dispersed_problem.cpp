#include <brdfs/fit/dispersed_problem.h>

#include <brdfs/catalog/metal_spec.h>
#include <brdfs/fit/dense.h>
#include <brdfs/fit/split_models.h>
#include <brdfs/rows/spec.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::brdfs {
namespace {

/// A parameter of the sum, whether shape or linear.
struct Named {
    std::string name, key;
    double least, most;   ///< of its value
    double lower, upper;  ///< of u
};

std::vector<Named> parametersOf(const ParametricSum& sum) {
    std::vector<Named> all;
    for (const ShapeParameter& shape : sum.shapes())
        all.push_back({shape.name, shape.free.keys.front(), shape.free.min, shape.free.max,
                       shape.lower(), shape.upper()});
    for (const LinearParameter& linear : sum.linears())
        all.push_back({linear.name, linear.key, linear.min, linear.max, linear.min, linear.max});
    return all;
}

/// The parameter that a law names: by its name, or by its key or its name without a number where
/// that is the only one.
std::size_t placeOf(const LawStatement& law, const std::vector<Named>& parameters) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < parameters.size(); ++i)
        if (parameters[i].name == law.parameter) return i;
    for (std::size_t i = 0; i < parameters.size(); ++i)
        if (parameters[i].key == law.parameter ||
            withoutNumber(parameters[i].name) == law.parameter)
            found.push_back(i);
    std::vector<std::string_view> known;
    for (const Named& own : parameters) known.push_back(own.name);
    if (found.size() > 1)
        throw UsageError(
            fmt::format("dispersion: '{}' is a parameter of several terms; give one "
                        "of {}",
                        law.parameter, joined(known)));
    if (found.empty())
        throw UsageError(
            fmt::format("dispersion: the model has no free parameter '{}'{}; it has {}",
                        law.parameter, suggestion(law.parameter, known), joined(known)));
    return found.front();
}

bool isOfIndex(const LawStatement& law) {
    return std::ranges::find(dispersionLaws(), law.kind, &DispersionLaw::kind)->ofIndex;
}

void checkIndex(const LawStatement& law, const Named& parameter) {
    const bool index = parameter.key == "ior",
               extinction = parameter.key == "k" && law.kind == DispersionLaw::Kind::cauchy;
    if (isOfIndex(law) && !index && !extinction)
        throw UsageError(fmt::format(
            "dispersion {}={}: is a law of an index of refraction; {} takes free, shared, poly or "
            "spline",
            law.parameter, law.text(), parameter.name));
}

}  // namespace

std::string sumAtWavelength(std::string_view sum, double nanometres) {
    std::string result;
    for (const std::string& part : splitModels(sum))
        result += (result.empty() ? "" : " + ") + atWavelength(part, nanometres);
    return result;
}

DispersedModel::DispersedModel(std::string_view model, bool isotropic,
                               std::vector<double> nanometres,
                               const std::vector<LawStatement>& laws)
    : spec_(model), isotropic_(isotropic), nanometres_(std::move(nanometres)) {
    for (const double own : nanometres_) sums_.emplace_back(sumAtWavelength(model, own), isotropic);
    const std::vector<Named> parameters = parametersOf(sums_.front());
    const std::size_t shapes = sums_.front().shapes().size();
    for (std::size_t i = 0; i < parameters.size(); ++i)
        laws_.push_back({parameters[i].name,
                         i < shapes ? DispersionLaw::Kind::shared : DispersionLaw::Kind::free, 0});
    std::vector<bool> given(parameters.size(), false);
    for (const LawStatement& law : laws) {
        const std::size_t i = placeOf(law, parameters);
        if (given[i])
            throw UsageError(fmt::format("dispersion: {} has two laws", parameters[i].name));
        given[i] = true;
        checkIndex(law, parameters[i]);
        laws_[i].kind = law.kind;
        laws_[i].order = law.order;
    }
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const Named& own = parameters[i];
        curves_.emplace_back(laws_[i], ofIndex(i) ? own.least : own.lower,
                             ofIndex(i) ? own.most : own.upper, nanometres_);
        first_.push_back(lower_.size());
        lower_.insert(lower_.end(), curves_[i].lower().begin(), curves_[i].lower().end());
        upper_.insert(upper_.end(), curves_[i].upper().begin(), curves_[i].upper().end());
    }
}

bool DispersedModel::ofIndex(std::size_t i) const {
    return isOfIndex(laws_[i]);
}

double DispersedModel::scaled(std::size_t i, double value, const ParametricSum& sum,
                              double* slope) const {
    *slope = 1;
    if (i >= sum.shapes().size() || !ofIndex(i)) return value;
    const ShapeParameter& shape = sum.shapes()[i];
    const double within = std::clamp(value, shape.free.min, shape.free.max);
    *slope = 1 / shape.slope(within);
    return shape.toScale(within);
}

std::vector<double> DispersedModel::pointAt(std::size_t c, std::span<const double> coefficients,
                                            Matrix* slopes) const {
    std::vector<double> x, own(count());
    if (slopes) *slopes = Matrix::Zero(at(parameterCount()), at(count()));
    for (std::size_t i = 0; i < curves_.size(); ++i) {
        const double value = curves_[i].at(
            nanometres_[c], coefficients.subspan(first_[i], curves_[i].count()), own.data());
        double slope = 1;
        x.push_back(scaled(i, value, sums_[c], &slope));
        for (std::size_t j = 0; slopes && j < curves_[i].count(); ++j)
            (*slopes)(at(i), at(first_[i] + j)) = slope * own[j];
    }
    return x;
}

std::vector<double> DispersedModel::nearest(const std::vector<std::vector<double>>& points) const {
    std::vector<double> coefficients;
    for (std::size_t i = 0; i < curves_.size(); ++i) {
        std::vector<double> values;
        for (std::size_t c = 0; c < points.size(); ++c)
            values.push_back(i < sums_[c].shapes().size() && ofIndex(i)
                                 ? sums_[c].shapes()[i].toValue(points[c][i])
                                 : points[c][i]);
        const std::vector<double> own = curves_[i].nearest(values);
        coefficients.insert(coefficients.end(), own.begin(), own.end());
    }
    return coefficients;
}

std::string DispersedModel::specAt(double nanometres, std::span<const double> coefficients) const {
    if (!(nanometres >= nanometres_.front() && nanometres <= nanometres_.back()))
        throw UsageError(fmt::format("the fit holds from {} to {} nm, not at {} nm",
                                     nanometres_.front(), nanometres_.back(), nanometres));
    const bool measured = std::ranges::find(nanometres_, nanometres) != nanometres_.end();
    const ParametricSum sum(sumAtWavelength(spec_, nanometres), isotropic_);
    std::vector<double> values, slopes(count());
    for (std::size_t i = 0; i < curves_.size(); ++i) {
        if (!measured && !curves_[i].interpolates())
            throw UsageError(fmt::format(
                "the fit has a value of {} at each wavelength of its data and none at {} nm; fit "
                "with a law for it, such as {}=spline",
                laws_[i].parameter, nanometres, laws_[i].parameter));
        const double value = curves_[i].at(
            nanometres, coefficients.subspan(first_[i], curves_[i].count()), slopes.data());
        values.push_back(i < sum.shapes().size() && !ofIndex(i) ? sum.shapes()[i].toValue(value)
                                                                : value);
    }
    const auto shapes = static_cast<std::ptrdiff_t>(sum.shapes().size());
    return sum.filledIn({{values.begin(), values.begin() + shapes}},
                        {values.data() + shapes, values.size() - static_cast<std::size_t>(shapes)},
                        1);
}

DispersedProblem::DispersedProblem(const FitSamples& samples, const DispersedModel& model,
                                   Loss::Kind loss, std::vector<double> mix)
    : samples_(samples), model_(model), loss_(loss), mix_(std::move(mix)) {
    const std::size_t count = samples.channels.count();
    channels_.reserve(count);
    problems_.reserve(count);
    for (std::size_t c = 0; c < count; ++c) {
        channels_.push_back(samples.channel(c));
        channels_.back().correlation = {};  // in errors, not in weights
        problems_.emplace_back(channels_[c], model.sum(c), loss);
        normalisation_ += problems_[c].normalisation();
        if (mix_.empty()) continue;
        bare_.push_back(channels_[c]);
        bare_.back().sigmas.clear();
        std::ranges::fill(bare_.back().weights, 1.0);
    }
}

void DispersedProblem::setRobust(Robust robust, double scale) {
    for (FitProblem& problem : problems_) problem.setRobust(robust, scale);
}

Equations DispersedProblem::joint(std::span<const double> coefficients, bool derivatives,
                                  std::span<const double> inverse) const {
    if (!mix_.empty()) return mixedEquations(coefficients, derivatives, inverse);
    const Eigen::Index n = at(coefficients.size());
    std::vector<Equations> parts(problems_.size());
    std::vector<Matrix> slopes(problems_.size());
    eachInParallel(problems_.size(), [&](std::size_t c) {
        const std::vector<double> x =
            model_.pointAt(c, coefficients, derivatives ? &slopes[c] : nullptr);
        std::vector<double> own;
        if (!inverse.empty()) {
            const Matrix part = slopes[c] * Eigen::Map<const Matrix>(inverse.data(), n, n) *
                                slopes[c].transpose() *
                                (problems_[c].normalisation() / normalisation_);
            own.assign(part.data(), part.data() + part.size());
        }
        parts[c] = problems_[c].joint(x, derivatives, own);
    });
    Equations result;
    Matrix hessian = Matrix::Zero(n, n), spread = Matrix::Zero(n, n);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    for (std::size_t c = 0; c < parts.size(); ++c) {
        const double share = problems_[c].normalisation() / normalisation_;
        result.cost += share * parts[c].cost;
        if (!derivatives) continue;
        const Eigen::Index m = slopes[c].rows();
        gradient += share * slopes[c].transpose() *
                    Eigen::Map<const Eigen::VectorXd>(parts[c].gradient.data(), m);
        hessian += share * slopes[c].transpose() *
                   Eigen::Map<const Matrix>(parts[c].hessian.data(), m, m) * slopes[c];
        if (!inverse.empty())
            spread += share * share * slopes[c].transpose() *
                      Eigen::Map<const Matrix>(parts[c].spread.data(), m, m) * slopes[c];
    }
    if (!derivatives) return result;
    result.gradient.assign(gradient.data(), gradient.data() + n);
    result.hessian.assign(hessian.data(), hessian.data() + n * n);
    if (!inverse.empty()) result.spread.assign(spread.data(), spread.data() + n * n);
    return result;
}

namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

WeightedRows DispersedProblem::mixedRows(std::span<const double> coefficients) const {
    const std::size_t count = samples_.size(), n = coefficients.size(), channels = bare_.size();
    std::vector<Rows> slopes(channels);
    std::vector<std::vector<double>> f(channels);
    eachInParallel(channels, [&](std::size_t c) {
        Matrix byCoefficient;
        const std::vector<double> x = model_.pointAt(c, coefficients, &byCoefficient);
        const WeightedRows own =
            FitProblem(bare_[c], model_.sum(c), Loss::Kind::l2).weightedRows(x);
        slopes[c] =
            Eigen::Map<const Rows>(own.slopes.data(), at(count), at(own.columns)) * byCoefficient;
        f[c] = own.values;
    });
    WeightedRows result{.samples = count * channels, .channels = 1, .columns = n};
    result.slopes.assign(result.samples * n, 0);
    result.values.assign(result.samples, 0);
    result.residuals.resize(result.samples);
    eachInParallel(channels, [&](std::size_t c) {
        Eigen::Map<Rows> own(result.slopes.data() + c * count * n, at(count), at(n));
        for (std::size_t from = 0; from < channels; ++from) {
            const double share = mix_[c * channels + from];
            if (share == 0) continue;
            own += share * slopes[from];
            for (std::size_t k = 0; k < count; ++k)
                result.values[c * count + k] += share * f[from][k];
        }
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t v = c * count + k;
            const double root = std::sqrt(samples_.weight(c, k)) *
                                mapValue(loss_, samples_.value(c, k), samples_.wiZ[k]).slope;
            own.row(at(k)) *= root;
            result.residuals[v] = root * (samples_.values[v] - result.values[v]);
        }
    });
    return result;
}

// With `inverse`, residuals are divided by 1 - leverage, as by FitProblem::joint.
Equations DispersedProblem::mixedEquations(std::span<const double> coefficients, bool derivatives,
                                           std::span<const double> inverse) const {
    const WeightedRows rows = mixedRows(coefficients);
    const Eigen::Index n = at(rows.columns);
    const Eigen::Map<const Rows> slopes(rows.slopes.data(), at(rows.samples), n);
    const Eigen::Map<const Eigen::VectorXd> residuals(rows.residuals.data(), at(rows.samples));
    Equations result;
    result.cost = 0.5 * residuals.squaredNorm() / normalisation_;
    if (!derivatives) return result;
    const Eigen::VectorXd gradient = -slopes.transpose() * residuals / normalisation_;
    const Matrix hessian = slopes.transpose() * slopes / normalisation_;
    result.gradient.assign(gradient.data(), gradient.data() + n);
    result.hessian.assign(hessian.data(), hessian.data() + n * n);
    if (inverse.empty()) return result;
    const Matrix own = Eigen::Map<const Matrix>(inverse.data(), n, n) / normalisation_;
    const Eigen::VectorXd leverages = (slopes * own).cwiseProduct(slopes).rowwise().sum();
    const Eigen::VectorXd out =
        residuals.cwiseQuotient((1 - leverages.array()).max(leastFreedom).matrix());
    const Rows pulls = out.asDiagonal() * slopes;
    const Matrix spread = pulls.transpose() * pulls / (normalisation_ * normalisation_);
    result.spread.assign(spread.data(), spread.data() + n * n);
    return result;
}

WeightedRows DispersedProblem::weightedRows(std::span<const double> coefficients) const {
    if (!mix_.empty()) return mixedRows(coefficients);
    const std::size_t count = samples_.size(), n = coefficients.size();
    WeightedRows result{.samples = count * problems_.size(), .channels = 1, .columns = n};
    result.slopes.resize(result.samples * n);
    for (std::size_t c = 0; c < problems_.size(); ++c) {
        Matrix slopes;
        const std::vector<double> x = model_.pointAt(c, coefficients, &slopes);
        const WeightedRows own = problems_[c].weightedRows(x);
        result.residuals.insert(result.residuals.end(), own.residuals.begin(), own.residuals.end());
        result.values.insert(result.values.end(), own.values.begin(), own.values.end());
        Eigen::Map<Rows>(result.slopes.data() + c * count * n, at(count), at(n)) =
            Eigen::Map<const Rows>(own.slopes.data(), at(count), at(own.columns)) * slopes;
    }
    return result;
}

std::vector<double> DispersedProblem::residuals(std::span<const double> coefficients) const {
    std::vector<double> all;
    if (!mix_.empty()) {
        const std::vector<double> values = mixedRows(coefficients).values;
        for (std::size_t v = 0; v < values.size(); ++v) {
            const double cosine = samples_.wiZ[v % samples_.size()];
            all.push_back(mapValue(loss_, values[v], cosine).value -
                          mapValue(loss_, samples_.values[v], cosine).value);
        }
        return all;
    }
    for (std::size_t c = 0; c < problems_.size(); ++c) {
        const std::vector<double> own =
            problems_[c].residuals(model_.pointAt(c, coefficients, nullptr));
        all.insert(all.end(), own.begin(), own.end());
    }
    return all;
}

}  // namespace hshfit::brdfs
