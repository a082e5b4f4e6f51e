#include <hshfit/representation/forms/pair_evaluators.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/forms/internal/pair_kernels.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::inline representation::inline forms {
namespace {

std::size_t paddedTo(std::size_t count) {
    return (count + pairPadding - 1) / pairPadding * pairPadding;
}

std::unique_ptr<Basis> basisOf(const CoefficientHead& head) {
    return bases::make(head.basis, head.order, {.condonShortley = head.condonShortley});
}

/// A block of pairs as both kernels want it: for isotropic forms turned about z until wo has
/// azimuth 0. Places past the end repeat the last pair.
struct PairBlock {
    std::vector<double> ix, iy, iz, ox, oy, oz;

    void resize(std::size_t size) {
        for (auto* values : {&ix, &iy, &iz, &ox, &oy, &oz}) values->resize(size);
    }

    void fill(DirectionBatch wi, DirectionBatch wo, std::size_t first, std::size_t count,
              bool turn) {
        for (std::size_t k = 0; k < ix.size(); ++k) {
            const std::size_t from = first + std::min(k, count - 1);
            const double x = wi.x[from], y = wi.y[from], c = wo.x[from], s = wo.y[from];
            iz[k] = wi.z[from];
            oz[k] = wo.z[from];
            const double radius = turn ? std::sqrt(c * c + s * s) : 0;
            if (radius > 0) {
                ix[k] = (x * c + y * s) / radius;
                iy[k] = (y * c - x * s) / radius;
                ox[k] = radius;
                oy[k] = 0;
            } else {
                ix[k] = x;
                iy[k] = y;
                ox[k] = c;
                oy[k] = s;
            }
        }
    }
    DirectionBatch incoming(std::size_t count) const {
        return {ix.data(), iy.data(), iz.data(), count};
    }
    DirectionBatch outgoing(std::size_t count) const {
        return {ox.data(), oy.data(), oz.data(), count};
    }
};

/// The memory of a thread for its calls. It grows to what its largest form needs, so that later
/// calls allocate nothing.
struct Scratch {
    PairBlock pairs;
    std::vector<float> workspace, values;

    static Scratch& ofThread() {
        static thread_local Scratch scratch;
        return scratch;
    }
    void resize(std::size_t block, std::size_t workspaceSize, std::size_t valueCount) {
        pairs.resize(block);
        if (workspace.size() < workspaceSize) workspace.resize(workspaceSize);
        if (values.size() < valueCount) values.resize(valueCount);
    }
};

/// Pairs per block: basis values of both directions stay in the first-level cache.
std::size_t blockFor(std::size_t slots, std::size_t pairs) {
    const std::size_t fitting = std::clamp<std::size_t>(4096 / slots, pairPadding, 256);
    return std::min(paddedTo(fitting - pairPadding + 1), paddedTo(pairs));
}

class Linear : public PairEvaluator {
public:
    explicit Linear(const CoefficientHead& head)
        : basis_(basisOf(head)),
          channels_(head.channels.count()),
          cosine_(head.quantity == Quantity::brdfCosine) {}

    void evaluate(DirectionBatch wi, DirectionBatch wo, float* out) const final {
        const std::size_t block = blockFor(basis_->slots(), wi.count);
        Scratch& scratch = Scratch::ofThread();
        scratch.resize(block, workspaceSize(block), channels_ * block);
        PairBlock& pairs = scratch.pairs;
        float* const values = scratch.values.data();
        for (std::size_t first = 0; first < wi.count; first += block) {
            const std::size_t count = std::min(block, wi.count - first);
            pairs.fill(wi, wo, first, count, turns());
            sum(pairs, count, block, scratch.workspace.data(), values);
            for (std::size_t k = 0; k < count; ++k) {
                const bool above = pairs.iz[k] > 0 && pairs.oz[k] > 0;
                const float factor =
                    !above ? 0.0F : (cosine_ ? 1 / static_cast<float>(pairs.iz[k]) : 1.0F);
                for (std::size_t c = 0; c < channels_; ++c) {
                    const float value = values[c * block + k];
                    out[c * wi.count + first + k] = above ? value * factor : 0.0F;
                }
            }
        }
    }

protected:
    const Basis& basis() const { return *basis_; }
    std::size_t channels() const { return channels_; }
    virtual std::size_t workspaceSize(std::size_t block) const = 0;
    virtual bool turns() const = 0;
    /// The projected quantity: values[c * block + k] for k < count.
    virtual void sum(const PairBlock& pairs, std::size_t count, std::size_t block, float* workspace,
                     float* values) const = 0;

private:
    std::unique_ptr<Basis> basis_;
    std::size_t channels_;
    bool cosine_;
};

/// Both directions in one basis: one sparse bilinear form in the basis values at wi and wo.
class Both final : public Linear {
public:
    explicit Both(const Representation& r) : Linear(r.head), isotropic_(r.head.isotropic) {
        const ProductSymmetry symmetry = symmetryOf(r);
        const std::vector<ProductTerm> terms = productTerms(basis(), symmetry);
        const std::vector<double> values = matrixValues(r);
        const std::size_t slots = basis().slots();
        // [wo slot][channel][wi slot]. Where pairs are turned, sine functions vanish at wo.
        std::vector<double> dense(slots * channels() * slots, 0.0), unit(slots, 0.0);
        for (std::size_t j = 0; j < slots; ++j) {
            if (isotropic_ && isSine(static_cast<int>(j))) continue;
            unit[j] = 1;
            for (std::size_t c = 0; c < channels(); ++c) {
                contractWithOutgoing(terms, symmetry, values.data() + c * terms.size(), unit.data(),
                                     dense.data() + (j * channels() + c) * slots);
            }
            unit[j] = 0;
        }
        compress(dense, slots);
    }

private:
    static bool isSine(int slot) {
        const int l = static_cast<int>(std::sqrt(slot + 0.5));
        return slot - l * (l + 1) < 0;
    }

    void compress(const std::vector<double>& dense, std::size_t slots) {
        form_.channels = channels();
        for (std::size_t i = 0; i < slots; ++i) {
            const std::size_t start = form_.columns.size();
            for (std::size_t j = 0; j < slots; ++j) {
                bool used = false;
                const auto at = [&](std::size_t c) {
                    return dense[(j * channels() + c) * slots + i];
                };
                for (std::size_t c = 0; c < channels(); ++c) used |= at(c) != 0;
                if (!used) continue;
                form_.columns.push_back(static_cast<std::uint32_t>(j));
                for (std::size_t c = 0; c < channels(); ++c) {
                    form_.values.push_back(static_cast<float>(at(c)));
                }
            }
            if (form_.columns.size() == start) continue;
            form_.rows.push_back(static_cast<std::uint32_t>(i));
            form_.rowStarts.push_back(static_cast<std::uint32_t>(start));
        }
        form_.rowStarts.push_back(static_cast<std::uint32_t>(form_.columns.size()));
    }

    std::size_t workspaceSize(std::size_t block) const override {
        return 2 * block * basis().slots();
    }
    bool turns() const override { return isotropic_; }
    void sum(const PairBlock& pairs, std::size_t count, std::size_t block, float* workspace,
             float* values) const override {
        float* atWo = workspace + block * basis().slots();
        tabulate(pairs.incoming(count == 1 ? 1 : block), block, workspace);
        tabulate(pairs.outgoing(count == 1 ? 1 : block), block, atWo);
        sumBilinear(form_, workspace, atWo, block, values);
    }

    /// Basis values [slot][block]. One direction goes through the rows of the basis, which take
    /// no memory, and fills the block.
    void tabulate(DirectionBatch directions, std::size_t block, float* out) const {
        if (directions.count > 1) return basis().evaluateColumns(directions, out);
        basis().evaluate(directions, out);
        // From the end on: what is read lies below what has been written.
        for (std::size_t slot = basis().slots(); slot-- > 0;)
            std::fill_n(out + slot * block, block, out[slot]);
    }

    bool isotropic_;
    BilinearForm form_;
};

/// Coefficients per outgoing direction: each pair mixes the rows around its wo.
class PerOutgoing final : public Linear {
public:
    explicit PerOutgoing(const Representation& r)
        : Linear(r.head), set_(r.head.outgoing), length_(paddedTo(basis().slots())) {
        const Coefficients c = decoded(r);
        rows_.assign(set_.size() * channels() * length_, 0.0F);
        for (std::size_t row = 0; row < set_.size() * channels(); ++row) {
            for (std::size_t i = 0; i < c.slots(); ++i) {
                rows_[row * length_ + i] = static_cast<float>(c.values[row * c.slots() + i]);
            }
        }
    }

private:
    std::size_t workspaceSize(std::size_t block) const override { return block * basis().slots(); }
    bool turns() const override { return set_.map == OutgoingSet::Map::elevations; }
    void sum(const PairBlock& pairs, std::size_t count, std::size_t block, float* workspace,
             float* values) const override {
        constexpr std::size_t together = 64;
        std::array<RowMix, together> mixes;
        const auto slots = static_cast<std::size_t>(basis().slots());
        basis().evaluate(pairs.incoming(count), workspace);
        for (std::size_t first = 0; first < count; first += together) {
            const std::size_t some = std::min(together, count - first);
            for (std::size_t k = 0; k < some; ++k) mixes[k] = mixAt(pairs, first + k);
            dotMixed({.basis = workspace + first * slots,
                      .length = slots,
                      .stride = length_,
                      .channels = channels(),
                      .count = some,
                      .outStride = block},
                     mixes.data(), values + first);
        }
    }

    RowMix mixAt(const PairBlock& pairs, std::size_t k) const {
        // Turned pairs have wo at azimuth 0.
        const OutgoingLookup found =
            turns() ? lookUpElevation(set_, pairs.ox[k] / (1 + std::max(pairs.oz[k], 0.0)))
                    : lookUp(set_, {pairs.ox[k], pairs.oy[k], pairs.oz[k]});
        RowMix mix;
        mix.count = found.count;
        for (int r = 0; r < found.count; ++r) {
            mix.rows[r] = rows_.data() + found.index[r] * channels() * length_;
            mix.weights[r] = static_cast<float>(found.weight[r]);
        }
        return mix;
    }

    OutgoingSet set_;
    std::size_t length_;
    std::vector<float> rows_;  ///< [outgoing][channel][padded slot]
};

/// Adds a BRDF, pair by pair: as fast as that BRDF is.
class WithAdded final : public PairEvaluator {
public:
    WithAdded(std::unique_ptr<PairEvaluator> sum, std::unique_ptr<Brdf> added, std::size_t channels)
        : sum_(std::move(sum)), added_(std::move(added)), channels_(channels) {}

    void evaluate(DirectionBatch wi, DirectionBatch wo, float* out) const override {
        sum_->evaluate(wi, wo, out);
        const std::size_t theirs = added_->channels().count();
        std::vector<double> values(theirs);
        for (std::size_t k = 0; k < wi.count; ++k) {
            added_->eval({wo.x[k], wo.y[k], wo.z[k]}, {wi.x + k, wi.y + k, wi.z + k, 1},
                         values.data());
            for (std::size_t c = 0; c < channels_; ++c) {
                out[c * wi.count + k] += static_cast<float>(values[theirs == 1 ? 0 : c]);
            }
        }
    }

private:
    std::unique_ptr<PairEvaluator> sum_;
    std::unique_ptr<Brdf> added_;
    std::size_t channels_;
};

std::unique_ptr<PairEvaluator> withoutAdded(const Representation& r) {
    switch (r.kind()) {
        case Representation::Kind::outgoing:
            return std::make_unique<PerOutgoing>(r);
        case Representation::Kind::basis:
            return std::make_unique<Both>(r);
        case Representation::Kind::halfway:
            break;
    }
    return halfwayPairEvaluator(r);
}

}  // namespace

std::unique_ptr<PairEvaluator> pairEvaluator(const Representation& representation,
                                             const BrdfOpener& open) {
    reconstruct(representation, open);  // throws where the parts do not belong together
    auto sum = withoutAdded(representation);
    if (representation.added.empty()) return sum;
    return std::make_unique<WithAdded>(std::move(sum), open(representation.added),
                                       representation.head.channels.count());
}

}  // namespace hshfit::inline representation::inline forms
