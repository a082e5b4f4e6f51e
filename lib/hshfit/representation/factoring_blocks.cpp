#include <hshfit/representation/factoring_blocks.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace hshfit::inline representation {
namespace {

std::string blockName(const ProductTerm& term, const ProductSymmetry& symmetry) {
    if (symmetry.isotropic) return fmt::format("{}{}", term.m, term.sine ? "s" : "");
    if (!symmetry.bilateral) return "all";
    return fmt::format("{}{}", term.m < 0 ? 's' : 'c', std::abs(term.m) % 2);
}

std::size_t placeOf(int slot, const std::vector<int>& slots) {
    return static_cast<std::size_t>(std::ranges::lower_bound(slots, slot) - slots.begin());
}

void insert(std::vector<int>& slots, int slot) {
    const auto at = std::ranges::lower_bound(slots, slot);
    if (at == slots.end() || *at != slot) slots.insert(at, slot);
}

[[noreturn]] void refuse(const Representation& matrix, const TermBlock& block,
                         const std::string& what) {
    throw InputError(
        fmt::format("{}: block '{}' of the form basis {}", matrix.head.source, block.name, what));
}

void requireShape(const Representation& matrix, const TermBlock& block, const StoredArray& array,
                  const char* part, std::size_t rows, std::size_t columns) {
    if (array.shape == std::vector<std::size_t>{rows, columns}) return;
    refuse(matrix, block, fmt::format("has to have {} x {} {}", rows, columns, part));
}

/// A block's matrix of one channel, row-major, from its factors.
class BlockProduct {
public:
    BlockProduct(const Representation& matrix, const TermBlock& block, const MatrixBlock& stored)
        : block_(block) {
        const auto* product = std::get_if<ProductBlock>(&stored.part);
        const auto* symmetric = std::get_if<SymmetricBlock>(&stored.part);
        if (block.symmetric ? !symmetric : !product) {
            refuse(matrix, block,
                   fmt::format("is missing '{}' and 'right'", block.symmetric ? "core" : "left"));
        }
        right_ = symmetric ? &symmetric->right : &product->right;
        left_ = symmetric ? &symmetric->core : &product->left;
        const std::size_t channels = matrix.head.channels.count(), rank = right_->rows();
        requireShape(matrix, block, *right_, "right factors", rank, block.columns.size());
        if (symmetric) {
            requireShape(matrix, block, *left_, "entries of its core", channels,
                         rank * (rank + 1) / 2);
        } else {
            requireShape(matrix, block, *left_, "left factors", channels * block.rows.size(), rank);
        }
    }

    double entry(std::size_t channel, std::size_t row, std::size_t column) const {
        const std::size_t rank = right_->rows();
        double sum = 0;
        for (std::size_t r = 0; r < rank; ++r) {
            sum += factor(channel, row, r) * right(r, column);
        }
        return sum;
    }

private:
    double right(std::size_t r, std::size_t column) const {
        return right_->values[r * block_.columns.size() + column];
    }
    /// The factor of right(r, .) in this row.
    double factor(std::size_t channel, std::size_t row, std::size_t r) const {
        const std::size_t rank = right_->rows();
        if (!block_.symmetric) {
            return left_->values[(channel * block_.rows.size() + row) * rank + r];
        }
        const double* core = left_->values.data() + channel * (rank * (rank + 1) / 2);
        double sum = 0;
        for (std::size_t s = 0; s < rank; ++s) {
            const std::size_t high = std::max(r, s), low = std::min(r, s);
            sum += core[high * (high + 1) / 2 + low] * right(s, row);
        }
        return sum;
    }

    const TermBlock& block_;
    const StoredArray* right_ = nullptr;
    const StoredArray* left_ = nullptr;  ///< the core where symmetric
};

}  // namespace

std::vector<TermBlock> termBlocks(const std::vector<ProductTerm>& terms,
                                  const ProductSymmetry& symmetry) {
    std::vector<TermBlock> blocks;
    std::map<std::string, std::size_t> places;
    std::vector<std::size_t> blockOf;
    for (const ProductTerm& term : terms) {
        const std::string name = blockName(term, symmetry);
        const auto [place, isNew] = places.emplace(name, blocks.size());
        if (isNew) {
            blocks.push_back({.name = name,
                              .symmetric = symmetry.reciprocal && !term.sine,
                              .antisymmetric = symmetry.reciprocal && term.sine,
                              .rows = {},
                              .columns = {},
                              .entries = {}});
        }
        TermBlock& block = blocks[place->second];
        blockOf.push_back(place->second);
        insert(block.rows, slotOf(term.k, term.p));
        insert(block.columns, slotOf(term.l, term.m));
        if (!symmetry.reciprocal) continue;
        insert(block.columns, slotOf(term.k, term.p));
        insert(block.rows, slotOf(term.l, term.m));
    }
    for (std::size_t t = 0; t < terms.size(); ++t) {
        TermBlock& block = blocks[blockOf[t]];
        const int k = slotOf(terms[t].k, terms[t].p), l = slotOf(terms[t].l, terms[t].m);
        const bool paired = symmetry.reciprocal && k != l;
        const double scale = paired ? 1 / std::numbers::sqrt2 : 1;
        block.entries.push_back({t, placeOf(k, block.rows), placeOf(l, block.columns), scale});
        if (!paired) continue;
        block.entries.push_back(
            {t, placeOf(l, block.rows), placeOf(k, block.columns), terms[t].sine ? -scale : scale});
    }
    return blocks;
}

std::vector<double> multipliedOut(const Representation& matrix,
                                  const std::vector<ProductTerm>& terms) {
    const std::vector<MatrixBlock>& stored = std::get<MatrixFactors>(matrix.content).blocks;
    const std::size_t channels = matrix.head.channels.count();
    std::vector<double> values(channels * terms.size(), 0.0);
    std::size_t used = 0;
    for (const TermBlock& block : termBlocks(terms, symmetryOf(matrix))) {
        const auto found = std::ranges::find(stored, block.name, &MatrixBlock::name);
        if (found == stored.end()) continue;
        ++used;
        if (const auto* whole = std::get_if<WholeBlock>(&found->part)) {
            const StoredArray& stack = whole->terms;
            std::vector<std::size_t> places;
            for (const TermBlock::Entry& entry : block.entries) {
                if (places.empty() || places.back() != entry.term) places.push_back(entry.term);
            }
            requireShape(matrix, block, stack, "terms", channels, places.size());
            for (std::size_t i = 0; i < stack.values.size(); ++i) {
                values[i / places.size() * terms.size() + places[i % places.size()]] =
                    stack.values[i];
            }
            continue;
        }
        // A term is the inner product of its function with the sum: the sum of its entries times
        // their factors.
        const BlockProduct product(matrix, block, *found);
        for (std::size_t c = 0; c < channels; ++c) {
            for (const TermBlock::Entry& entry : block.entries) {
                values[c * terms.size() + entry.term] +=
                    entry.scale * product.entry(c, entry.row, entry.column);
            }
        }
    }
    if (used == 0 || used != stored.size()) {
        throw InputError(fmt::format("{}: of {} factored blocks, {} are blocks of the form basis",
                                     matrix.head.source, stored.size(), used));
    }
    return values;
}

}  // namespace hshfit::inline representation
