#include "lobe_text.h"

#include <hshfit/error.h>
#include <hshfit/gpu/shader_data.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

namespace hshfit::jobs {
namespace {

/// Numbers of the model as constants, or as what a texel's place among the nodes gives.
class Resolver {
public:
    explicit Resolver(const std::vector<LobeNodes>& nodes) : nodes_(nodes) {}

    LobeText::Words words(const std::vector<brdfs::FacetText::Number>& numbers) {
        LobeText::Words words;
        for (const auto& number : numbers) words.emplace_back(number.word, textOf(number));
        return words;
    }
    /// Whether all parameters of the nodes were asked for.
    bool complete() const { return used_.size() == nodes_.size(); }

private:
    std::string textOf(const brdfs::FacetText::Number& number) {
        for (std::size_t k = 0; k < nodes_.size(); ++k) {
            if (nodes_[k].name != number.parameter) continue;
            used_.insert(k);
            return std::string(nodeLanes[k]);
        }
        return gpu::shaderNumber(number.value);
    }

    const std::vector<LobeNodes>& nodes_;
    std::set<std::size_t> used_;
};

}  // namespace

LobeText lobeText(const FacetLobes& lobes, const std::string& file) {
    const brdfs::FacetText& text = lobes.at({0, 0}).normals().text;
    Resolver resolver(lobes.nodes());
    LobeText made{.axes = text.axes,
                  .density = text.density,
                  .terms = text.terms,
                  .smooth = text.smooth,
                  .words = resolver.words(text.numbers),
                  .flags = text.flags};
    for (const auto& index : text.indices) made.indices.push_back(resolver.words(index));
    if (text.terms.empty() || !resolver.complete()) {
        throw UsageError(fmt::format("{}: {} has no closed form in shaders; models that have: {}",
                                     file, lobes.model(), fmt::join(closedFacetModels(), ", ")));
    }
    return made;
}

}  // namespace hshfit::jobs
