// Mean logarithmic errors of coefficient files and of their shaders, against the BRDF that was
// projected.
//
//     form_errors FILE.json…
//
// For each file a line of JSON: the mean of |ln(1 + f cos(theta_i)) - ln(1 + g cos(theta_i))| over
// 4096 pairs of directions uniform on both hemispheres, for g of the library in double precision
// and of the shader of each language with its numbers as constants, as texture and, where there is
// one, as a table. Languages whose programs are missing are left out.

#include "../shaders/runners.h"

#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <exception>
#include <numbers>
#include <random>

namespace hshfit::shaders {
namespace {

/// Directions that single precision holds, uniform on the hemisphere.
std::vector<Direction> uniformDirections(std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Direction> all;
    for (int k = 0; k < Pairs::side * Pairs::side; ++k) {
        const double z = 1e-4 + (1 - 1e-4) * uniform(random), s = std::sqrt(1 - z * z);
        const double phi = 2 * std::numbers::pi * uniform(random);
        const auto single = [](double v) { return static_cast<double>(static_cast<float>(v)); };
        all.push_back({single(s * std::cos(phi)), single(s * std::sin(phi)), single(z)});
    }
    return all;
}

std::vector<double> valuesOf(const Brdf& brdf, const Pairs& pairs) {
    const std::size_t channels = brdf.channels().count();
    std::vector<double> values(pairs.wo.size() * channels);
    for (std::size_t k = 0; k < pairs.wo.size(); ++k) {
        const Direction& wi = pairs.wi[k];
        brdf.eval(pairs.wo[k], {&wi.x, &wi.y, &wi.z, 1}, values.data() + k * channels);
    }
    return values;
}

/// `place` gives the index of a pair's channel in `g`.
template <class Values, class Place>
double meanLog(const std::vector<double>& f, const Values& g, const Pairs& pairs,
               std::size_t channels, Place place) {
    double sum = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double cosine = pairs.wi[i / channels].z;
        const double value = std::max(static_cast<double>(g[place(i)]), 0.0);
        sum += std::abs(std::log1p(std::max(f[i], 0.0) * cosine) - std::log1p(value * cosine));
    }
    return sum / static_cast<double>(f.size());
}

nlohmann::ordered_json errorsOf(const std::string& path) {
    const Representation form = readRepresentation(path);
    const auto source = brdfs::open(form.head.source);
    const gpu::FormPayload payload = gpu::packForm(form);
    std::mt19937_64 random(5);
    ShaderJob job{{}, {}, {.order = 0, .colours = 0, .values = {}}};
    job.pairs.wo = uniformDirections(random);
    job.pairs.wi = uniformDirections(random);
    job.payload.head = form.head;
    job.payload.coefficients = payload.texels;
    const std::size_t channels = job.channels();
    const std::vector<double> truth = valuesOf(*source, job.pairs);
    const auto opener = [](const std::string& spec) { return brdfs::open(spec); };
    const std::vector<double> given = valuesOf(*reconstruct(form, opener), job.pairs);
    nlohmann::ordered_json row = {
        {"file", path},
        {"bytes", form.bytes()},
        {"error", meanLog(truth, given, job.pairs, channels, [](std::size_t i) { return i; })}};
    for (const gpu::LanguageEntry& language : gpu::languages()) {
        for (const gpu::Storage storage : {gpu::Storage::constants, gpu::Storage::texture}) {
            job.form = gpu::storageName(storage);
            try {
                const std::string snippet =
                    gpu::formShaderSource(language.language, payload, {.storage = storage});
                const auto found =
                    run(language.language, job, wrapped(language.language, job, snippet));
                row[fmt::format("{} {}", language.name, job.form)] = meanLog(
                    truth, found, job.pairs, channels,
                    [&](std::size_t i) { return i / channels * 2 * channels + i % channels; });
            } catch (const Missing&) {
                continue;
            }
        }
    }
    return row;
}

}  // namespace
}  // namespace hshfit::shaders

int main(int count, char** arguments) {
    try {
        if (count < 2) throw std::runtime_error("form_errors FILE.json…");
        for (int i = 1; i < count; ++i) {
            const std::string line = hshfit::shaders::errorsOf(arguments[i]).dump();
            fmt::print("{}\n", line);
            std::fflush(stdout);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
