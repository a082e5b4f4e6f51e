#include <hshfit/representation/change.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/factoring_blocks.h>
#include <hshfit/representation/hemisphere_gram.h>

#include <cassert>
#include <cmath>

namespace hshfit::inline representation {
namespace {

/// Changes rows of slots, as many as there are, so that their Euclidean norm is the L2 norm over
/// the hemisphere.
void whitenRows(const Representation& representation, std::vector<double>& rows) {
    const CoefficientHead& head = representation.head;
    const auto basis = bases::make(head.basis, head.order, {.condonShortley = head.condonShortley});
    const HemisphereGram gram(*basis);
    if (gram.identity()) return;
    for (std::size_t at = 0; at < rows.size(); at += head.slots()) gram.whiten(rows.data() + at);
}

/// Terms as a matrix of slots for wo and wi, whitened on both sides.
std::vector<double> whitenedTerms(const Representation& representation) {
    const CoefficientHead& head = representation.head;
    const auto basis = bases::make(head.basis, head.order, {.condonShortley = head.condonShortley});
    const HemisphereGram gram(*basis);
    std::vector<double> values = matrixValues(representation);
    if (gram.identity()) return values;
    const std::vector<ProductTerm> terms = productTerms(*basis, symmetryOf(representation));
    const std::size_t slots = head.slots();
    std::vector<double> result;
    for (const TermBlock& block : termBlocks(terms, symmetryOf(representation))) {
        for (std::size_t c = 0; c < head.channels.count(); ++c) {
            std::vector<double> dense(block.rows.size() * slots, 0.0);
            for (const TermBlock::Entry& e : block.entries) {
                dense[e.row * slots + static_cast<std::size_t>(block.columns[e.column])] +=
                    e.scale * values[c * terms.size() + e.term];
            }
            for (std::size_t r = 0; r < block.rows.size(); ++r) gram.whiten(&dense[r * slots]);
            for (std::size_t column = 0; column < slots; ++column) {
                std::vector<double> of(slots, 0.0);
                for (std::size_t r = 0; r < block.rows.size(); ++r) {
                    of[static_cast<std::size_t>(block.rows[r])] = dense[r * slots + column];
                }
                gram.whiten(of.data());
                for (const int row : block.rows)
                    result.push_back(of[static_cast<std::size_t>(row)]);
            }
        }
    }
    return result;
}

std::vector<double> valuesOf(const Representation& representation) {
    switch (representation.kind()) {
        case Representation::Kind::outgoing: {
            std::vector<double> values = decoded(representation).values;
            whitenRows(representation, values);
            return values;
        }
        case Representation::Kind::basis:
            return whitenedTerms(representation);
        case Representation::Kind::halfway:
            break;
    }
    return std::get<HalfwayArray>(representation.content).halfway.values;
}

}  // namespace

std::vector<double> changeWeights(const Representation& representation) {
    if (representation.kind() != Representation::Kind::outgoing) {
        return std::vector<double>(valuesOf(representation).size(), 1.0);
    }
    const CoefficientHead& head = representation.head;
    const std::size_t perDirection = head.channels.count() * head.slots();
    std::vector<double> weights(head.outgoing.size() * perDirection);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        weights[i] = std::sqrt(head.outgoing.solidAngles[i / perDirection]);
    }
    return weights;
}

double relativeChange(const Representation& before, const Representation& after) {
    const std::vector<double> a = valuesOf(before), b = valuesOf(after);
    std::vector<double> weights = changeWeights(before);
    if (before.kind() == Representation::Kind::basis) weights.assign(a.size(), 1.0);
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

}  // namespace hshfit::inline representation
