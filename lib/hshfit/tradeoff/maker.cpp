#include <hshfit/tradeoff/internal/maker.h>

#include <hshfit/error.h>

#include <utility>

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
        part.kept->prepare(list, done, limit);
    }
}

std::size_t Maker::projectionsFor(const std::vector<Form>& forms) {
    std::size_t sum = 0;
    for (const auto& [name, list] : bySplit(forms)) sum += KeptProjections::projectionsFor(list);
    return sum;
}

Representation Maker::make(const Form& form) const {
    const Part& part = partOf(form);
    Representation result = represent(*part.kept, form, part.split.added);
    result.head.source = brdf_.name();
    return result;
}

void Maker::prepareOne(const std::string& name, Part& part) const {
    KeepOptions how{.projection = projection_, .folder = &folder_, .split = name};
    if (!name.empty()) {
        part.split = takeOut(brdf_, name, open_);
        if (projection_.tolerance == 0) how.projection.tolerance = brdf_.defaultTolerance();
    }
    const Brdf& brdf = name.empty() ? brdf_ : *part.split.remainder;
    part.kept = std::make_unique<KeptProjections>(brdf, std::move(how));
}

const Maker::Part& Maker::partOf(const Form& form) const {
    const Part& part = parts_.at(form.split);
    if (!part.failure.empty()) throw NumericError(part.failure);
    return part;
}

}  // namespace hshfit::tradeoff
