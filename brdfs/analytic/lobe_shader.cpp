#include <brdfs/analytic/lobe_shader.h>

#include <brdfs/spec.h>
#include <brdfs/sum.h>
#include <hshfit/files/template_text.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace hshfit::embedded {
extern const std::string_view lobes_glsl;
}

namespace hshfit::brdfs {
namespace {

using kainjow::mustache::data;
using Rgb = std::array<double, 3>;

struct LobeTerm {
    double alpha = 1;
    Rgb low{}, rise{};  ///< ks F0 and ks (1 - F0), with the weight of the term
};
struct LobeSum {
    Rgb diffuse{};  ///< 1/sr
    std::vector<LobeTerm> lobes = {};
};

Rgb colourOf(const Parameters& p, std::string_view name) {
    const std::vector<double> values = p.colour(name);
    return values.size() == 3 ? Rgb{values[0], values[1], values[2]}
                              : Rgb{values[0], values[0], values[0]};
}

void addDiffuse(const Parameters& p, double weight, LobeSum& sum) {
    const Rgb kd = colourOf(p, "kd");
    for (std::size_t c = 0; c < 3; ++c) sum.diffuse[c] += weight * kd[c] / std::numbers::pi;
}

/// Whether the term has this shader.
bool addLobe(const Parameters& p, double weight, LobeSum& sum) {
    if (!p.has("alpha") || p.word("fresnel") != "schlick" || p.word("masking") != "correlated")
        return false;
    LobeTerm lobe{.alpha = p.number("alpha")};
    const Rgb ks = colourOf(p, "ks"), F0 = colourOf(p, "F0");
    for (std::size_t c = 0; c < 3; ++c) {
        lobe.low[c] = weight * ks[c] * F0[c];
        lobe.rise[c] = weight * ks[c] * (1 - F0[c]);
    }
    sum.lobes.push_back(lobe);
    addDiffuse(p, weight, sum);
    return true;
}

std::optional<LobeSum> sumOf(std::string_view spec) {
    LobeSum sum;
    for (const WeightedSpec& term : splitSum(spec, [](std::string_view) { return false; })) {
        const std::string_view text = term.spec, name = text.substr(0, text.find(':'));
        if (name != "lambert" && name != "ggx") return std::nullopt;
        const auto row = std::ranges::find(models(), name, &Model::name);
        const Parameters p = parseParameters(
            name, row->parameters, text.size() > name.size() ? text.substr(name.size() + 1) : "");
        if (name == "lambert")
            addDiffuse(p, term.weight, sum);
        else if (!addLobe(p, term.weight, sum))
            return std::nullopt;
    }
    return sum;
}

std::string vectorOf(const Rgb& rgb) {
    return fmt::format("vec3({:.9e}, {:.9e}, {:.9e})", rgb[0], rgb[1], rgb[2]);
}

}  // namespace

std::optional<std::string> lobeShader(std::string_view spec) {
    const auto sum = sumOf(spec);
    if (!sum) return std::nullopt;
    data page("diffuse", vectorOf(sum->diffuse)), lobes{data::type::list};
    page.set("any", !sum->lobes.empty());
    for (const LobeTerm& term : sum->lobes) {
        data lobe("alpha2", fmt::format("{:.9e}", term.alpha * term.alpha));
        lobe.set("low", vectorOf(term.low));
        lobe.set("rise", vectorOf(term.rise));
        lobes.push_back(lobe);
    }
    page.set("lobes", lobes);
    return filledText(embedded::lobes_glsl, page);
}

}  // namespace hshfit::brdfs
