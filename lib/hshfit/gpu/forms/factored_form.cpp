#include <hshfit/gpu/forms/internal/factored_form.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace hshfit::gpu::inline forms {
namespace {

/// The stream and the sums of a form, block by block, in one pass over both.
class FactoredText {
public:
    FactoredText(const Representation& form, const std::vector<ProductTerm>& terms,
                 const BasisNames& names)
        : form_(form), names_(names), blocks_(termBlocks(terms, symmetryOf(form))) {
        const std::vector<MatrixBlock>& stored = form.as<MatrixFactors>()->blocks;
        std::uint32_t array = 0;
        for (std::size_t b = 0; b < stored.size(); ++b) {
            const auto block = std::ranges::find(blocks_, stored[b].name, &TermBlock::name);
            array_ = array;
            index_ = b;
            if (const auto* whole = std::get_if<WholeBlock>(&stored[b].part)) {
                add(*whole, *block, terms);
                array += 1;
                continue;
            }
            if (const auto* product = std::get_if<ProductBlock>(&stored[b].part))
                add(*product, *block);
            else
                add(std::get<SymmetricBlock>(stored[b].part), *block);
            array += 2;
        }
    }

    FactoredSums result() && { return std::move(result_); }

private:
    using Place = std::optional<std::size_t>;

    Place place(std::uint32_t array, const StoredArray& of, std::size_t value) {
        if (!of.kept.empty() && !of.kept[value]) return std::nullopt;
        result_.stream.push_back({array, static_cast<std::uint32_t>(value)});
        return result_.stream.size() - 1;
    }

    /// Once the pair is turned so that wo is at azimuth 0, a term with m > 0 is the product of two
    /// functions over sqrt 2. For a sine term the product is minus a cosine function of wo times a
    /// sine function of wi.
    bool turned(const TermBlock& block) const {
        return names_.symmetry.isotropic && block.name != "0";
    }
    bool sine(const TermBlock& block) const {
        return names_.symmetry.isotropic && block.name.ends_with('s');
    }
    std::string ofWi(const TermBlock& block, int slot) const {
        return names_.ofWi(sine(block) ? mirrored(slot) : slot);
    }
    static int mirrored(int slot) {
        const Band band = bandOf(slot);
        return slot - 2 * band.m;
    }

    void run(const std::string& factor, std::vector<SumTerm> terms, const std::string& name = {}) {
        result_.sums.runs.push_back({factor, std::move(terms), name});
    }

    /// name_r = sum over slots of right[r][column] times a function.
    template <class Function>
    std::string projected(char name, std::size_t r, const std::vector<Place>& numbers,
                          const std::vector<int>& slots, Function function) {
        std::vector<SumTerm> terms;
        for (std::size_t k = 0; k < slots.size(); ++k)
            if (numbers[k]) terms.push_back({function(slots[k]), {numbers[k]}});
        if (terms.empty()) return {};
        std::string sum = fmt::format("{}{}_{}", name, index_, r);
        run({}, std::move(terms), sum);
        return sum;
    }

    void add(const WholeBlock& whole, const TermBlock& block,
             const std::vector<ProductTerm>& terms) {
        std::vector<std::size_t> places;
        for (const TermBlock::Entry& entry : block.entries) {
            if (places.empty() || places.back() != entry.term) places.push_back(entry.term);
        }
        std::vector<SumTerm> sums;
        for (std::size_t t = 0; t < places.size(); ++t) {
            SumTerm term{names_.product(terms[places[t]]), {}};
            for (std::size_t c = 0; c < form_.head.channels.count(); ++c)
                term.numbers.push_back(place(array_, whole.terms, c * places.size() + t));
            sums.push_back(std::move(term));
        }
        run({}, std::move(sums));
    }

    std::vector<Place> rightOf(const StoredArray& right, std::size_t r) {
        std::vector<Place> numbers;
        for (std::size_t k = 0; k < right.columns(); ++k)
            numbers.push_back(place(array_ + 1, right, r * right.columns() + k));
        return numbers;
    }

    void add(const ProductBlock& product, const TermBlock& block) {
        const double root = turned(block) ? std::sqrt(0.5) : 1;
        const double scale = sine(block) ? -root : root;
        for (std::size_t r = 0; r < product.right.rows(); ++r) {
            const std::string y = projected('y', r, rightOf(product.right, r), block.columns,
                                            [&](int slot) { return ofWi(block, slot); });
            std::vector<SumTerm> terms;
            for (std::size_t row = 0; row < block.rows.size(); ++row) {
                SumTerm term{names_.ofWo(block.rows[row]), {}};
                for (std::size_t c = 0; c < form_.head.channels.count(); ++c) {
                    term.numbers.push_back(
                        place(array_, product.left,
                              (c * block.rows.size() + row) * product.left.columns() + r));
                }
                terms.push_back(std::move(term));
            }
            if (y.empty()) continue;
            run(scale == 1 ? y : shaderNumber(scale) + " * " + y, std::move(terms));
        }
    }

    void add(const SymmetricBlock& symmetric, const TermBlock& block) {
        std::vector<std::string> y, z;
        const std::size_t rank = symmetric.right.rows();
        for (std::size_t r = 0; r < rank; ++r) {
            const std::vector<Place> numbers = rightOf(symmetric.right, r);
            y.push_back(projected('y', r, numbers, block.columns,
                                  [&](int slot) { return names_.ofWi(slot); }));
            z.push_back(projected('z', r, numbers, block.columns,
                                  [&](int slot) { return names_.ofWo(slot); }));
        }
        std::vector<SumTerm> terms;
        const std::size_t triangle = symmetric.core.columns();
        for (std::size_t r = 0, k = 0; r < rank; ++r) {
            for (std::size_t s = 0; s <= r; ++s, ++k) {
                SumTerm term{r == s ? fmt::format("{} * {}", z[r], y[r])
                                    : fmt::format("({} * {} + {} * {})", z[r], y[s], z[s], y[r]),
                             {}};
                for (std::size_t c = 0; c < form_.head.channels.count(); ++c)
                    term.numbers.push_back(place(array_, symmetric.core, c * triangle + k));
                if (!y[r].empty() && !y[s].empty()) terms.push_back(std::move(term));
            }
        }
        run(turned(block) ? shaderNumber(std::sqrt(0.5)) : "", std::move(terms));
    }

    const Representation& form_;
    const BasisNames& names_;
    std::vector<TermBlock> blocks_;
    std::uint32_t array_ = 0;  ///< the first of the block at hand
    std::size_t index_ = 0;
    FactoredSums result_;
};

}  // namespace

std::string BasisNames::ofWi(int slot) const {
    return fmt::format("i{}", at(slot));
}

std::string BasisNames::ofWo(int slot) const {
    return fmt::format("o{}", at(slot));
}

std::size_t BasisNames::at(int slot) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(slots, slot) - slots.begin());
}

std::string BasisNames::product(const ProductTerm& t) const {
    const auto onesided = [&](int l, int m, int k, int p) {
        return ofWo(slotOf(k, p)) + " * " + ofWi(slotOf(l, m));
    };
    const bool doubled = symmetry.reciprocal && !(t.l == t.k && t.m == t.p);
    const bool turned = symmetry.isotropic && t.m > 0;
    const bool sine = turned && t.sine;
    std::string sum = onesided(t.l, sine ? -t.m : t.m, t.k, t.p);
    // Exchanged, a sine term changes its sign, and so does the sine.
    const std::string other = onesided(t.k, sine ? -t.m : t.p, t.l, t.m);
    if (doubled) sum = fmt::format("({} {} {})", sum, sine ? "-" : "+", other);
    const double root = std::sqrt(0.5);
    const double scale = (turned ? root : 1) * (doubled ? root : 1) * (sine ? -1 : 1);
    return scale == 1 ? sum : shaderNumber(scale) + " * " + sum;
}

FactoredSums factoredSums(const Representation& form, const std::vector<ProductTerm>& terms,
                          const BasisNames& names) {
    multipliedOut(form, terms);  // refuses what does not belong together
    return FactoredText(form, terms, names).result();
}

}  // namespace hshfit::gpu::inline forms
