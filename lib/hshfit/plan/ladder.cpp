#include <hshfit/plan/internal/ladder.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/halfway/halfway_terms.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <tuple>

namespace hshfit::plan {
namespace {

using Kind = Representation::Kind;

constexpr std::array elevationCounts{2, 3, 4, 6, 8, 12, 16, 24, 32};
constexpr std::array mapSizes{4, 6, 8, 10, 12, 16, 20, 24, 32};
constexpr std::array halfwaySizes{HalfwayOrders{4, 3, 2}, HalfwayOrders{5, 4, 3},
                                  HalfwayOrders{7, 6, 5}, HalfwayOrders{},
                                  HalfwayOrders{13, 12, 8}};
constexpr std::array ranks{2, 4, 8, 16};
constexpr int leastFactoredOrder = 5;
/// Anisotropic matrices have order^4 terms.
constexpr int mostAnisotropicOrder = 8;

std::size_t arrayBytes(std::vector<std::size_t> shape, Precision precision) {
    StoredArray array{.shape = std::move(shape), .precision = precision, .values = {}};
    std::size_t count = 1;
    for (std::size_t length : array.shape) count *= length;
    array.values.resize(count);
    return storedBytes(array);
}

/// Collects the rungs of one source and one split.
class Builder {
public:
    Builder(std::vector<Rung>& rungs, const LadderSource& source, std::size_t index,
            std::size_t split, const LadderOptions& options)
        : rungs_(rungs),
          laws_(source.brdf->laws()),
          channels_(source.brdf->channels().count()),
          index_(index),
          split_(source.splits[split].first),
          added_(4 * source.splits[split].second),
          options_(options) {}

    void build() {
        for (const std::string& basis : options_.bases) {
            const int highest = std::min(options_.maxOrder, bases::find(basis).maxOrder);
            for (int order = 1; order <= highest; ++order) {
                for (Quantity quantity : {Quantity::brdf, Quantity::brdfCosine}) {
                    Form form;
                    form.basis = basis;
                    form.order = order;
                    form.quantity = quantity;
                    form.split = split_;
                    outgoing(form);
                    both(form);
                }
            }
        }
        halfway();
    }

    void halfway() {
        // The halfway form is not linear and gains little from a diffuse part taken out.
        if (split_ == "diffuse") return;
        for (const HalfwayOrders& orders : halfwaySizes) {
            Form form;
            form.kind = Kind::halfway;
            form.halfway = halfwayOrdersOr(orders, laws_.isotropic, laws_.reciprocal);
            form.reciprocal = laws_.reciprocal;
            form.split = split_;
            const HalfwayTerms terms(form.halfway,
                                     {laws_.isotropic, laws_.mirrorSymmetric, form.reciprocal});
            add(form, {{channels_, terms.size()}}, lobeBytes());
        }
    }

private:
    using Shapes = std::vector<std::vector<std::size_t>>;

    /// The widths, the turn and the shelf of the lobe, and the ceilings.
    std::size_t lobeBytes() const {
        const std::size_t widths = laws_.isotropic ? 2 : 4;
        return 4 * (widths + 3 * channels_);
    }

    void add(Form form, const Shapes& shapes, std::size_t more = 0) {
        for (Precision precision :
             {Precision::unorm8, Precision::unorm16, Precision::half, Precision::float32}) {
            form.precision = precision;
            std::size_t bytes = added_ + more;
            for (const auto& shape : shapes) bytes += arrayBytes(shape, precision);
            if (bytes <= options_.maxBytes) rungs_.push_back({form, index_, bytes});
        }
    }

    std::vector<std::string> sets() const {
        const ViewRange& views = options_.views;
        std::vector<std::string> result;
        if (views.thetaMin == views.thetaMax && views.phiMin == views.phiMax && !views.anyTangent) {
            result.push_back(OutgoingSet::direction(views.thetaMin, views.phiMin).spec());
        }
        if (laws_.isotropic) {
            for (int count : elevationCounts) result.push_back(fmt::format("{}", count));
        } else {
            for (int size : mapSizes) result.push_back(fmt::format("{0}x{0}", size));
        }
        return result;
    }

    void outgoing(Form form) {
        const auto basis = bases::make(form.basis, form.order);
        for (const std::string& spec : sets()) {
            form.outgoing = spec;
            form.rank = 0;
            const OutgoingSet set = OutgoingSet::parse(spec);
            // Elevations are at azimuth 0, where sines vanish by mirror symmetry.
            const bool even = set.map == OutgoingSet::Map::elevations && laws_.mirrorSymmetric;
            std::size_t slots = 0;
            for (int l = 0; l < form.order; ++l) {
                for (int m = even ? 0 : -l; m <= l; ++m) slots += basis->has(l, m);
            }
            add(form, {{set.size(), channels_, slots}});
            const std::size_t rows = set.size() * channels_;
            for (int rank : ranks) {
                const auto r = static_cast<std::size_t>(rank);
                const bool saves = r * (rows + slots) * 4 < rows * slots * 3;
                if (form.order < leastFactoredOrder || !saves) continue;
                form.rank = rank;
                add(form, {{rows, r}, {r, slots}});
            }
        }
    }

    void both(Form form) {
        if (!bases::find(form.basis).orthonormal) return;
        if (!laws_.isotropic && form.order > mostAnisotropicOrder) return;
        form.kind = Kind::basis;
        if (laws_.reciprocal && form.quantity == Quantity::brdfCosine) return;
        form.reciprocal = laws_.reciprocal;
        const auto basis = bases::make(form.basis, form.order);
        const std::size_t terms =
            productTerms(*basis, {laws_.isotropic, laws_.mirrorSymmetric, form.reciprocal}).size();
        add(form, {{channels_, terms}});
    }

    std::vector<Rung>& rungs_;
    Laws laws_;
    std::size_t channels_, index_;
    std::string split_;
    std::size_t added_;
    const LadderOptions& options_;
};

}  // namespace

std::vector<Rung> ladder(std::span<const LadderSource> sources, const LadderOptions& options) {
    std::vector<Rung> rungs;
    for (std::size_t s = 0; s < sources.size(); ++s) {
        for (std::size_t split = 0; split < sources[s].splits.size(); ++split) {
            Builder(rungs, sources[s], s, split, options).build();
        }
    }
    std::ranges::stable_sort(rungs, std::less{}, &Rung::bytes);
    return rungs;
}

std::vector<Rung> halfwayRungs(const LadderSource& source, const LadderOptions& options) {
    std::vector<Rung> rungs;
    Builder(rungs, source, 0, 0, options).halfway();
    std::ranges::stable_sort(rungs, std::less{}, &Rung::bytes);
    return rungs;
}

bool sameNumbers(const Form& a, const Form& b) {
    Form other = b;
    other.precision = a.precision;
    return optionsOf(a) == optionsOf(other);
}

}  // namespace hshfit::plan
