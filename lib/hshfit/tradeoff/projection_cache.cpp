#include <hshfit/tradeoff/projection_cache.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/representation/basis_matrix.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace hshfit::tradeoff {
namespace {

using Kind = Representation::Kind;

/// The fields of the form on which the projection depends, and no others.
Form rootOf(const Form& form) {
    Form root;
    root.kind = form.kind;
    root.quantity = form.quantity;
    root.condonShortley = form.condonShortley;
    if (form.kind == Kind::halfway) {
        root.halfway = form.halfway;
        root.reciprocal = form.reciprocal;
        return root;
    }
    root.basis = form.basis;
    root.order = form.order;
    root.outgoing = form.outgoing;
    root.reciprocal = form.reciprocal;
    return root;
}

std::string keyOf(const Form& form) {
    Form root = rootOf(form);
    if (root.kind != Kind::halfway && bases::find(root.basis).nested) root.order = 0;
    return optionsOf(root);
}

/// The projection to make for each key: the form of highest order.
std::map<std::string, Form> rootsOf(std::span<const Form> forms) {
    std::map<std::string, Form> roots;
    for (const Form& form : forms) {
        const auto [place, isNew] = roots.try_emplace(keyOf(form), rootOf(form));
        if (!isNew) place->second.order = std::max(place->second.order, form.order);
    }
    return roots;
}

}  // namespace

ProjectionCache::ProjectionCache(const Brdf& brdf, const ProjectionOptions& options)
    : brdf_(brdf), options_(options) {}

std::size_t ProjectionCache::projectionsFor(std::span<const Form> forms) {
    return rootsOf(forms).size();
}

void ProjectionCache::prepare(std::span<const Form> forms, const std::function<void()>& done,
                              const TimeLimit& limit) {
    const std::map<std::string, Form> found = rootsOf(forms);
    // Kinds that take little time first, which a limit then reaches.
    std::vector<std::pair<std::string, Form>> roots(found.begin(), found.end());
    std::ranges::stable_sort(roots, {}, [](const auto& root) { return root.second.kind; });
    for (const auto& [key, form] : roots) {
        Made& into = projections_[key];
        const auto start = std::chrono::steady_clock::now();
        try {
            if (limit.isOver()) throw NumericError(timeIsOver);
            make(form, into);
        } catch (const Error& error) {
            into.failure = error.code();
            into.reason = error.what();
        }
        into.seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        done();
    }
}

void ProjectionCache::make(const Form& form, Made& into) const {
    const auto source = projecting(brdf_, options_);
    into.order = form.order;
    if (form.kind == Kind::outgoing) into.coefficients = source->outgoing(form);
    if (form.kind == Kind::basis) into.representation = source->both(form);
    if (form.kind == Kind::halfway) into.representation = source->halfway(form);
}

const ProjectionCache::Made& ProjectionCache::made(const Form& form) const {
    const auto found = projections_.find(keyOf(form));
    if (found == projections_.end()) throw std::logic_error("not prepared: " + optionsOf(form));
    const Made& result = found->second;
    if (result.failure == ExitCode::usage) throw UsageError(result.reason);
    if (result.failure != ExitCode::done) throw NumericError(result.reason);
    return result;
}

double ProjectionCache::seconds(const Form& form) const {
    return made(form).seconds;
}

Coefficients ProjectionCache::outgoing(const Form& form) {
    return truncated(made(form).coefficients, form.order);
}

Representation ProjectionCache::both(const Form& form) {
    const Made& whole = made(form);
    return form.order == whole.order ? whole.representation
                                     : truncated(whole.representation, form.order);
}

Representation ProjectionCache::halfway(const Form& form) {
    return made(form).representation;
}

}  // namespace hshfit::tradeoff
