#include <hshfit/representation/forms/represented_brdf.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/projection/one_basis.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/halfway/halfway.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::inline representation::inline forms {
namespace {

/// The part that every kind shares: the added BRDF, and the laws that the form keeps by itself.
class Represented : public RepresentedBrdf, public HasKinkCurves {
public:
    Represented(Representation representation, const BrdfOpener& open)
        : representation_(std::move(representation)) {
        const CoefficientHead& head = representation_.head;
        laws_.isotropic = head.isotropic;
        laws_.mirrorSymmetric = head.bilateral;
        laws_.reciprocal = representation_.kind() != Representation::Kind::outgoing &&
                           head.reciprocal && head.quantity == Quantity::brdf;
        if (representation_.added.empty()) return;
        added_ = opened(open);
        const std::size_t theirs = added_->channels().count();
        if (theirs != 1 && theirs != head.channels.count()) {
            throw InputError(fmt::format("{}: adds {}, which has {} channels instead of {}",
                                         head.source, representation_.added, theirs,
                                         head.channels.count()));
        }
        laws_.isotropic &= added_->laws().isotropic;
        laws_.mirrorSymmetric &= added_->laws().mirrorSymmetric;
        laws_.reciprocal &= added_->laws().reciprocal;
    }

    std::string name() const override { return representation_.head.source; }
    const Channels& channels() const override { return representation_.head.channels; }
    const Laws& laws() const override { return laws_; }
    const Representation& representation() const override { return representation_; }
    std::vector<Lobe> lobes(const Direction& wo) const override {
        return added_ ? added_->lobes(wo) : std::vector<Lobe>{};
    }
    std::vector<double> kinks(const Direction& wo) const override {
        return added_ ? added_->kinks(wo) : std::vector<double>{};
    }
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return added_ ? kinkCurvesOf(*added_, wo) : std::vector<KinkCurve>{};
    }

    /// The halfway form has kinks where its roots begin and where it is cut off at 0, on curves
    /// that no panel of a quadrature ends at.
    double defaultTolerance() const override {
        const double own = representation_.kind() == Representation::Kind::halfway ? 1e-2 : 1e-6;
        return added_ ? std::max(own, added_->defaultTolerance()) : own;
    }

    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        sum(wo, wi, out);
        if (!added_) return;
        const std::size_t theirs = added_->channels().count();
        std::vector<double> more(theirs * wi.count);
        added_->eval(wo, wi, more.data());
        for (std::size_t c = 0; c < channels().count(); ++c) {
            const double* from = more.data() + (theirs == 1 ? 0 : c) * wi.count;
            for (std::size_t k = 0; k < wi.count; ++k) out[c * wi.count + k] += from[k];
        }
    }

protected:
    /// f without what is added.
    virtual void sum(const Direction& wo, DirectionBatch wi, double* out) const = 0;

    Representation representation_;

private:
    /// A BRDF that a file names has to open; a failure is an error of the file.
    std::unique_ptr<Brdf> opened(const BrdfOpener& open) const {
        try {
            return open(representation_.added);
        } catch (const UsageError& error) {
            throw InputError(fmt::format("{}: adds '{}': {}", representation_.head.source,
                                         representation_.added, error.what()));
        }
    }

    std::unique_ptr<Brdf> added_;
    Laws laws_;
};

class StoredRows final : public Represented {
public:
    StoredRows(Representation representation, const BrdfOpener& open)
        : Represented(std::move(representation), open), rows_(decoded(representation_)) {}

private:
    void sum(const Direction& wo, DirectionBatch wi, double* out) const override {
        rows_.eval(wo, wi, out);
    }
    Reconstruction rows_;
};

class BothInBasis final : public Represented {
public:
    BothInBasis(Representation representation, const BrdfOpener& open)
        : Represented(std::move(representation), open),
          basis_(bases::make(representation_.head.basis, representation_.head.order,
                             {.condonShortley = representation_.head.condonShortley})),
          symmetry_(symmetryOf(representation_)),
          terms_(productTerms(*basis_, symmetry_)),
          values_(matrixValues(representation_)) {
        const std::size_t needed = terms_.size() * channels().count();
        if (values_.size() != needed) {
            throw InputError(fmt::format("{}: the matrix has {} values; {} of order {} needs {}",
                                         name(), values_.size(), basis_->name(), basis_->order(),
                                         needed));
        }
    }

private:
    /// Coefficients over wi at this wo, then the sum over the basis at every wi.
    void sum(const Direction& wo, DirectionBatch wi, double* out) const override {
        std::fill_n(out, channels().count() * wi.count, 0.0);
        if (!(wo.z > 0)) return;
        std::vector<double> atWo(basis_->slots());
        basis_->evaluate(wo, atWo.data());
        std::vector<double> c(channels().count() * basis_->slots(), 0.0);
        for (std::size_t channel = 0; channel < channels().count(); ++channel) {
            contractWithOutgoing(terms_, symmetry_, values_.data() + channel * terms_.size(),
                                 atWo.data(), c.data() + channel * basis_->slots());
        }
        synthesise(*basis_, c, wi, out);
        if (representation_.head.quantity == Quantity::brdfCosine) {
            divideByCosine(wi, channels().count(), out);
        }
    }

    std::unique_ptr<Basis> basis_;
    ProductSymmetry symmetry_;
    std::vector<ProductTerm> terms_;
    std::vector<double> values_;  ///< [channel][term]
};

class OverHalfway final : public Represented {
public:
    OverHalfway(Representation representation, const BrdfOpener& open)
        : Represented(std::move(representation), open), expansion_(representation_) {}

    /// Highlights of the form are about the half vector. The width resolves the narrowest of them:
    /// without it, directional albedos of plain metals were off by up to 43 %.
    std::vector<Lobe> lobes(const Direction& wo) const override {
        std::vector<Lobe> all = Represented::lobes(wo);
        all.push_back({.about = Lobe::About::halfway, .width = 0.02});
        return all;
    }

private:
    void sum(const Direction& wo, DirectionBatch wi, double* out) const override {
        expansion_.evaluate(wo, wi, out);
    }

    HalfwayExpansion expansion_;
};

OutgoingSet defaultSet(const Representation& representation) {
    if (representation.kind() == Representation::Kind::outgoing)
        return representation.head.outgoing;
    return OutgoingSet::parse(representation.head.isotropic ? "16" : "16x16");
}

}  // namespace

std::unique_ptr<RepresentedBrdf> reconstruct(Representation representation,
                                             const BrdfOpener& open) {
    switch (representation.kind()) {
        case Representation::Kind::outgoing:
            return std::make_unique<StoredRows>(std::move(representation), open);
        case Representation::Kind::basis:
            return std::make_unique<BothInBasis>(std::move(representation), open);
        case Representation::Kind::halfway:
            break;
    }
    return std::make_unique<OverHalfway>(std::move(representation), open);
}

Coefficients expand(const Representation& representation, const BrdfOpener& open,
                    const ExpandOptions& options) {
    const bool own =
        !options.outgoing || options.outgoing->spec() == defaultSet(representation).spec();
    if (representation.kind() == Representation::Kind::outgoing && representation.added.empty() &&
        own) {
        return decoded(representation);
    }
    const bool halfway = representation.kind() == Representation::Kind::halfway;
    const auto basis = halfway
                           ? bases::make(options.basis, options.order)
                           : bases::make(representation.head.basis, representation.head.order,
                                         {.condonShortley = representation.head.condonShortley});
    const auto brdf = reconstruct(representation, open);
    ProjectionOptions projection = options.projection;
    if (!halfway) projection.quantity = representation.head.quantity;
    const OutgoingSet set = options.outgoing ? *options.outgoing : defaultSet(representation);
    return project(*brdf, *basis, set, projection).coefficients;
}

}  // namespace hshfit::inline representation::inline forms
