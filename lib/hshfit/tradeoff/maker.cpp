#include <hshfit/tradeoff/internal/maker.h>

#include <hshfit/error.h>

namespace hshfit::tradeoff {
namespace {

std::map<std::string, std::vector<Form>> bySplit(const std::vector<Form>& forms) {
    std::map<std::string, std::vector<Form>> lists;
    for (const Form& form : forms) lists[form.split].push_back(form);
    return lists;
}

}  // namespace

void Maker::prepare(const std::vector<Form>& forms, const TimeLimit& limit,
                    const std::function<void()>& done) {
    for (const auto& [name, list] : bySplit(forms)) {
        Part& part = parts_[name];
        try {
            prepareOne(name, part);
        } catch (const Error& error) {
            part.failure = error.what();
            continue;
        }
        part.cache->prepare(list, done, limit);
    }
}

std::size_t Maker::projectionsFor(const std::vector<Form>& forms) {
    std::size_t sum = 0;
    for (const auto& [name, list] : bySplit(forms)) sum += ProjectionCache::projectionsFor(list);
    return sum;
}

Representation Maker::make(const Form& form) const {
    const Part& part = partOf(form);
    Representation result = represent(*part.cache, form, part.split.added);
    result.head.source = brdf_.name();
    return result;
}

void Maker::prepareOne(const std::string& name, Part& part) const {
    if (name.empty()) {
        part.cache = std::make_unique<ProjectionCache>(brdf_, projection_);
        return;
    }
    part.split = takeOut(brdf_, name, open_);
    ProjectionOptions projection = projection_;
    if (projection.tolerance == 0) projection.tolerance = brdf_.defaultTolerance();
    part.cache = std::make_unique<ProjectionCache>(*part.split.remainder, projection);
}

const Maker::Part& Maker::partOf(const Form& form) const {
    const Part& part = parts_.at(form.split);
    if (!part.failure.empty()) throw NumericError(part.failure);
    return part;
}

}  // namespace hshfit::tradeoff
