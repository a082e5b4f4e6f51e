#include <hshfit/tradeoff/kept_projections.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace hshfit::tradeoff {
namespace {

using Kind = Representation::Kind;

/// Order of the matrices of BRDFs that are not isotropic, whose terms grow with its fourth power.
constexpr int anisotropicOrder = 8;
/// Outgoing directions below this cosine are left out of matrices.
constexpr double leastCosine = 1e-3;

bool isNested(const Form& form) {
    return form.kind == Kind::halfway || bases::find(form.basis).nested;
}

/// The fields of the form on which the projection depends, and no others.
Form partOf(const Form& form) {
    Form part;
    part.kind = form.kind;
    part.quantity = form.quantity;
    part.condonShortley = form.condonShortley;
    part.reciprocal = form.reciprocal;
    if (form.kind == Kind::halfway) {
        part.halfway = form.halfway;
        part.order = 0;
        return part;
    }
    part.basis = form.basis;
    part.order = form.order;
    part.outgoing = form.outgoing;
    return part;
}

std::string keyOf(const Form& form) {
    Form part = partOf(form);
    if (isNested(part)) part.order = 0;
    return optionsOf(part);
}

/// The projection to make for each key: the form of highest order.
std::map<std::string, Form> rootsOf(std::span<const Form> forms) {
    std::map<std::string, Form> roots;
    for (const Form& form : forms) {
        const auto [place, isNew] = roots.try_emplace(keyOf(form), form);
        if (!isNew) place->second.order = std::max(place->second.order, form.order);
    }
    return roots;
}

/// Gauss-Legendre in sqrt(cos theta_o) by equispaced azimuths, for products of `order` bands.
OutgoingSet outerNodes(int order, bool isotropic) {
    const GaussRule& rule = gaussLegendre(2 * order + 6);
    const int azimuths = isotropic ? 1 : 4 * (order / 2 + 2);
    OutgoingSet set{.map = OutgoingSet::Map::parabolic, .directions = {}, .solidAngles = {}};
    for (std::size_t r = 0; r < rule.nodes.size(); ++r) {
        const double u = (1 + rule.nodes[r]) / 2, mu = u * u;
        if (mu < leastCosine) continue;
        for (int j = 0; j < azimuths; ++j) {
            const double phi = isotropic ? 0 : (j + 0.5) * 2 * pi / azimuths;
            set.directions.push_back(directionFromAngles(std::acos(mu), phi));
            set.solidAngles.push_back(rule.weights[r] * u * 2 * pi / azimuths);
        }
    }
    set.width = static_cast<int>(set.directions.size());
    return set;
}

/// The matrix whose coefficients over wi at the nodes over wo are these.
Representation gathered(const Coefficients& c, const Basis& basis, bool reciprocal) {
    Representation result;
    result.head = c;
    result.head.outgoing = {};
    result.head.reciprocal = reciprocal;
    const ProductSymmetry symmetry = symmetryOf(result);
    const std::vector<ProductTerm> terms = productTerms(basis, symmetry);
    const std::size_t channels = c.channels.count();
    StoredArray matrix{.shape = {channels, terms.size()}, .values = {}};
    matrix.values.assign(channels * terms.size(), 0.0);
    std::vector<double> atWo(c.slots()), products(terms.size());
    for (std::size_t o = 0; o < c.outgoing.size(); ++o) {
        const Direction& wo = c.outgoing.directions[o];
        basis.evaluate(wo, atWo.data());
        const bool flux = basis.inner() == Basis::Inner::projectedSolidAngle;
        const double weight = c.outgoing.solidAngles[o] * (flux ? wo.z : 1);
        for (std::size_t channel = 0; channel < channels; ++channel) {
            evaluateProducts(terms, symmetry, c.at(o, channel), atWo.data(), products.data());
            for (std::size_t t = 0; t < terms.size(); ++t) {
                matrix.values[channel * terms.size() + t] += weight * products[t];
            }
        }
    }
    result.content = MatrixArray{std::move(matrix)};
    return result;
}

KeptProjection failureOf(const Error& error) {
    return {.failure = error.code(), .reason = error.what()};
}

}  // namespace

KeptProjections::KeptProjections(const Brdf& brdf, KeepOptions options)
    : brdf_(brdf), options_(std::move(options)) {
    if (!options_.folder || !options_.folder->isUsed()) options_.folder = nullptr;
    if (options_.folder)
        content_ = options_.folder->contentOf(brdf, brdf.name() + "\n" + options_.split);
}

void KeptProjections::expect(std::span<const Form> forms) {
    for (const auto& [key, form] : rootsOf(forms))
        orders_[key] = std::max(orders_[key], form.order);
}

std::size_t KeptProjections::projectionsFor(std::span<const Form> forms) {
    return rootsOf(forms).size();
}

void KeptProjections::prepare(std::span<const Form> forms, const std::function<void()>& done,
                              const TimeLimit& limit) {
    expect(forms);
    const std::map<std::string, Form> found = rootsOf(forms);
    std::vector<std::pair<std::string, Form>> roots(found.begin(), found.end());
    std::ranges::stable_sort(roots, {}, [](const auto& root) { return root.second.kind; });
    for (const auto& [key, form] : roots) {
        if (limit.isOver()) {
            made_[key].projection = {.failure = ExitCode::numeric, .reason = timeIsOver};
        } else if (!isMade(form)) {
            make(rootOf(form));
        }
        done();
    }
}

bool KeptProjections::isMade(const Form& form) const {
    return made_.contains(keyOf(form));
}

double KeptProjections::seconds(const Form& form) {
    return made(form).projection.seconds;
}

int KeptProjections::highestOrder(const Form& form) const {
    const bool few = form.kind == Kind::basis && !brdf_.laws().isotropic;
    const int most = few ? std::min(options_.maxOrder, anisotropicOrder) : options_.maxOrder;
    return std::min(most, bases::find(form.basis).maxOrder);
}

Form KeptProjections::rootOf(const Form& form) const {
    Form root = partOf(form);
    if (form.kind == Kind::halfway) return root;
    if (searches()) {
        root.order = highestOrder(form);
    } else if (const auto known = orders_.find(keyOf(form)); known != orders_.end()) {
        root.order = std::max(root.order, known->second);
    }
    return root;
}

/// The key of the projection in a folder. The halfway form is fitted, to no tolerance, in a search
/// as elsewhere.
std::string KeptProjections::fileKeyOf(Form root) const {
    std::string key = fmt::format("hshfit {}\n{}\n{}\n", version, brdf_.name(), content_);
    const ProjectionOptions& options = options_.projection;
    if (root.kind == Kind::halfway) {
        const Laws& laws = brdf_.laws();
        // The symmetric half of these is the whole.
        if (laws.reciprocal && (laws.mirrorSymmetric || !laws.isotropic)) root.reciprocal = true;
        root.halfway =
            halfwayOrdersOr(root.halfway, laws.isotropic, root.reciprocal || laws.reciprocal);
        return key + fmt::format("{}\nevaluations {}", optionsOf(root), fitEvaluations());
    }
    key += fmt::format("{}\ntolerance {} evaluations {}", optionsOf(root), options.tolerance,
                       options.maxEvaluations);
    if (searches())
        key += fmt::format("\nof {} to {} above {}", fmt::join(options_.bases, ","),
                           options_.maxOrder, root.kind == Kind::basis ? leastCosine : 0);
    return key;
}

std::size_t KeptProjections::fitEvaluations() const {
    return searches() ? ProjectionOptions{}.maxEvaluations : options_.projection.maxEvaluations;
}

const KeptProjections::Made& KeptProjections::made(const Form& form) {
    const std::string key = keyOf(form);
    auto found = made_.find(key);
    if (found == made_.end()) {
        make(rootOf(form));
        found = made_.find(key);
    }
    const KeptProjection& projection = found->second.projection;
    if (projection.failure == ExitCode::usage) throw UsageError(projection.reason);
    if (projection.failure != ExitCode::done) throw NumericError(projection.reason);
    return found->second;
}

void KeptProjections::make(const Form& root) {
    const auto kept = options_.folder ? options_.folder->find(fileKeyOf(root)) : std::nullopt;
    if (kept) {
        Made& made = made_[keyOf(root)];
        made.projection = *kept;
        if (root.kind == Kind::outgoing && kept->failure == ExitCode::done)
            made.coefficients = decoded(kept->representation);
        return;
    }
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::pair<Form, Made>> all;
    const auto failed = [&](const Error& error) {
        all.assign(1, {root, {.projection = failureOf(error)}});
    };
    try {
        all = searches() && root.kind != Kind::halfway ? projectedTogether(root)
                                                       : projectedAlone(root);
    } catch (const NumericError& error) {
        failed(error);
    } catch (const UsageError& error) {
        failed(error);
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (auto& [form, made] : all) {
        made.projection.seconds = seconds;
        if (options_.folder) keep(form, made);
        made_[keyOf(form)] = std::move(made);
    }
}

void KeptProjections::keep(const Form& root, const Made& made) const {
    KeptProjection projection = made.projection;
    if (root.kind == Kind::outgoing && projection.failure == ExitCode::done)
        projection.representation = fromCoefficients(made.coefficients);
    options_.folder->keep(fileKeyOf(root), projection);
}

std::vector<std::pair<Form, KeptProjections::Made>> KeptProjections::projectedAlone(
    const Form& root) const {
    ProjectionOptions options = options_.projection;
    if (root.kind == Kind::halfway) options.maxEvaluations = fitEvaluations();
    const auto source = projecting(brdf_, options);
    Made made;
    if (root.kind == Kind::outgoing) made.coefficients = source->outgoing(root);
    if (root.kind == Kind::basis) made.projection.representation = source->both(root);
    if (root.kind == Kind::halfway) made.projection.representation = source->halfway(root);
    return {{root, std::move(made)}};
}

std::vector<Coefficients> KeptProjections::allBases(const OutgoingSet& set, Quantity quantity,
                                                    int order) const {
    std::vector<std::unique_ptr<Basis>> bases;
    std::vector<const Basis*> pointers;
    for (const std::string& name : options_.bases) {
        const int highest = std::min(options_.maxOrder, bases::find(name).maxOrder);
        bases.push_back(bases::make(name, order > 0 ? std::min(order, highest) : highest));
        pointers.push_back(bases.back().get());
    }
    ProjectionOptions options = options_.projection;
    options.quantity = quantity;
    std::vector<Coefficients> result;
    for (Projection& each : project(brdf_, pointers, set, options))
        result.push_back(std::move(each.coefficients));
    return result;
}

std::vector<std::pair<Form, KeptProjections::Made>> KeptProjections::projectedTogether(
    const Form& root) const {
    const bool isotropic = brdf_.laws().isotropic;
    const bool both = root.kind == Kind::basis;
    const int order = isotropic ? options_.maxOrder : std::min(options_.maxOrder, anisotropicOrder);
    const OutgoingSet set = both ? outerNodes(order, isotropic) : outgoingOf(root, brdf_.laws());
    std::vector<Form> forms;
    for (const std::string& name : options_.bases) {
        Form& form = forms.emplace_back(root);
        form.basis = name;
        form.order = highestOrder(form);
    }
    std::vector<std::pair<Form, Made>> all;
    try {
        std::vector<Coefficients> found = allBases(set, root.quantity, both ? order : 0);
        for (std::size_t k = 0; k < forms.size(); ++k) {
            Made made;
            if (both) {
                made.projection.representation = gathered(
                    found[k], *bases::make(forms[k].basis, forms[k].order), root.reciprocal);
            } else {
                made.coefficients = std::move(found[k]);
            }
            all.emplace_back(forms[k], std::move(made));
        }
    } catch (const NumericError& error) {
        for (const Form& form : forms) all.emplace_back(form, Made{.projection = failureOf(error)});
    }
    return all;
}

Coefficients KeptProjections::outgoing(const Form& form) {
    return truncated(made(form).coefficients, form.order);
}

Representation KeptProjections::both(const Form& form) {
    const Representation& whole = made(form).projection.representation;
    return form.order == whole.head.order ? whole : truncated(whole, form.order);
}

Representation KeptProjections::halfway(const Form& form) {
    return made(form).projection.representation;
}

}  // namespace hshfit::tradeoff
