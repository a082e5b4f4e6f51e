#include <hshfit/wavelets/soho.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace hshfit::wavelets {
namespace {

/// The filters of a triangle from its children.
struct Filter {
    double s, g, b;
    Filter(const Triangle& parent, const Triangle& central, const Triangle& outer)
        : s(std::sqrt(central.area / parent.area)),
          g(std::sqrt(outer.area / parent.area)),
          b((s - 1) / 3) {}
};

Filter filterOf(const Partition& partition, int j, std::size_t k) {
    const std::vector<Triangle>& children = partition.level(j + 1);
    return {partition.level(j)[k], children[4 * k], children[4 * k + 1]};
}

std::vector<std::size_t> byMagnitude(std::span<const double> coefficients, std::size_t k) {
    std::vector<std::size_t> order(coefficients.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    k = std::min(k, order.size());
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(k), order.end(),
                      [&](std::size_t one, std::size_t other) {
                          const double a = std::abs(coefficients[one]);
                          const double b = std::abs(coefficients[other]);
                          return a != b ? a > b : one < other;
                      });
    order.resize(k);
    return order;
}

double coefficientAt(std::span<const Term> terms, std::size_t index) {
    const auto found =
        std::lower_bound(terms.begin(), terms.end(), index,
                         [](const Term& term, std::size_t wanted) { return term.index < wanted; });
    return found != terms.end() && found->index == index ? found->value : 0;
}

}  // namespace

void analyse(const Partition& partition, const double* averages, double* coefficients) {
    std::vector<double> scaling(partition.leaves());
    for (std::size_t k = 0; k < scaling.size(); ++k) {
        scaling[k] = averages[k] * std::sqrt(partition.level(partition.levels())[k].area);
    }
    for (int j = partition.levels() - 1; j >= 0; --j) {
        const std::size_t count = partition.level(j).size();
        for (std::size_t k = 0; k < count; ++k) {
            const Filter filter = filterOf(partition, j, k);
            const double* child = scaling.data() + 4 * k;
            const double outer = child[1] + child[2] + child[3], central = child[0];
            double* to = coefficients + count + 3 * k;
            for (int i = 0; i < 3; ++i) {
                to[i] = child[i + 1] + filter.b * outer - filter.g * central;
            }
            scaling[k] = filter.s * central + filter.g * outer;
        }
    }
    std::copy_n(scaling.begin(), partition.roots(), coefficients);
}

void synthesise(const Partition& partition, const double* coefficients, double* averages) {
    std::vector<double> scaling(coefficients, coefficients + partition.roots()), next;
    for (int j = 0; j < partition.levels(); ++j) {
        const std::size_t count = partition.level(j).size();
        next.resize(4 * count);
        for (std::size_t k = 0; k < count; ++k) {
            const Filter filter = filterOf(partition, j, k);
            const double* w = coefficients + count + 3 * k;
            const double sum = w[0] + w[1] + w[2];
            double* child = next.data() + 4 * k;
            child[0] = filter.s * scaling[k] - filter.g * sum;
            for (int i = 0; i < 3; ++i) {
                child[i + 1] = filter.g * scaling[k] + w[i] + filter.b * sum;
            }
        }
        scaling.swap(next);
    }
    for (std::size_t k = 0; k < scaling.size(); ++k) {
        averages[k] = scaling[k] / std::sqrt(partition.level(partition.levels())[k].area);
    }
}

std::vector<double> averagesOf(const Partition& partition, const SphereFunction& f) {
    std::vector<double> averages;
    averages.reserve(partition.leaves());
    for (const Triangle& leaf : partition.level(partition.levels())) {
        averages.push_back(f(centreOf(leaf)));
    }
    return averages;
}

std::vector<Term> bestTerms(std::span<const double> coefficients, std::size_t k) {
    std::vector<Term> terms;
    for (const std::size_t index : byMagnitude(coefficients, k)) {
        terms.push_back({static_cast<std::uint32_t>(index), coefficients[index]});
    }
    std::sort(terms.begin(), terms.end(),
              [](const Term& one, const Term& other) { return one.index < other.index; });
    return terms;
}

std::vector<double> capturedByTerms(std::span<const double> coefficients, std::size_t most) {
    std::vector<double> captured{0};
    for (const std::size_t index : byMagnitude(coefficients, most)) {
        captured.push_back(captured.back() + coefficients[index] * coefficients[index]);
    }
    captured.resize(most + 1, captured.back());
    return captured;
}

double valueOf(const Partition& partition, std::span<const Term> terms, const Direction& d) {
    std::array<unsigned char, Partition::mostLevels + 1> path{};
    // Levels below the last term change nothing.
    int levels = 0;
    for (std::size_t count = partition.roots(); levels < partition.levels(); count *= 4, ++levels) {
        if (terms.empty() || terms.back().index < count) break;
    }
    partition.locate(d, levels, path.data());
    std::size_t k = path[0];
    double value = coefficientAt(terms, k) / std::sqrt(partition.level(0)[k].area);
    for (int j = 0; j < levels; ++j) {
        const std::size_t first = partition.level(j).size() + 3 * k;
        const double w[] = {coefficientAt(terms, first), coefficientAt(terms, first + 1),
                            coefficientAt(terms, first + 2)};
        const double sum = w[0] + w[1] + w[2];
        const Filter filter = filterOf(partition, j, k);
        const int child = path[static_cast<std::size_t>(j) + 1];
        k = 4 * k + static_cast<std::size_t>(child);
        const double root = std::sqrt(partition.level(j + 1)[k].area);
        value += (child == 0 ? -filter.g * sum : w[child - 1] + filter.b * sum) / root;
    }
    return value;
}

}  // namespace hshfit::wavelets
