#include <brdfs/fit/instrument/instrument_problem.h>

#include <brdfs/fit/column_blocks.h>

#include <tbb/parallel_for.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// All columns of the sums of a veil: [column * directions + direction].
std::vector<double> veilColumns(const Veil& veil, const ParametricSum& sum,
                                std::span<const double> u, bool derivatives) {
    const ColumnBlocks columns(veil.sums, sum, u, derivatives);
    const std::size_t count = veil.sums.size();
    std::vector<double> all(columns.count() * count);
    const std::size_t blocks = (count + ColumnBlocks::blockSize - 1) / ColumnBlocks::blockSize;
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        const std::size_t begin = b * ColumnBlocks::blockSize,
                          size = std::min(ColumnBlocks::blockSize, count - begin);
        std::vector<double> own(columns.count() * size);
        columns.fill(begin, size, own.data());
        for (std::size_t i = 0; i < columns.count(); ++i)
            std::copy_n(own.data() + i * size, size, all.data() + i * count + begin);
    });
    return all;
}

}  // namespace

InstrumentProblem::InstrumentProblem(const Readings& readings, const ParametricSum& sum,
                                     Loss::Kind loss, std::vector<double> times)
    : readings_(readings), samples_(readings.samples), sum_(sum), times_(std::move(times)) {
    const Instrument& instrument = readings.instrument;
    const std::size_t samples = samples_.size();
    double squares = 0, weights = 0;
    for (std::size_t c = 0; c < channels(); ++c)
        for (std::size_t k = 0; k < samples; ++k) {
            const double slope = mapValue(loss, samples_.value(c, k), samples_.wiZ[k]).slope;
            weights_.push_back(samples_.weight(c, k) * slope * slope *
                               (times_.empty() ? 1 : times_[k]));
            const double value = samples_.value(c, k);
            squares += weights_.back() * value * value;
            weights += weights_.back();
            largest_ = std::max(largest_, std::abs(value));
        }
    normalisation_ = squares > 0 ? squares : weights;
    for (std::size_t k = 0; k < samples; ++k)
        over_.push_back(overCosines(instrument.darkOver, samples_.wiZ[k], samples_.wo[k].z));
    count_ = shapeCount() + sum.linears().size() * channels();
    if (instrument.offset.fitted()) offset_ = count_, count_ += channels();
    if (instrument.dark.fitted()) dark_ = count_, count_ += channels();
    if (instrument.stray.fitted()) stray_ = count_++;
    placeZeros();
    if (!instrument.scales) return;
    scanCount_ = *std::ranges::max_element(samples_.scans) + 1;
    if (!(instrument.scaleWidth > 0)) return;
    priors_.assign(scanCount_, 0);
    for (std::size_t k = 0; k < samples; ++k)
        priors_[samples_.scans[k]] =
            (times_.empty() ? 1 : times_[k]) / (instrument.scaleWidth * instrument.scaleWidth);
}

Bounds InstrumentProblem::bounds() const {
    Bounds bounds = jointBounds(sum_, channels());
    const double most = 100 * std::max(largest_, 1e-6);
    const std::size_t signedCount = (offset_ ? channels() : 0) + (dark_ ? channels() : 0);
    bounds.lower.insert(bounds.lower.end(), signedCount, -most);
    bounds.upper.insert(bounds.upper.end(), signedCount, most);
    constexpr double mostStray = 0.9;
    if (stray_) bounds.lower.push_back(0), bounds.upper.push_back(mostStray);
    constexpr double mostWidths = 10;
    for (const Zero& zero : zeros_) {
        bounds.lower.insert(bounds.lower.end(), zero.priors.size(), -mostWidths * zero.width);
        bounds.upper.insert(bounds.upper.end(), zero.priors.size(), mostWidths * zero.width);
    }
    return bounds;
}

std::vector<double> InstrumentProblem::start(std::vector<double> material) const {
    material.resize(count_, 0.0);
    return material;
}

double InstrumentProblem::offsetOf(std::span<const double> x, std::size_t c) const {
    return offset_ ? x[*offset_ + c] : readings_.instrument.offset.value;
}

double InstrumentProblem::darkOf(std::span<const double> x, std::size_t c) const {
    return dark_ ? x[*dark_ + c] : readings_.instrument.dark.value;
}

double InstrumentProblem::strayOf(std::span<const double> x) const {
    return stray_ ? x[*stray_] : readings_.instrument.stray.value;
}

// z: columns of the block, mixed with columns of the veil; `difference`: veil less block, by
// column.
void InstrumentProblem::fillBlock(std::span<const double> x, bool derivatives, std::size_t begin,
                                  std::size_t size, std::vector<double>& z,
                                  const std::vector<double>& difference,
                                  const ColumnBlocks& columns, ReadingRows& rows) const {
    const std::size_t all = samples_.size(), shapes = shapeCount(), terms = sum_.linears().size();
    const auto channelCount = static_cast<Eigen::Index>(channels()),
               rowCount = static_cast<Eigen::Index>(size);
    const auto combine = [&](const double* from, std::size_t column, std::size_t c,
                             const std::vector<std::size_t>& linears, Eigen::MatrixXd& to) {
        const auto col = static_cast<Eigen::Index>(c);
        to.col(col) = Eigen::Map<const Eigen::VectorXd>(from + column * size, rowCount);
        for (std::size_t i = 0; i < linears.size(); ++i)
            to.col(col) +=
                x[shapes + linears[i] * channels() + c] *
                Eigen::Map<const Eigen::VectorXd>(from + (column + 1 + i) * size, rowCount);
    };
    std::vector<std::size_t> every(terms);
    for (std::size_t k = 0; k < terms; ++k) every[k] = k;
    const Eigen::Map<const Eigen::MatrixXd> mix(readings_.mix.data(), channelCount, channelCount);
    Eigen::MatrixXd own(rowCount, channelCount);
    // One function of all channels, to values of the readings of each.
    const auto forEach = [&](const double* from, std::size_t column,
                             const std::vector<std::size_t>& linears, auto&& write) {
        for (std::size_t c = 0; c < channels(); ++c) combine(from, column, c, linears, own);
        const Eigen::MatrixXd mixed = own * mix;  // mix is stored by rows
        for (std::size_t c = 0; c < channels(); ++c)
            for (std::size_t k = 0; k < size; ++k)
                write(c, k, mixed(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(c)));
    };
    forEach(z.data(), 0, every, [&](std::size_t c, std::size_t k, double value) {
        rows.material[c * all + begin + k] = value;
        rows.added[c * all + begin + k] = offsetOf(x, c) + darkOf(x, c) * over_[begin + k];
    });
    if (!derivatives) return;
    const auto slot = [&](std::size_t c, std::size_t k, std::size_t i) -> double& {
        return rows.slopes[c][(begin + k) * rows.places[c].size() + i];
    };
    for (std::size_t j = 0; j < shapes; ++j)
        forEach(z.data(), columns.derivative(j), sum_.linearsOf(j),
                [&](std::size_t c, std::size_t k, double value) { slot(c, k, j) = value; });
    for (std::size_t c = 0; c < channels(); ++c) {
        const std::vector<std::size_t>& places = rows.places[c];
        for (std::size_t i = shapes; i < places.size(); ++i) {
            const std::size_t place = places[i];
            if (offset_ && place == *offset_ + c) {
                for (std::size_t k = 0; k < size; ++k) slot(c, k, i) = 1;
            } else if (dark_ && place == *dark_ + c) {
                for (std::size_t k = 0; k < size; ++k) slot(c, k, i) = over_[begin + k];
            } else if (!stray_ || place != *stray_) {
                const std::size_t term = (place - shapes) / channels(),
                                  from = (place - shapes) % channels();
                const double share = readings_.mix[c * channels() + from];
                for (std::size_t k = 0; k < size; ++k)
                    slot(c, k, i) = share * z[(1 + term) * size + k];
            }
        }
    }
    if (!stray_) return;
    forEach(difference.data(), 0, every, [&](std::size_t c, std::size_t k, double value) {
        slot(c, k, rows.places[c].size() - 1) = value;
    });
}

ReadingRows InstrumentProblem::unscaled(std::span<const double> x, bool derivatives) const {
    const std::size_t count = samples_.size(), shapes = shapeCount(), terms = sum_.linears().size();
    ReadingRows rows;
    rows.material.resize(channels() * count);
    rows.added.resize(channels() * count);
    rows.weights = weights_;
    for (std::size_t c = 0; c < channels(); ++c) {
        std::vector<std::size_t> places;
        for (std::size_t j = 0; j < shapes; ++j) places.push_back(j);
        for (std::size_t t = 0; t < terms; ++t)
            for (std::size_t from = 0; from < channels(); ++from)
                if (readings_.mix[c * channels() + from] != 0)
                    places.push_back(shapes + t * channels() + from);
        if (offset_) places.push_back(*offset_ + c);
        if (dark_) places.push_back(*dark_ + c);
        if (stray_) places.push_back(*stray_);
        rows.slopes.emplace_back(derivatives ? count * places.size() : 0);
        rows.places.push_back(std::move(places));
    }
    const std::span<const double> u = x.first(shapes);
    const FitSamples moved = zeros_.empty() ? FitSamples() : turned(samples_, zerosAt(x));
    const FitSamples& samples = zeros_.empty() ? samples_ : moved;
    const std::vector<double> ratios =
        zeros_.empty() ? std::vector<double>()
                       : cosineRatios(samples, samples_, readings_.instrument.darkOver);
    const ColumnBlocks columns(samples, sum_, u, derivatives);
    const double stray = strayOf(x);
    const bool veiled = readings_.veil.has_value();
    const std::vector<double> veil =
        veiled ? veilColumns(*readings_.veil, sum_, u, derivatives) : std::vector<double>();
    const std::size_t blocks = (count + ColumnBlocks::blockSize - 1) / ColumnBlocks::blockSize;
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        const std::size_t begin = b * ColumnBlocks::blockSize,
                          size = std::min(ColumnBlocks::blockSize, count - begin);
        std::vector<double> z(columns.count() * size), difference;
        columns.fill(begin, size, z.data());
        for (std::size_t i = 0; i < (ratios.empty() ? 0 : z.size()); ++i)
            z[i] *= ratios[begin + i % size];
        if (veiled) {
            const std::size_t directions = readings_.veil->sums.size();
            difference.resize(z.size());
            for (std::size_t i = 0; i < columns.count(); ++i)
                for (std::size_t k = 0; k < size; ++k)
                    difference[i * size + k] =
                        veil[i * directions + readings_.veil->of[begin + k]] - z[i * size + k];
            for (std::size_t i = 0; i < z.size(); ++i) z[i] += stray * difference[i];
        }
        fillBlock(x, derivatives, begin, size, z, difference, columns, rows);
    });
    return rows;
}

std::vector<double> InstrumentProblem::materialAt(std::span<const double> x) const {
    return unscaled(x, false).material;
}

ReadingRows InstrumentProblem::rows(std::span<const double> x, bool derivatives) const {
    ReadingRows rows = unscaled(x, derivatives);
    if (derivatives) addZeroSlopes(x, rows);
    setScales(rows);
    return rows;
}

double InstrumentProblem::priorSquare(std::size_t scan, double scale) const {
    const double prior = priorOf(scan), width = readings_.instrument.scaleWidth;
    if (!(prior > 0)) return 0;
    const double off = std::log(scale) + width * width / 2;
    return prior * off * off;
}

// The minimum of square a^2 / 2 - product a + prior (ln a + width^2 / 2)^2 / 2: Newton in ln a.
double InstrumentProblem::bestScale(std::size_t scan, double square, double product) const {
    const double prior = priorOf(scan), width = readings_.instrument.scaleWidth;
    if (!(prior > 0)) return product / square;
    constexpr double most = 3;  // e^3 = 20
    double t = std::log(std::clamp((product + prior) / (square + prior), 0.1, 10.0));
    constexpr int steps = 50;
    for (int k = 0; k < steps; ++k) {
        const double a = std::exp(t);
        const double slope = (square * a - product) * a + prior * (t + width * width / 2);
        const double newton = (2 * square * a - product) * a + prior;
        const double step = slope / std::max(newton, 0.5 * (square * a * a + prior));
        t = std::clamp(t - step, -most, most);
        if (std::abs(step) < 1e-15) break;
    }
    return std::exp(t);
}

// Slopes by x of the material become slopes of the model.
void InstrumentProblem::setScales(ReadingRows& rows) const {
    const std::size_t count = samples_.size();
    rows.scales.assign(scanCount_, 1);
    if (!readings_.instrument.scales) return;
    std::vector<double> squares(scanCount_, 0), products(scanCount_, 0);
    for (std::size_t c = 0; c < channels(); ++c)
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t v = c * count + k, scan = scanOf(k);
            const double m = rows.material[v];
            squares[scan] += weights_[v] * m * m;
            products[scan] += weights_[v] * m * (samples_.values[v] - rows.added[v]);
        }
    for (std::size_t s = 0; s < scanCount_; ++s) {
        if (freeScale(s) && squares[s] + priorOf(s) > 0)
            rows.scales[s] = bestScale(s, squares[s], products[s]);
    }
    for (ReadingRows::ByZero& zero : rows.zeros)
        for (std::size_t v = 0; v < zero.slopes.size(); ++v)
            zero.slopes[v] *= rows.scales[scanOf(v % count)];
    for (std::size_t c = 0; c < channels(); ++c) {
        if (rows.slopes[c].empty()) continue;
        const std::vector<std::size_t>& places = rows.places[c];
        for (std::size_t i = 0; i < places.size(); ++i) {
            const std::size_t place = places[i];
            if ((offset_ && place == *offset_ + c) || (dark_ && place == *dark_ + c)) continue;
            for (std::size_t k = 0; k < count; ++k)
                rows.slopes[c][k * places.size() + i] *= rows.scales[scanOf(k)];
        }
    }
}

Equations InstrumentProblem::equations(std::span<const double> x, bool derivatives) const {
    const ReadingRows rows = this->rows(x, derivatives);
    const std::size_t count = samples_.size();
    const auto n = static_cast<Eigen::Index>(count_);
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    // For each scan: the products of the slopes by its scale and by x, and the square by its scale.
    const bool scales = readings_.instrument.scales;
    Eigen::MatrixXd across =
        Eigen::MatrixXd::Zero(n, scales ? static_cast<Eigen::Index>(scanCount_) : 0);
    std::vector<double> squares(scanCount_, 0);
    double cost = 0;
    for (std::size_t c = 0; c < channels(); ++c) {
        const std::vector<std::size_t>& places = rows.places[c];
        const auto width = static_cast<Eigen::Index>(places.size());
        Eigen::MatrixXd own = Eigen::MatrixXd::Zero(width, width);
        Eigen::VectorXd pull = Eigen::VectorXd::Zero(width);
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t v = c * count + k, scan = scanOf(k);
            const double m = rows.material[v], weight = weights_[v];
            const double r = rows.scales[scan] * m + rows.added[v] - samples_.values[v];
            cost += 0.5 * weight * r * r;
            if (!derivatives) continue;
            const Eigen::Map<const Eigen::VectorXd> slopes(
                rows.slopes[c].data() + k * places.size(), width);
            own.selfadjointView<Eigen::Lower>().rankUpdate(slopes, weight);
            pull += weight * r * slopes;
            addZeroProducts(rows, c, k, r, hessian, gradient);
            if (!scales) continue;
            for (const ReadingRows::ByZero& zero : rows.zeros)
                across(static_cast<Eigen::Index>(zero.places[k]),
                       static_cast<Eigen::Index>(scan)) += weight * m * zero.slopes[v];
            squares[scan] += weight * m * m;
            const auto column = static_cast<Eigen::Index>(scan);
            for (Eigen::Index i = 0; i < width; ++i)
                across(static_cast<Eigen::Index>(places[static_cast<std::size_t>(i)]), column) +=
                    weight * m * slopes(i);
        }
        if (!derivatives) continue;
        own.triangularView<Eigen::StrictlyUpper>() = own.transpose();
        const std::vector<Eigen::Index> at(places.begin(), places.end());
        gradient(at) += pull;
        hessian(at, at) += own;
    }
    cost += 0.5 * zeroSquares(x);
    if (derivatives) addZeroPriors(x, hessian, gradient);
    for (std::size_t s = 0; s < scanCount_; ++s) {
        cost += 0.5 * priorSquare(s, rows.scales[s]);
        const double own = squares[s] + priorWeight(s, rows.scales[s]);
        if (!derivatives || !freeScale(s) || !(own > 0)) continue;
        const auto column = across.col(static_cast<Eigen::Index>(s));
        hessian -= column * column.transpose() / own;
    }
    Equations result;
    result.cost = cost / normalisation_;
    if (!derivatives) return result;
    hessian /= normalisation_;
    gradient /= normalisation_;
    result.gradient.assign(gradient.data(), gradient.data() + n);
    result.hessian.assign(hessian.data(), hessian.data() + n * n);
    return result;
}

std::vector<double> InstrumentProblem::model(std::span<const double> x) const {
    const ReadingRows rows = this->rows(x, false);
    std::vector<double> values = rows.added;
    for (std::size_t c = 0; c < channels(); ++c)
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            const std::size_t v = c * samples_.size() + k;
            values[v] += rows.scales[scanOf(k)] * rows.material[v];
        }
    return values;
}

}  // namespace hshfit::brdfs
