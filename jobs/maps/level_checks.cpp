#include "level_checks.h"

#include <hshfit/material_maps/texel_errors.h>

#include <algorithm>
#include <random>

namespace hshfit::jobs {
namespace {

constexpr std::size_t mostSamples = 1024;

/// A texel of a level, with sums over texels of level 0 below it.
struct Checked {
    std::size_t level, column, row, samples = 0;
    std::vector<double> coefficients = {}, parameters = {};
};

/// A texel of level 0 that belongs to a checked one.
struct Sample {
    std::size_t row, column, of;
};

std::vector<Checked> drawnTexels(const std::vector<LevelSize>& levels, std::size_t checks,
                                 std::mt19937_64& generator) {
    std::vector<Checked> texels;
    for (std::size_t level = 1; level < levels.size(); ++level) {
        const std::size_t count = levels[level].width * levels[level].height;
        for (std::size_t k = 0; k < std::min(checks, count); ++k) {
            const std::size_t texel = count <= checks ? k : generator() % count;
            texels.push_back({level, texel % levels[level].width, texel / levels[level].width});
        }
    }
    return texels;
}

/// All texels below, or 1,024 drawn ones.
void addSamples(const Checked& texel, std::size_t index, const std::vector<LevelSize>& levels,
                std::mt19937_64& generator, std::vector<Sample>& samples) {
    const std::size_t across = levels[0].width / levels[texel.level].width;
    const std::size_t down = levels[0].height / levels[texel.level].height;
    const std::size_t all = across * down;
    for (std::size_t k = 0; k < std::min(all, mostSamples); ++k) {
        const std::size_t at = all <= mostSamples ? k : generator() % all;
        samples.push_back(
            {texel.row * down + at / across, texel.column * across + at % across, index});
    }
}

/// One texel's coefficients from its parameters, [value][1].
std::vector<float> texelOf(const TexelKernel& kernel, const ModelLobes& lobes,
                           const std::vector<float>& parameters, std::size_t floats) {
    std::vector<float> out(floats);
    kernel.run(lobes.block(parameters, 1), 0, 1, out.data());
    return out;
}

}  // namespace

std::vector<LevelCheck> checkLevels(const MaterialMap& map, ParameterMaps& maps,
                                    const ModelLobes& lobes, const TexelKernel& kernel,
                                    const CheckWork& work, const Listener& listener) {
    const TexelLayout& layout = map.sidecar().layout;
    const auto& levels = map.sidecar().levels;
    std::mt19937_64 generator(1);
    std::vector<Checked> texels = drawnTexels(levels, work.checks, generator);
    const ItemRange mine = work.processes.share(texels.size());
    std::vector<Sample> samples;
    for (std::size_t k = 0; k < texels.size(); ++k)
        addSamples(texels[k], k, levels, generator, samples);
    std::erase_if(samples, [&](const Sample& s) { return s.of < mine.first || s.of >= mine.last; });
    std::ranges::stable_sort(samples, {}, &Sample::row);
    const auto progress = listener.part("measuring levels");
    const std::size_t values = maps.valuesOfTexel();
    std::vector<float> row, parameters(values);
    std::size_t at = levels[0].height;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const Sample& sample = samples[k];
        if (sample.row != at) row = maps.row(at = sample.row);
        for (std::size_t v = 0; v < values; ++v)
            parameters[v] = row[v * maps.width() + sample.column];
        const std::vector<float> texel = texelOf(kernel, lobes, parameters, layout.floats());
        Checked& checked = texels[sample.of];
        checked.coefficients.resize(texel.size());
        checked.parameters.resize(values);
        for (std::size_t i = 0; i < texel.size(); ++i)
            checked.coefficients[i] += static_cast<double>(texel[i]);
        for (std::size_t v = 0; v < values; ++v)
            checked.parameters[v] += static_cast<double>(parameters[v]);
        ++checked.samples;
        if (progress) progress(k + 1, samples.size());
    }
    std::vector<double> errors(2 * texels.size());  // as stored, and of averaged parameters
    for (std::size_t k = mine.first; k < mine.last; ++k) {
        Checked& checked = texels[k];
        const auto count = static_cast<double>(checked.samples);
        for (double& c : checked.coefficients) c /= count;
        for (std::size_t v = 0; v < values; ++v)
            parameters[v] = static_cast<float>(checked.parameters[v] / count);
        const std::vector<float> averaged = texelOf(kernel, lobes, parameters, layout.floats());
        errors[2 * k] =
            relativeDistance(layout, storedTexel(map, checked.level, checked.column, checked.row),
                             checked.coefficients);
        errors[2 * k + 1] = relativeDistance(
            layout, std::vector<double>(averaged.begin(), averaged.end()), checked.coefficients);
    }
    gatherValues(work.processes, texels.size(), errors);
    std::vector<LevelCheck> result;
    for (std::size_t k = 0; k < texels.size(); ++k) {
        if (result.empty() || result.back().level != texels[k].level)
            result.push_back({.level = texels[k].level});
        LevelCheck& sum = result.back();
        const double stored = errors[2 * k], byParameters = errors[2 * k + 1];
        ++sum.texels;
        sum.stored += stored;
        sum.parameters += byParameters;
        sum.storedMaximum = std::max(sum.storedMaximum, stored);
        sum.parametersMaximum = std::max(sum.parametersMaximum, byParameters);
    }
    for (LevelCheck& check : result) {
        check.stored /= static_cast<double>(check.texels);
        check.parameters /= static_cast<double>(check.texels);
    }
    return result;
}

}  // namespace hshfit::jobs
