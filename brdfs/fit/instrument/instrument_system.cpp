#include <brdfs/fit/instrument/instrument_system.h>

#include <brdfs/fit/correlated_spread.h>
#include <brdfs/fit/dense.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>

namespace hshfit::brdfs {

Equations equationsOf(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& spread) {
    Equations result;
    result.hessian.assign(hessian.data(), hessian.data() + hessian.size());
    result.spread.assign(spread.data(), spread.data() + spread.size());
    return result;
}

WholeSystem::WholeSystem(const InstrumentProblem& problem, const std::vector<double>& x)
    : problem_(problem), samples_(problem.readings().samples), rows_(problem.rows(x, true)) {
    for (std::size_t s = 0; s < problem.scanCount(); ++s) {
        scalePlaces_.push_back(problem.freeScale(s) ? at(x.size() + scales_.size()) : -1);
        if (problem.freeScale(s)) scales_.push_back(s);
    }
    const Eigen::Index n = at(x.size() + scales_.size());
    hessian_ = Matrix::Zero(n, n);
    for (std::size_t c = 0; c < problem.channels(); ++c)
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            const auto [places, slopes] = slopesOf(c, k);
            for (std::size_t i = 0; i < places.size(); ++i)
                for (std::size_t j = 0; j < places.size(); ++j)
                    hessian_(places[i], places[j]) += slopes(at(i)) * slopes(at(j));
        }
    addPriors();
    if (n == commonCount()) return;
    ofScans_.resize(*std::ranges::max_element(samples_.scans) + 1);
    for (const InstrumentProblem::Zero& zero : problem.zeros())
        for (std::size_t s = 0; zero.ofScan && s < zero.priors.size(); ++s)
            ofScans_[s].push_back(at(zero.first + s));
    for (const std::size_t s : scales_) ofScans_[s].push_back(scalePlaces_[s]);
}

void WholeSystem::addPriors() {
    for (const InstrumentProblem::Zero& zero : problem_.zeros())
        for (std::size_t i = 0; i < zero.priors.size(); ++i)
            priors_.push_back({at(zero.first + i), zero.priors[i]});
    for (const std::size_t s : scales_)
        if (problem_.priorOf(s) > 0)
            priors_.push_back({scalePlaces_[s], problem_.priorWeight(s, rows_.scales[s])});
    for (const Prior& prior : priors_) hessian_(prior.place, prior.place) += prior.weight;
}

WholeSystem::Slopes WholeSystem::slopesOf(std::size_t channel, std::size_t k) const {
    const std::vector<std::size_t>& own = rows_.places[channel];
    const std::size_t v = channel * samples_.size() + k, scan = problem_.scanOf(k);
    const double root = std::sqrt(rows_.weights[v]);
    Slopes result{{own.begin(), own.end()}, Vector(at(own.size() + rows_.zeros.size() + 1))};
    for (std::size_t i = 0; i < own.size(); ++i)
        result.slopes(at(i)) = root * rows_.slopes[channel][k * own.size() + i];
    const auto add = [&](Eigen::Index place, double slope) {
        result.slopes(at(result.places.size())) = root * slope;
        result.places.push_back(place);
    };
    for (const ReadingRows::ByZero& zero : rows_.zeros) add(at(zero.places[k]), zero.slopes[v]);
    if (scalePlaces_[scan] >= 0) add(scalePlaces_[scan], rows_.material[v]);
    result.slopes.conservativeResize(at(result.places.size()));
    return result;
}

WholeSystem::Matrix WholeSystem::across(const Indices& own) const {
    return hessian_(Eigen::seqN(0, commonCount()), own);
}

WholeSystem::Matrix WholeSystem::solved(const Indices& own) const {
    const Matrix inner = hessian_(own, own);
    return inner.ldlt().solve(across(own).transpose());
}

WholeSystem::Matrix WholeSystem::correlatedSpread() const {
    Matrix spread = brdfs::correlatedSpread(samples_, static_cast<std::size_t>(size()),
                                            [&](std::size_t v, Eigen::Ref<Eigen::RowVectorXd> row) {
                                                const auto [places, slopes] = slopesOf(
                                                    v / samples_.size(), v % samples_.size());
                                                for (std::size_t i = 0; i < places.size(); ++i)
                                                    row(places[i]) += slopes(at(i));
                                            });
    for (const Prior& prior : priors_) spread(prior.place, prior.place) += prior.weight;
    return spread;
}

std::vector<ScanSums> WholeSystem::scanSums() const {
    const Eigen::Index common = commonCount();
    std::vector<ScanSums> sums(*std::ranges::max_element(samples_.scans) + 1,
                               {Matrix::Zero(common, common), Vector::Zero(common)});
    forEachValue([&](std::size_t v, const Indices& places, const Vector& slopes, double r) {
        ScanSums& scan = sums[samples_.scans[v % samples_.size()]];
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (places[i] >= common) continue;
            scan.gradient(places[i]) += slopes(at(i)) * r;
            for (std::size_t j = 0; j < places.size(); ++j)
                if (places[j] < common)
                    scan.matrix(places[i], places[j]) += slopes(at(i)) * slopes(at(j));
        }
    });
    for (std::size_t s = 0; s < ofScans_.size(); ++s)
        if (!ofScans_[s].empty()) sums[s].matrix -= across(ofScans_[s]) * solved(ofScans_[s]);
    return sums;
}

WholeSystem::Matrix WholeSystem::reduced() const {
    Matrix result = hessian_.topLeftCorner(commonCount(), commonCount());
    for (const Indices& own : ofScans_)
        if (!own.empty()) result -= across(own) * solved(own);
    return result;
}

WholeSystem::Matrix WholeSystem::followed(const Matrix& among, double variance) const {
    const Eigen::Index common = commonCount(), rest = size() - common;
    Matrix whole = Matrix::Zero(size(), size());
    whole.topLeftCorner(common, common) = among;
    Matrix follow = Matrix::Zero(rest, common);
    for (const Indices& own : ofScans_) {
        if (own.empty()) continue;
        const Matrix part = solved(own), inner = hessian_(own, own);
        const Matrix inverse = inner.ldlt().solve(Matrix::Identity(at(own.size()), at(own.size())));
        for (std::size_t i = 0; i < own.size(); ++i) {
            follow.row(own[i] - common) = -part.row(at(i));
            for (std::size_t j = 0; j < own.size(); ++j)
                whole(own[i], own[j]) = variance * inverse(at(i), at(j));
        }
    }
    const Matrix mixed = follow * among;
    whole.bottomLeftCorner(rest, common) = mixed;
    whole.topRightCorner(common, rest) = mixed.transpose();
    whole.bottomRightCorner(rest, rest) += mixed * follow.transpose();
    return whole;
}

}  // namespace hshfit::brdfs
