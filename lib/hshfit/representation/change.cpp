#include <hshfit/representation/change.h>

#include <hshfit/representation/basis_matrix.h>

#include <cassert>
#include <cmath>

namespace hshfit {
namespace {

std::vector<double> valuesOf(const Representation& representation) {
    switch (representation.kind) {
        case Representation::Kind::outgoing:
            return decoded(representation).values;
        case Representation::Kind::basis:
            return matrixValues(representation);
        case Representation::Kind::halfway:
            break;
    }
    return representation.array("halfway").values;
}

}  // namespace

std::vector<double> changeWeights(const Representation& representation) {
    if (representation.kind != Representation::Kind::outgoing) {
        return std::vector<double>(valuesOf(representation).size(), 1.0);
    }
    const Coefficients& head = representation.head;
    const std::size_t perDirection = head.channels.count() * head.slots();
    std::vector<double> weights(head.outgoing.size() * perDirection);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        weights[i] = std::sqrt(head.outgoing.solidAngles[i / perDirection]);
    }
    return weights;
}

double relativeChange(const Representation& before, const Representation& after) {
    const std::vector<double> a = valuesOf(before), b = valuesOf(after);
    const std::vector<double> weights = changeWeights(before);
    assert(a.size() == b.size() && a.size() == weights.size());
    double change = 0, norm = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        change += std::pow(weights[i] * (b[i] - a[i]), 2);
        norm += std::pow(weights[i] * a[i], 2);
    }
    return norm > 0 ? std::sqrt(change / norm) : std::sqrt(change);
}

void addStep(Representation& after, const Representation& before, std::string what) {
    after.steps.push_back({std::move(what), relativeChange(before, after)});
}

}  // namespace hshfit
