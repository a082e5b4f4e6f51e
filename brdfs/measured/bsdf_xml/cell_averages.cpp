#include <brdfs/measured/bsdf_xml/cell_averages.h>
#include <hshfit/brdf/colour.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>

namespace hshfit::brdfs {
namespace {

/// All cells' nodes one after another, for evaluation in one batch.
struct NodeList {
    CellNodes nodes;
    std::vector<std::size_t> ends;

    NodeList(const CellSet& cells, int points) {
        for (std::size_t k = 0; k < cells.count; ++k) {
            append(cells.nodes(k, points));
            ends.push_back(nodes.x.size());
        }
    }
    void append(const CellNodes& more) {
        nodes.x.insert(nodes.x.end(), more.x.begin(), more.x.end());
        nodes.y.insert(nodes.y.end(), more.y.begin(), more.y.end());
        nodes.z.insert(nodes.z.end(), more.z.begin(), more.z.end());
        nodes.weight.insert(nodes.weight.end(), more.weight.begin(), more.weight.end());
    }
};

class Averager {
public:
    Averager(const Brdf& brdf, const std::vector<double>& weights)
        : brdf_(brdf), weights_(weights) {}

    /// Adds share times the average over each stretch of nodes that ends at one of `ends`.
    void add(const Direction& wo, double share, const CellNodes& nodes,
             const std::vector<std::size_t>& ends, double* sums) {
        const std::size_t count = nodes.x.size();
        f_.resize(weights_.size() * count);
        brdf_.eval(wo, {nodes.x.data(), nodes.y.data(), nodes.z.data(), count}, f_.data());
        std::size_t k = 0;
        for (std::size_t cell = 0; cell < ends.size(); ++cell) {
            double sum = 0;
            for (; k < ends[cell]; ++k) {
                for (std::size_t c = 0; c < weights_.size(); ++c) {
                    const double f = f_[c * count + k];
                    if (!(f >= 0) || !std::isfinite(f)) {
                        refuse(f, {nodes.x[k], nodes.y[k], nodes.z[k]}, wo);
                    }
                    sum += nodes.weight[k] * weights_[c] * f;
                }
            }
            sums[cell] += share * sum;
        }
    }

    double pair(const CellNodes& outgoing, const CellNodes& incident) {
        double sum = 0;
        const std::vector<std::size_t> end{incident.x.size()};
        for (std::size_t k = 0; k < outgoing.x.size(); ++k) {
            add({outgoing.x[k], outgoing.y[k], outgoing.z[k]}, outgoing.weight[k], incident, end,
                &sum);
        }
        return sum;
    }

private:
    [[noreturn]] void refuse(double f, const Direction& wi, const Direction& wo) const {
        throw NumericError(fmt::format(
            "{}: f is {} at theta_i {:.6g}, phi_i {:.6g}, theta_o {:.6g}, phi_o {:.6g} degrees; "
            "BSDF XML holds finite values from 0",
            brdf_.name(), f, degrees(polarAngle(wi)), degrees(azimuth(wi)), degrees(polarAngle(wo)),
            degrees(azimuth(wo))));
    }

    const Brdf& brdf_;
    const std::vector<double>& weights_;
    std::vector<double> f_;
};

/// Points of a cell in a low-discrepancy order: multiples of the inverse of Roberts's constant
/// (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018), from `shift` on.
CellNodes scattered(const CellSet& cells, std::size_t cell, std::size_t count, double shift) {
    constexpr double ratio = 1.32471795724474602596;  // root of x^3 = x + 1
    CellNodes nodes;
    for (std::size_t k = 0; k < count; ++k) {
        const double n = static_cast<double>(k) + 0.5;
        const double u = shift + n / ratio, v = shift * ratio + n / (ratio * ratio);
        nodes.add(cells.at(cell, u - std::floor(u), v - std::floor(v)),
                  1 / static_cast<double>(count));
    }
    return nodes;
}

/// A pair of cells whose average has not settled.
struct OpenPair {
    std::size_t place = 0;  ///< [outgoing][incident]
    double change = 0;      ///< over the tolerance
};

class PairRefiner {
public:
    PairRefiner(const Brdf& brdf, const std::vector<double>& weights, const CellSet& incident,
                const CellSet& outgoing, const CellAverageOptions& options)
        : brdf_(brdf),
          weights_(weights),
          incident_(incident),
          outgoing_(outgoing),
          options_(options) {
        result_.values.resize(outgoing.count * incident.count);
        average_.resize(outgoing.count);
        change_.resize(result_.values.size());
        smooth_.resize(result_.values.size(), 0);
    }

    CellAverages run() {
        firstRules();
        std::vector<OpenPair> open = openPairs();
        for (int round = 0; !open.empty(); ++round) {
            double cost = spent_;
            std::size_t count = 0;
            while (count < open.size() && cost + costOf(open[count], round) <= options_.evaluations)
                cost += costOf(open[count++], round);
            if (count == 0) break;
            open.resize(count);
            refine(open, round);
            spent_ = cost;
            reportSpent();
            open = openPairs();
        }
        summarise();
        return std::move(result_);
    }

private:
    double allowed(std::size_t pair) const {
        return options_.tolerance *
               std::max(result_.values[pair], average_[pair / incident_.count]);
    }

    /// Points along each coordinate of the Gauss rule in a round: half as many again as before.
    int sideOf(int round) const {
        return static_cast<int>(std::ceil(2 * options_.firstPoints * std::pow(1.5, round + 1)));
    }
    /// The number of directions in a cell. Where Gauss rules converge, it is the number of a third
    /// rule's points, then of a fourth's and so on; elsewhere points are scattered, with four times
    /// as many pairs of directions in each round.
    std::size_t pointsOf(const OpenPair& pair, int round) const {
        if (round > 0 && smooth_[pair.place] == 0)
            return static_cast<std::size_t>(16 * options_.firstPoints) << (round - 1);
        const auto side = static_cast<std::size_t>(sideOf(round));
        return side * side;
    }
    double costOf(const OpenPair& pair, int round) const {
        return std::pow(static_cast<double>(pointsOf(pair, round)), 2);
    }

    void firstRules() {
        const int first = options_.firstPoints, second = 2 * first;
        const NodeList coarse(incident_, first), fine(incident_, second);
        std::atomic<std::size_t> done{0};
        tbb::parallel_for(std::size_t{0}, outgoing_.count, [&](std::size_t o) {
            Averager averager(brdf_, weights_);
            double* row = result_.values.data() + o * incident_.count;
            std::vector<double> before(incident_.count, 0.0);
            const auto wholeRow = [&](int points, const NodeList& list, double* sums) {
                const CellNodes nodes = outgoing_.nodes(o, points);
                for (std::size_t k = 0; k < nodes.x.size(); ++k) {
                    averager.add({nodes.x[k], nodes.y[k], nodes.z[k]}, nodes.weight[k], list.nodes,
                                 list.ends, sums);
                }
            };
            wholeRow(first, coarse, before.data());
            wholeRow(second, fine, row);
            for (std::size_t i = 0; i < incident_.count; ++i) {
                average_[o] += row[i] / static_cast<double>(incident_.count);
                change_[o * incident_.count + i] = std::abs(row[i] - before[i]);
            }
            if (options_.progress) options_.progress(++done, 2 * outgoing_.count);
        });
    }

    /// The greatest changes first.
    std::vector<OpenPair> openPairs() const {
        std::vector<OpenPair> open;
        for (std::size_t k = 0; k < change_.size(); ++k) {
            if (change_[k] > allowed(k)) open.push_back({k, change_[k] / allowed(k)});
        }
        std::ranges::stable_sort(open, std::greater<>{}, &OpenPair::change);
        return open;
    }

    void refine(const std::vector<OpenPair>& open, int round) {
        // A rule that converges changes by less than this part of the change before.
        constexpr double converging = 1.0 / 3;
        tbb::parallel_for(std::size_t{0}, open.size(), [&](std::size_t k) {
            const std::size_t pair = open[k].place, o = pair / incident_.count,
                              i = pair % incident_.count;
            Averager averager(brdf_, weights_);
            const bool gauss = round == 0 || smooth_[pair] != 0;
            const int side = sideOf(round);
            const double better =
                gauss ? averager.pair(outgoing_.nodes(o, side), incident_.nodes(i, side))
                      : scatteredAverage(averager, o, i, pointsOf(open[k], round));
            const double change = std::abs(better - result_.values[pair]);
            if (gauss) smooth_[pair] = change < converging * change_[pair] ? 1 : 0;
            change_[pair] = change;
            result_.values[pair] = better;
        });
    }

    /// Every direction of wo meets the cell of wi at other points.
    double scatteredAverage(Averager& averager, std::size_t o, std::size_t i, std::size_t points) {
        constexpr double golden = 0.61803398874989484820;
        const CellNodes nodes = scattered(outgoing_, o, points, 0);
        const std::vector<std::size_t> end{points};
        double sum = 0;
        for (std::size_t k = 0; k < points; ++k) {
            averager.add({nodes.x[k], nodes.y[k], nodes.z[k]}, nodes.weight[k],
                         scattered(incident_, i, points, golden * static_cast<double>(k)), end,
                         &sum);
        }
        return sum;
    }

    /// The second half of the progress: what is spent of the evaluations.
    void reportSpent() const {
        if (!options_.progress) return;
        const double share = std::min(1.0, spent_ / options_.evaluations);
        const auto rows = static_cast<double>(outgoing_.count);
        options_.progress(static_cast<std::size_t>(rows * (1 + share)), 2 * outgoing_.count);
    }

    void summarise() {
        double values = 0, changes = 0;
        for (std::size_t k = 0; k < change_.size(); ++k) {
            values += result_.values[k];
            changes += change_[k];
            if (change_[k] <= allowed(k)) continue;
            ++result_.uncertain;
            result_.worstChange =
                std::max(result_.worstChange, change_[k] / allowed(k) * options_.tolerance);
        }
        result_.typicalChange = values > 0 ? changes / values : 0;
    }

    const Brdf& brdf_;
    const std::vector<double>& weights_;
    const CellSet &incident_, &outgoing_;
    const CellAverageOptions& options_;
    CellAverages result_;
    std::vector<double> average_;  ///< of the first rules, by outgoing cell
    std::vector<double> change_;   ///< [outgoing][incident], of the last two rules
    std::vector<char> smooth_;     ///< likewise, whether Gauss rules converge
    double spent_ = 0;             ///< evaluations beyond the first two rules
};

}  // namespace

void CellNodes::add(const Direction& d, double w) {
    x.push_back(d.x);
    y.push_back(d.y);
    z.push_back(d.z);
    weight.push_back(w);
}

CellAverages averageOverCells(const Brdf& brdf, const std::vector<double>& weights,
                              const CellSet& incident, const CellSet& outgoing,
                              const CellAverageOptions& options) {
    CellAverages result = PairRefiner(brdf, weights, incident, outgoing, options).run();
    brdf.checkIntact();
    return result;
}

std::vector<double> luminanceWeights(const Brdf& brdf, std::vector<std::string>& alterations) {
    constexpr std::array<double, 3> rec709{0.2126, 0.7152, 0.0722};  // ITU-R BT.709-6, 3.2
    const Channels& channels = brdf.channels();
    if (channels.kind == Channels::Kind::grey) return {1};
    if (channels.kind == Channels::Kind::rgb) {
        alterations.push_back("red, green and blue became luminance (Rec. 709)");
        return {rec709.begin(), rec709.end()};
    }
    const RgbWeights rgb = rgbWeights(channels.wavelengths);
    std::vector<double> weights(channels.count(), 0.0);
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t k = 0; k < weights.size(); ++k) {
            weights[k] += rec709[c] * rgb.weights[c][k];
        }
    }
    alterations.push_back(
        fmt::format("{} wavelengths became luminance (CIE 1931, D65)", channels.count()));
    return weights;
}

}  // namespace hshfit::brdfs
