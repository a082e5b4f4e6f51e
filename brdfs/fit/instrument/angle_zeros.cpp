// The zeros of angles in an InstrumentProblem.
#include <brdfs/fit/instrument/instrument_problem.h>

#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

// Zeros that all samples share stand before zeros of single scans.
void InstrumentProblem::placeZeros() {
    const Instrument& instrument = readings_.instrument;
    for (const bool ofScan : {false, true}) {
        if (ofScan) commonCount_ = count_;
        for (const bool detector : {false, true}) {
            const AngleZero& own = detector ? instrument.detectorZero : instrument.incidenceZero;
            if (!own.fitted() || (own.of == AngleZero::Of::scan) != ofScan) continue;
            Zero zero{.first = count_, .ofScan = ofScan, .detector = detector, .width = own.width};
            const double prior = 1 / (own.width * own.width);
            zero.priors.assign(ofScan ? *std::ranges::max_element(samples_.scans) + 1 : 1, prior);
            if (ofScan && !times_.empty())
                for (std::size_t k = 0; k < samples_.size(); ++k)
                    zero.priors[samples_.scans[k]] = times_[k] * prior;
            count_ += zero.priors.size();
            zeros_.push_back(std::move(zero));
        }
    }
}

std::vector<AngleZeros> InstrumentProblem::zerosAt(std::span<const double> x) const {
    std::vector<AngleZeros> result(samples_.size());
    for (const Zero& zero : zeros_)
        for (std::size_t k = 0; k < result.size(); ++k)
            (zero.detector ? result[k].detector : result[k].incidence) =
                radians(x[zero.first + (zero.ofScan ? samples_.scans[k] : 0)]);
    return result;
}

// Central differences of all samples at once: each depends on one zero of a kind.
void InstrumentProblem::addZeroSlopes(std::span<const double> x, ReadingRows& rows) const {
    const double step = degrees(angleStep);
    for (const Zero& zero : zeros_) {
        std::vector<double> at(x.begin(), x.end());
        const auto moved = [&](double by) {
            for (std::size_t i = 0; i < zero.priors.size(); ++i)
                at[zero.first + i] = x[zero.first + i] + by;
            return materialAt(at);
        };
        ReadingRows::ByZero own;
        own.slopes = moved(step);
        const std::vector<double> below = moved(-step);
        for (std::size_t v = 0; v < below.size(); ++v)
            own.slopes[v] = (own.slopes[v] - below[v]) / (2 * step);
        for (std::size_t k = 0; k < samples_.size(); ++k)
            own.places.push_back(zero.first + (zero.ofScan ? samples_.scans[k] : 0));
        rows.zeros.push_back(std::move(own));
    }
}

// Rows of the hessian, of which addZeroPriors makes the columns.
void InstrumentProblem::addZeroProducts(const ReadingRows& rows, std::size_t channel, std::size_t k,
                                        double residual, Eigen::MatrixXd& hessian,
                                        Eigen::VectorXd& gradient) const {
    const std::vector<std::size_t>& places = rows.places[channel];
    const std::size_t v = channel * samples_.size() + k;
    for (const ReadingRows::ByZero& zero : rows.zeros) {
        const auto place = static_cast<Eigen::Index>(zero.places[k]);
        const double slope = weights_[v] * zero.slopes[v];
        gradient(place) += residual * slope;
        for (std::size_t i = 0; i < places.size(); ++i)
            hessian(place, static_cast<Eigen::Index>(places[i])) +=
                slope * rows.slopes[channel][k * places.size() + i];
        for (const ReadingRows::ByZero& other : rows.zeros)
            hessian(place, static_cast<Eigen::Index>(other.places[k])) += slope * other.slopes[v];
    }
}

void InstrumentProblem::addZeroPriors(std::span<const double> x, Eigen::MatrixXd& hessian,
                                      Eigen::VectorXd& gradient) const {
    if (zeros_.empty()) return;
    const auto first = static_cast<Eigen::Index>(zeros_.front().first);
    hessian.topRightCorner(first, hessian.cols() - first) =
        hessian.bottomLeftCorner(hessian.rows() - first, first).transpose();
    for (const Zero& zero : zeros_)
        for (std::size_t i = 0; i < zero.priors.size(); ++i) {
            const auto place = static_cast<Eigen::Index>(zero.first + i);
            hessian(place, place) += zero.priors[i];
            gradient(place) += zero.priors[i] * x[zero.first + i];
        }
}

double InstrumentProblem::zeroSquares(std::span<const double> x) const {
    double sum = 0;
    for (const Zero& zero : zeros_)
        for (std::size_t i = 0; i < zero.priors.size(); ++i)
            sum += zero.priors[i] * x[zero.first + i] * x[zero.first + i];
    return sum;
}

void InstrumentProblem::setZerosOfScans(std::vector<double>& x) const {
    const auto all = static_cast<Eigen::Index>(count_),
               own = static_cast<Eigen::Index>(count_ - commonCount_);
    if (own == 0) return;
    constexpr int most = 20;
    for (int step = 0; step < most; ++step) {
        const Equations at = equations(x, true);
        const Eigen::MatrixXd hessian =
            Eigen::Map<const Eigen::MatrixXd>(at.hessian.data(), all, all)
                .bottomRightCorner(own, own);
        const Eigen::VectorXd change = -hessian.ldlt().solve(
            Eigen::Map<const Eigen::VectorXd>(at.gradient.data(), all).tail(own));
        for (Eigen::Index i = 0; i < own; ++i)
            x[commonCount_ + static_cast<std::size_t>(i)] += change(i);
        constexpr double enough = 1e-9;  // degrees
        if (change.cwiseAbs().maxCoeff() < enough) return;
    }
}

}  // namespace hshfit::brdfs
