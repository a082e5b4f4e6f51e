#include <hshfit/gpu/forms/internal/factored_form.h>
#include <hshfit/gpu/forms/internal/form_rows.h>
#include <hshfit/gpu/forms/internal/form_text.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/representation/basis_matrix.h>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

namespace hshfit::gpu::inline forms {
namespace {

/// The most terms that a compiler of shaders takes in a function without giving up.
constexpr std::size_t mostTerms = 4096;
/// The most terms that a factored form may stand for.
constexpr std::size_t mostFactored = 1U << 18U;
/// Terms in one statement, so that no expression is nested too deeply for a compiler.
constexpr std::size_t termsTogether = 12;

std::unique_ptr<Basis> basisOf(const Representation& form) {
    return bases::make(form.head.basis, form.head.order,
                       {.condonShortley = form.head.condonShortley});
}

/// Counted before they are listed: an order that no matrix of the file goes with asks for no
/// memory.
std::vector<ProductTerm> termsOf(const Representation& form) {
    const auto basis = basisOf(form);
    const ProductSymmetry symmetry = symmetryOf(form);
    const std::size_t count = productTermCount(*basis, symmetry);
    const auto* matrix = form.as<MatrixArray>();
    const std::vector<std::size_t> shape{form.head.channels.count(), count};
    if (matrix && matrix->matrix.shape != shape) {
        throw InputError(fmt::format("{}: the matrix has to be {} channels x {} terms",
                                     form.head.source, shape[0], shape[1]));
    }
    if (!matrix && count > mostFactored) {
        throw InputError(
            fmt::format("{}: {} factored terms; at most {} are exported as they are: use fewer "
                        "bands or coefficients per outgoing direction",
                        form.head.source, count, mostFactored));
    }
    return productTerms(*basis, symmetry);
}

/// Slots of the functions that the terms name.
std::vector<int> slotsOf(const std::vector<ProductTerm>& terms, bool isotropic) {
    std::vector<int> slots;
    for (const ProductTerm& t : terms) {
        slots.push_back(slotOf(t.l, t.m));
        slots.push_back(slotOf(t.k, t.p));
        if (isotropic && t.sine) {
            slots.push_back(slotOf(t.l, -t.m));
            slots.push_back(slotOf(t.k, -t.m));
        }
    }
    std::ranges::sort(slots);
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    return slots;
}

/// The places of the numbers in the stream, [term][channel]: channels of a term next to each other.
using Places = std::vector<std::vector<std::optional<std::size_t>>>;
Places placesOf(const Representation& form, std::size_t terms, std::vector<StreamNumber>& stream) {
    const StoredArray& matrix = form.as<MatrixArray>()->matrix;
    Places places(terms);
    for (std::size_t t = 0; t < terms; ++t) {
        for (std::size_t c = 0; c < form.head.channels.count(); ++c) {
            const std::size_t value = c * terms + t;
            auto& place = places[t].emplace_back();
            if (!matrix.kept.empty() && !matrix.kept[value]) continue;
            place = stream.size();
            stream.push_back({0, static_cast<std::uint32_t>(value)});
        }
    }
    return places;
}

/// The sum over the stored terms of a matrix.
SumGroup matrixSums(const FormText& text, const std::vector<ProductTerm>& terms,
                    const BasisNames& names) {
    std::vector<StreamNumber> stream;
    const Places places = placesOf(text.payload.form, terms.size(), stream);
    SumGroup sum;
    for (std::size_t t = 0; t < terms.size(); ++t) {
        const bool stored = std::ranges::any_of(places[t], [](const auto& p) { return !!p; });
        if (!stored) continue;
        if (sum.runs.empty() || sum.runs.back().terms.size() == termsTogether)
            sum.runs.emplace_back();
        sum.runs.back().terms.push_back({names.product(terms[t]), places[t]});
        text.cost.products += names.symmetry.reciprocal ? 3 : 1;
    }
    return sum;
}

}  // namespace

std::vector<StreamNumber> basisStream(const Representation& form) {
    const std::vector<ProductTerm> terms = termsOf(form);
    if (form.as<MatrixFactors>()) {
        const ProductSymmetry symmetry = symmetryOf(form);
        return factoredSums(form, terms, {slotsOf(terms, symmetry.isotropic), symmetry}).stream;
    }
    std::vector<StreamNumber> stream;
    placesOf(form, terms.size(), stream);
    return stream;
}

void fillBasis(FormText& text) {
    const Representation& form = text.payload.form;
    if (text.payload.stream.size() > mostTerms * std::max<std::size_t>(text.channels(), 1)) {
        throw UsageError(fmt::format(
            "a shader of {} numbers; at most {} a channel are written: use fewer bands or "
            "coefficients per outgoing direction",
            text.payload.stream.size(), mostTerms));
    }
    const std::vector<ProductTerm> terms = termsOf(form);
    const ProductSymmetry symmetry = symmetryOf(form);
    Payload basis;
    basis.head = form.head;
    basis.slots = slotsOf(terms, symmetry.isotropic);
    ShaderCost once;
    setBasis(basis, *basisOf(form), text.page, once);
    text.cost.products += 2 * once.products;
    text.page.set("elevations", symmetry.isotropic);
    text.page.set("cosine", form.head.quantity == Quantity::brdfCosine);
    const BasisNames names{basis.slots, symmetry};
    text.setSums({form.as<MatrixFactors>() ? factoredSums(form, terms, names).sums
                                           : matrixSums(text, terms, names)});
    text.setOutputs();
}

}  // namespace hshfit::gpu::inline forms
