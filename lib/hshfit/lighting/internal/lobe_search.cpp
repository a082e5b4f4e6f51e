#include <hshfit/lighting/internal/lobe_search.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/lighting/prefiltered_lobes.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace hshfit::lighting {
namespace {

constexpr std::size_t most = PrefilteredTable::mostLobes + 1;  // with the diffuse one
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;

constexpr double ridge = 1e-5;           // of a lobe's own square without the albedo
constexpr double gridStep = 3;           // degrees between axes in the plane of incidence
constexpr double askewStep = 5;          // between axes anywhere
constexpr double windowRoughness = 0.1;  // from one row to the next
constexpr double windowAngle = 12;       // degrees, the same
constexpr double mostLean = 3;           // angle of an axis from the normal, over theta_o
constexpr double gain = 1e-4;            // of what is left, below which a round is the last
constexpr int mostRounds = 20;

/// A direction turned in the plane of incidence, away from the viewer.
Direction turnedAway(const Direction& d, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * d.x - s * d.z, d.y, c * d.z + s * d.x};
}

Direction unit(const Direction& d) {
    const double length = std::sqrt(dot(d, d));
    return {d.x / length, d.y / length, d.z / length};
}

using Bands = Eigen::Array<double, Eigen::Dynamic, 1, 0, PrefilteredTable::bands, 1>;

Eigen::Map<const Eigen::ArrayXd> mapped(const std::vector<double>& values) {
    return {values.data(), static_cast<Eigen::Index>(values.size())};
}

/// By band: its weight, the weight by (2 l + 1) / (4 pi), and the factors of Legendre's recurrence
/// P_{l+1}(x) = rise x P_l(x) - fall P_{l-1}(x).
struct BandNumbers {
    std::array<double, PrefilteredTable::bands> weight, kernel, rise, fall;

    BandNumbers() {
        for (std::size_t l = 0; l < weight.size(); ++l) {
            const auto n = static_cast<double>(l);
            weight[l] = bandWeight(static_cast<int>(l));
            kernel[l] = weight[l] * (2 * n + 1) / (4 * pi);
            rise[l] = (2 * n + 1) / (n + 1);
            fall[l] = n / (n + 1);
        }
    }
};
const BandNumbers numbers;

/// The product of this kernel with another, both about axes that have that cosine between them, is
/// the sum over l of these numbers times the other's bands: [l].
Bands turned(const std::vector<double>& bands, double cosine) {
    Bands result(static_cast<Eigen::Index>(bands.size()));
    double before = 0, here = 1;
    for (std::size_t l = 0; l < bands.size(); ++l) {
        result(static_cast<Eigen::Index>(l)) = numbers.kernel[l] * bands[l] * here;
        const double next = numbers.rise[l] * cosine * here - numbers.fall[l] * before;
        before = here;
        here = next;
    }
    return result;
}

/// Products of two kernels about axes of that cosine, in the weights of bands.
double product(const std::vector<double>& a, const std::vector<double>& b, double cosine) {
    return (mapped(a) * turned(b, cosine)).sum();
}

/// A product of two kernels on one axis with the ridge.
double withRidge(double square) {
    return square + ridge * (square - bandWeight(0) / (4 * pi));
}

/// A direction with the target's products along it, by level and channel.
struct AxisProducts {
    Direction axis;
    std::vector<Rgb> byLevel;
};

/// The best place between levels on one axis.
struct BestLevel {
    double gain = -1, place = 0;
};

/// A lobe that stands: its kernel, and its product with the target.
struct Standing {
    Direction axis;
    double place = 0;  ///< level
    std::vector<double> bands;
    Rgb product{};
};

}  // namespace

double bandWeight(int l) {
    const double g = l == 0 ? 100 : 0.3 / l;
    return g * g;
}

LobeTarget::LobeTarget(const Basis& basis, std::array<std::vector<double>, 3> f)
    : basis_(&basis), f_(std::move(f)) {
    for (std::size_t i = 0; i < f_[0].size(); ++i)
        bySlot_.emplace_back(f_[0][i], f_[1][i], f_[2][i], 0);
    for (const std::vector<double>& channel : f_)
        for (int l = 0; l < basis.order(); ++l)
            for (int m = -l; m <= l; ++m)
                size_ += bandWeight(l) *
                         std::pow(channel[static_cast<std::size_t>(bases::slotOf(l, m))], 2);
}

std::vector<Eigen::Array4d> LobeTarget::along(const Direction& axis) const {
    std::vector<double> y(static_cast<std::size_t>(basis_->slots()));
    basis_->evaluate(axis, y.data());
    const auto order = static_cast<std::size_t>(basis_->order());
    std::vector<Eigen::Array4d> result;
    result.reserve(order);
    for (std::size_t l = 0; l < order; ++l) {
        // Sines vanish in the plane y = 0.
        Eigen::Array4d sum = Eigen::Array4d::Zero();
        for (std::size_t i = l * l + (axis.y == 0 ? l : 0); i < (l + 1) * (l + 1); ++i)
            sum += bySlot_[i] * y[i];
        result.push_back(sum);
    }
    return result;
}

std::array<std::vector<double>, 3> LobeTarget::without(
    const std::vector<Direction>& axes, const std::vector<std::vector<double>>& bands,
    const std::vector<Rgb>& scales) const {
    std::array<std::vector<double>, 3> left = f_;
    std::vector<double> y(static_cast<std::size_t>(basis_->slots()));
    for (std::size_t k = 0; k < axes.size(); ++k) {
        basis_->evaluate(axes[k], y.data());
        for (std::size_t c = 0; c < 3; ++c)
            for (int l = 0; l < basis_->order(); ++l)
                for (std::size_t i = static_cast<std::size_t>(l * l);
                     i < static_cast<std::size_t>((l + 1) * (l + 1)); ++i)
                    left[c][i] -= scales[k][c] * bands[k][static_cast<std::size_t>(l)] * y[i];
    }
    return left;
}

/// The search for the lobes of one row.
class LobeSearch::Row {
public:
    Row(const LobeSearch& search, const LobeTarget& target, double theta)
        : search_(search), target_(target), theta_(theta) {
        diffuse_ = standing(Direction{0, 0, 1}, static_cast<double>(search.levels_.size() - 1));
    }

    bool allowed(const Direction& axis) const {
        return axis.z > 1e-3 && angleBetween(axis, {0, 0, 1}) <= mostLean * theta_ + 1e-9;
    }

    /// Rounds ask again for the axes of rounds before.
    const AxisProducts& along(const Direction& axis) {
        const auto [found, added] = known_.try_emplace({axis.x, axis.y, axis.z});
        AxisProducts& result = found->second;
        if (!added) return result;
        const std::vector<Eigen::Array4d> values = target_.along(axis);
        result = {axis, std::vector<Rgb>(search_.levels_.size())};
        for (std::size_t j = 0; j < search_.levels_.size(); ++j) {
            Eigen::Array4d sum = Eigen::Array4d::Zero();
            for (std::size_t l = 0; l < values.size(); ++l)
                sum += numbers.weight[l] * search_.levels_[j][l] * values[l];
            result.byLevel[j] = {sum(0), sum(1), sum(2)};
        }
        return result;
    }

    Standing standing(const Direction& axis, double place) { return standing(along(axis), place); }
    Standing standing(const AxisProducts& products, double place) const {
        const std::size_t first =
            std::min(static_cast<std::size_t>(place), search_.levels_.size() - 2);
        const double share = place - static_cast<double>(first);
        Standing result{products.axis, place, lookUpBands(search_.levels_, place)};
        for (std::size_t c = 0; c < 3; ++c)
            result.product[c] =
                products.byLevel[first][c] * (1 - share) + products.byLevel[first + 1][c] * share;
        return result;
    }

    /// The lobes that a new one is added to.
    void fix(std::vector<Standing> others) { fixed_ = equationsOf(std::move(others)); }

    /// The lobe on an axis, of levels in a range, that adds most to what the others explain.
    BestLevel best(const AxisProducts& products, double from, double to) const {
        const std::size_t count = search_.levels_.size();
        std::vector<SmallVector> cross(count), shared(count);
        std::vector<Rgb> rest(count);
        std::vector<double> own(count), beside(count);
        const auto firstLevel = static_cast<std::size_t>(from);
        const auto lastLevel = std::min(count - 1, static_cast<std::size_t>(std::ceil(to)));
        const std::vector<Standing>& terms = fixed_.terms;
        for (std::size_t j = firstLevel; j <= lastLevel; ++j)
            cross[j].resize(static_cast<Eigen::Index>(terms.size()));
        for (std::size_t i = 0; i < terms.size(); ++i) {
            const Bands term = turned(terms[i].bands, dot(products.axis, terms[i].axis));
            for (std::size_t j = firstLevel; j <= lastLevel; ++j)
                cross[j](static_cast<Eigen::Index>(i)) = (mapped(search_.levels_[j]) * term).sum();
        }
        for (std::size_t j = firstLevel; j <= lastLevel; ++j) {
            shared[j] = fixed_.factor.solve(cross[j]);
            own[j] = search_.selfProduct(j, j) - cross[j].dot(shared[j]);
            if (j > firstLevel)
                beside[j] = search_.selfProduct(j - 1, j) - cross[j - 1].dot(shared[j]);
            for (std::size_t c = 0; c < 3; ++c)
                rest[j][c] = products.byLevel[j][c] - cross[j].dot(fixed_.scales[c]);
        }
        const auto gainAt = [&](double place) {
            const std::size_t j = std::clamp(static_cast<std::size_t>(place), firstLevel,
                                             lastLevel > firstLevel ? lastLevel - 1 : lastLevel);
            const double s = place - static_cast<double>(j);
            if (s == 0) return gainOf(rest[j], own[j]);
            Rgb mix{};
            for (std::size_t c = 0; c < 3; ++c)
                mix[c] = rest[j][c] + s * (rest[j + 1][c] - rest[j][c]);
            return gainOf(mix, (1 - s) * (1 - s) * own[j] + 2 * s * (1 - s) * beside[j + 1] +
                                   s * s * own[j + 1]);
        };
        BestLevel result;
        const auto take = [&](double place) {
            const double value = gainAt(place);
            if (value > result.gain) result = {value, place};
        };
        constexpr int steps = 8;
        take(from), take(to);
        for (int k = static_cast<int>(std::ceil(from * steps)); k <= to * steps; ++k)
            take(k / static_cast<double>(steps));
        for (double step = 0.5 / steps; step > 0.002; step /= 2) {
            const double middle = result.place;
            take(std::max(from, middle - step)), take(std::min(to, middle + step));
        }
        return result;
    }

    LobeSolution solve(const std::vector<Standing>& lobes) const {
        const Equations equations = equationsOf(lobes);
        LobeSolution result;
        result.scales.resize(lobes.size());
        double explained = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const SmallVector& x = equations.scales[c];
            explained += x.dot(equations.right[c]);
            for (std::size_t k = 0; k < lobes.size(); ++k)
                result.scales[k][c] = x(static_cast<Eigen::Index>(k));
            result.diffuse[c] = x(x.size() - 1);
        }
        for (const Standing& lobe : lobes)
            result.places.push_back({lobe.axis, search_.engine_->roughnessOf(lobe.place)});
        result.left =
            target_.size() > 0 ? std::sqrt(std::max(0.0, 1 - explained / target_.size())) : 0;
        return result;
    }

    /// Each lobe again with the others fixed, on the axes given and then between them, until a
    /// round gains nothing. `within`: axes and levels that a lobe may have.
    template <class Within>
    void improve(std::vector<Standing>& lobes, std::span<const AxisProducts> axes,
                 const Within& within) {
        double before = solve(lobes).left;
        for (int round = 0; round < mostRounds; ++round) {
            for (std::size_t k = 0; k < lobes.size(); ++k) {
                std::vector<Standing> others = lobes;
                others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
                fix(std::move(others));
                lobes[k] = moved(lobes[k], k, axes, within);
            }
            const double now = solve(lobes).left;
            if (before - now <= gain * before) break;
            before = now;
        }
    }

private:
    /// Least squares of lobes and, last, the diffuse one.
    struct Equations {
        std::vector<Standing> terms;
        Eigen::LDLT<Small> factor;
        std::array<SmallVector, 3> right, scales;  ///< by channel
    };
    Equations equationsOf(std::vector<Standing> terms) const {
        terms.push_back(diffuse_);
        const auto n = static_cast<Eigen::Index>(terms.size());
        const auto at = [&](Eigen::Index i) -> const Standing& {
            return terms[static_cast<std::size_t>(i)];
        };
        Small gram(n, n);
        for (Eigen::Index i = 0; i < n; ++i) {
            gram(i, i) = withRidge(product(at(i).bands, at(i).bands, 1));
            for (Eigen::Index j = 0; j < i; ++j)
                gram(i, j) = gram(j, i) =
                    product(at(i).bands, at(j).bands, dot(at(i).axis, at(j).axis));
        }
        Equations result;
        result.factor.compute(gram);
        for (std::size_t c = 0; c < 3; ++c) {
            SmallVector& right = result.right[c];
            right.resize(n);
            for (Eigen::Index i = 0; i < n; ++i) right(i) = at(i).product[c];
            result.scales[c] = result.factor.solve(right);
        }
        result.terms = std::move(terms);
        return result;
    }
    static double gainOf(const Rgb& rest, double own) {
        return own > 1e-12 ? (rest[0] * rest[0] + rest[1] * rest[1] + rest[2] * rest[2]) / own : 0;
    }

    template <class Within>
    Standing moved(const Standing& lobe, std::size_t number, std::span<const AxisProducts> axes,
                   const Within& within) {
        const AxisProducts* best = &along(lobe.axis);
        const std::pair<double, double> range = within.levels(number);
        BestLevel level = this->best(*best, range.first, range.second);
        const auto take = [&](const AxisProducts& products) {
            const BestLevel found = this->best(products, range.first, range.second);
            if (!(found.gain > level.gain * (1 + 1e-9))) return false;
            level = found;
            best = &products;
            return true;
        };
        for (const AxisProducts& products : axes)
            if (within.axis(number, products.axis)) take(products);
        for (double step = radians(gridStep); step > radians(0.1); step /= 2) {
            for (bool better = true; better;) {
                better = false;
                for (const Direction& d : beside(best->axis, step))
                    if (allowed(d) && within.axis(number, d) && take(along(d))) better = true;
            }
        }
        return standing(*best, level.place);
    }

    std::vector<Direction> beside(const Direction& axis, double step) const {
        std::vector<Direction> result{turnedAway(axis, step), turnedAway(axis, -step)};
        if (!search_.inPlane_)
            for (const double side : {step, -step})
                result.push_back(unit({axis.x, axis.y + side, axis.z}));
        return result;
    }

    const LobeSearch& search_;
    const LobeTarget& target_;
    double theta_;
    Standing diffuse_;
    Equations fixed_;
    std::map<std::array<double, 3>, AxisProducts> known_;
};

LobeSearch::LobeSearch(int bands, const Prefilter& engine, std::size_t lobes, bool inPlane)
    : bands_(bands),
      engine_(&engine),
      lobes_(lobes),
      inPlane_(inPlane),
      levels_(levelBands(engine, bands)) {
    for (std::size_t j = 0; j < levels_.size(); ++j) {
        selfProducts_.push_back(product(levels_[j], levels_[j], 1));
        selfProducts_.push_back(j > 0 ? product(levels_[j - 1], levels_[j], 1) : 0);
    }
    if (inPlane) {
        for (double angle = -87; angle < 90; angle += gridStep)
            axes_.push_back({-std::sin(radians(angle)), 0, std::cos(radians(angle))});
        return;
    }
    for (double tilt = 0; tilt < 90; tilt += askewStep) {
        const int count = std::max(1, static_cast<int>(360 * std::sin(radians(tilt)) / askewStep));
        for (int k = 0; k < count; ++k)
            axes_.push_back(directionFromAngles(radians(tilt), 2 * pi * k / count));
    }
}

double LobeSearch::selfProduct(std::size_t a, std::size_t b) const {
    return withRidge(selfProducts_[2 * b + (a == b ? 0 : 1)]);
}

double LobeSearch::leftBy(const LobeTarget& target, const LobeSolution& solution) const {
    const BandSquares sums = squares(target, solution);
    double left = 0, whole = 0;
    for (std::size_t i = 0; i < sums.left.size(); ++i) {
        const int l = static_cast<int>(i) % bands_;
        if (l == 0) continue;
        left += bandWeight(l) * sums.left[i];
        whole += bandWeight(l) * sums.whole[i];
    }
    return whole > 0 ? std::sqrt(left / whole) : 0;
}

BandSquares LobeSearch::squares(const LobeTarget& target, const LobeSolution& solution) const {
    std::vector<Direction> axes{{0, 0, 1}};
    std::vector<std::vector<double>> bands{levels_.back()};
    std::vector<Rgb> scales{solution.diffuse};
    for (std::size_t k = 0; k < solution.places.size(); ++k) {
        axes.push_back(solution.places[k].axis);
        bands.push_back(lookUpBands(levels_, engine_->levelOf(solution.places[k].roughness)));
        scales.push_back(solution.scales[k]);
    }
    const auto left = target.without(axes, bands, scales);
    BandSquares result;
    const auto add = [&](const std::array<std::vector<double>, 3>& values,
                         std::vector<double>& sums) {
        for (const std::vector<double>& channel : values) {
            for (int l = 0; l < bands_; ++l) {
                double sum = 0;
                for (std::size_t i = static_cast<std::size_t>(l * l);
                     i < static_cast<std::size_t>((l + 1) * (l + 1)); ++i)
                    sum += channel[i] * channel[i];
                sums.push_back(sum);
            }
        }
    };
    add(target.coefficients(), result.whole);
    add(left, result.left);
    return result;
}

LobeSolution LobeSearch::free(const LobeTarget& target, double theta) const {
    Row row(*this, target, theta);
    std::vector<AxisProducts> axes;
    for (const Direction& axis : axes_)
        if (row.allowed(axis)) axes.push_back(row.along(axis));
    axes.push_back(row.along({-std::sin(theta), 0, std::cos(theta)}));
    struct Anywhere {
        double last;
        std::pair<double, double> levels(std::size_t) const { return {0, last}; }
        bool axis(std::size_t, const Direction&) const { return true; }
    };
    const Anywhere anywhere{static_cast<double>(levels_.size() - 1)};
    std::vector<Standing> lobes;
    for (std::size_t k = 0; k < lobes_; ++k) {
        row.fix(lobes);
        const AxisProducts* found = nullptr;
        BestLevel level;
        for (const AxisProducts& products : axes) {
            const BestLevel own = row.best(products, 0, anywhere.last);
            if (!(own.gain > level.gain)) continue;
            level = own;
            found = &products;
        }
        lobes.push_back(row.standing(*found, level.place));
        row.improve(lobes, axes, anywhere);
    }
    return row.solve(lobes);
}

LobeSolution LobeSearch::continued(const LobeTarget& target, double theta,
                                   std::span<const LobePlace> places, double before,
                                   double reach) const {
    Row row(*this, target, theta);
    struct Window {
        std::vector<LobePlace> places;
        const Prefilter* engine;
        double reach;
        std::pair<double, double> levels(std::size_t k) const {
            const double r = places[k].roughness;
            return {engine->levelOf(std::max(0.0, r - reach * windowRoughness)),
                    engine->levelOf(std::min(1.0, r + reach * windowRoughness))};
        }
        bool axis(std::size_t k, const Direction& d) const {
            return angleBetween(d, places[k].axis) <= reach * radians(windowAngle);
        }
    };
    Window window{{}, engine_, reach};
    std::vector<Standing> lobes;
    for (const LobePlace& place : places) {
        // A lobe goes along with the mirror direction, as far as it leans to it.
        const double lean = angleBetween(place.axis, {0, 0, 1});
        const double share = before > 0 ? std::clamp(lean / before, 0.0, 1.0) : 1;
        Direction axis =
            turnedAway(place.axis, (theta - before) * (place.axis.x > 0 ? -share : share));
        const double leans = angleBetween(axis, {0, 0, 1});
        const double bound = std::min(mostLean * theta, radians(89.5));
        const double length = std::hypot(axis.x, axis.y);
        if (leans > bound && length > 0) {
            axis = {axis.x / length * std::sin(bound), axis.y / length * std::sin(bound),
                    std::cos(bound)};
        }
        window.places.push_back({axis, place.roughness});
        lobes.push_back(row.standing(axis, engine_->levelOf(place.roughness)));
    }
    row.improve(lobes, {}, window);
    return row.solve(lobes);
}

}  // namespace hshfit::lighting
