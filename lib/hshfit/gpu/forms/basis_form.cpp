#include <hshfit/gpu/forms/internal/form_rows.h>
#include <hshfit/gpu/forms/internal/form_text.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/representation/basis_matrix.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::gpu::inline forms {
namespace {

/// As many terms as a compiler of shaders takes in a function without giving up.
constexpr std::size_t mostTerms = 4096;
/// Terms in one statement, so that no expression is nested too deeply for a compiler.
constexpr std::size_t termsTogether = 12;

std::unique_ptr<Basis> basisOf(const Representation& form) {
    return bases::make(form.head.basis, form.head.order,
                       {.condonShortley = form.head.condonShortley});
}

std::vector<ProductTerm> termsOf(const Representation& form) {
    std::vector<ProductTerm> terms = productTerms(*basisOf(form), symmetryOf(form));
    const auto* matrix = form.as<MatrixArray>();
    const std::vector<std::size_t> shape{form.head.channels.count(), terms.size()};
    if (!matrix || matrix->matrix.shape != shape) {
        throw InputError(fmt::format("{}: the matrix has to be {} channels x {} terms",
                                     form.head.source, shape[0], shape[1]));
    }
    return terms;
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

/// A product function (basis_matrix.h) in the names of the template. Isotropic forms are turned
/// about z until wo has azimuth 0, where its sines are 0.
class Products {
public:
    Products(const std::vector<int>& slots, const ProductSymmetry& symmetry)
        : slots_(slots), symmetry_(symmetry) {}

    std::string text(const ProductTerm& t) const {
        const bool doubled = symmetry_.reciprocal && !(t.l == t.k && t.m == t.p);
        const bool turned = symmetry_.isotropic && t.m > 0;
        const bool sine = turned && t.sine;
        std::string sum = onesided(t.l, sine ? -t.m : t.m, t.k, t.p);
        // Exchanged, a sine term changes its sign, and so does the sine.
        const std::string other = onesided(t.k, sine ? -t.m : t.p, t.l, t.m);
        if (doubled) sum = fmt::format("({} {} {})", sum, sine ? "-" : "+", other);
        const double root = std::sqrt(0.5);
        const double scale = (turned ? root : 1) * (doubled ? root : 1) * (sine ? -1 : 1);
        return scale == 1 ? sum : shaderNumber(scale) + " * " + sum;
    }

private:
    /// The function (l, m) of wi times (k, p) of wo.
    std::string onesided(int l, int m, int k, int p) const {
        return fmt::format("o{} * i{}", at(slotOf(k, p)), at(slotOf(l, m)));
    }
    std::size_t at(int slot) const {
        return static_cast<std::size_t>(std::ranges::lower_bound(slots_, slot) - slots_.begin());
    }

    const std::vector<int>& slots_;
    ProductSymmetry symmetry_;
};

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

}  // namespace

std::vector<StreamNumber> basisStream(const Representation& form) {
    std::vector<StreamNumber> stream;
    placesOf(form, termsOf(form).size(), stream);
    return stream;
}

void fillBasis(FormText& text) {
    const Representation& form = text.payload.form;
    const std::vector<ProductTerm> terms = termsOf(form);
    if (terms.size() > mostTerms) {
        throw UsageError(fmt::format(
            "a shader of {} terms; at most {} are written: use fewer bands or coefficients per "
            "outgoing direction",
            terms.size(), mostTerms));
    }
    const ProductSymmetry symmetry = symmetryOf(form);
    Payload basis;
    basis.head = form.head;
    basis.slots = slotsOf(terms, symmetry.isotropic);
    ShaderCost once;
    setBasis(basis, *basisOf(form), text.page, once);
    text.cost.products += 2 * once.products;
    text.page.set("elevations", symmetry.isotropic);
    text.page.set("cosine", form.head.quantity == Quantity::brdfCosine);

    std::vector<StreamNumber> stream;
    const Places places = placesOf(form, terms.size(), stream);
    const Products products(basis.slots, symmetry);
    SumGroup sum;
    for (std::size_t t = 0; t < terms.size(); ++t) {
        const bool stored = std::ranges::any_of(places[t], [](const auto& p) { return !!p; });
        if (!stored) continue;
        if (sum.runs.empty() || sum.runs.back().terms.size() == termsTogether)
            sum.runs.emplace_back();
        sum.runs.back().terms.push_back({products.text(terms[t]), places[t]});
        text.cost.products += symmetry.reciprocal ? 3 : 1;
    }
    text.setSums({sum});
    text.setOutputs();
}

}  // namespace hshfit::gpu::inline forms
