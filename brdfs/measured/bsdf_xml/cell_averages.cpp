#include <brdfs/measured/bsdf_xml/cell_averages.h>
#include <hshfit/brdf/colour.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>

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
    const int first = options.firstPoints, second = 2 * first;
    const NodeList coarse(incident, first), fine(incident, second);
    CellAverages result;
    result.values.resize(outgoing.count * incident.count);
    std::mutex mutex;
    std::atomic<std::size_t> done{0};
    tbb::parallel_for(std::size_t{0}, outgoing.count, [&](std::size_t o) {
        Averager averager(brdf, weights);
        double* row = result.values.data() + o * incident.count;
        std::vector<double> before(incident.count, 0.0);
        const auto wholeRow = [&](int points, const NodeList& list, double* sums) {
            const CellNodes nodes = outgoing.nodes(o, points);
            for (std::size_t k = 0; k < nodes.x.size(); ++k) {
                averager.add({nodes.x[k], nodes.y[k], nodes.z[k]}, nodes.weight[k], list.nodes,
                             list.ends, sums);
            }
        };
        wholeRow(first, coarse, before.data());
        wholeRow(second, fine, row);
        double average = 0;
        for (std::size_t i = 0; i < incident.count; ++i) {
            average += row[i] / static_cast<double>(incident.count);
        }
        std::size_t uncertain = 0;
        double worst = 0;
        for (std::size_t i = 0; i < incident.count; ++i) {
            double change = std::abs(row[i] - before[i]);
            const auto allowed = [&] { return options.tolerance * std::max(row[i], average); };
            for (int points = 2 * second; change > allowed() && points <= options.mostPoints;
                 points *= 2) {
                const double better =
                    averager.pair(outgoing.nodes(o, points), incident.nodes(i, points));
                change = std::abs(better - row[i]);
                row[i] = better;
            }
            if (change > allowed()) {
                ++uncertain;
                worst = std::max(worst, change / std::max(row[i], average));
            }
        }
        const std::scoped_lock lock(mutex);
        result.uncertain += uncertain;
        result.worstChange = std::max(result.worstChange, worst);
        if (options.progress) options.progress(++done, outgoing.count);
    });
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
