#include <brdfs/fit/fit_result.h>

#include <brdfs/catalog/tables.h>
#include <brdfs/composed/spectrum.h>

#include <cmath>

namespace hshfit::brdfs {

std::unique_ptr<Brdf> openFit(const FitResult& result) {
    if (result.spectrum.empty()) return openModels(result.spec);
    std::vector<Spectrum::Line> lines;
    for (const FittedWavelength& own : result.spectrum)
        lines.push_back({own.nanometres, openModels(own.spec)});
    return std::make_unique<Spectrum>(std::move(lines), "fit of " + result.model);
}

std::vector<double> valuesOf(const Brdf& brdf, const FitSamples& samples) {
    const std::size_t count = samples.size(), channels = samples.channels.count();
    const std::size_t own = brdf.channels().count();
    std::vector<double> values(count * channels), buffer(own);
    if (samples.sums) {
        const std::vector<double> sums =
            summed(*samples.sums, samples.sumRows, valuesAt(brdf, *samples.sums));
        for (std::size_t v = 0; v < values.size(); ++v) values[v] = sums[own == 1 ? v % count : v];
        return values;
    }
    for (std::size_t k = 0; k < count; ++k) {
        brdf.eval(samples.wo[k], {&samples.wiX[k], &samples.wiY[k], &samples.wiZ[k], 1},
                  buffer.data());
        for (std::size_t c = 0; c < channels; ++c) values[c * count + k] = buffer[own == 1 ? 0 : c];
    }
    return values;
}

double lossOf(const Brdf& brdf, const FitSamples& samples, Loss::Kind loss) {
    return lossOf(valuesOf(brdf, samples), samples, loss);
}

double lossOf(const std::vector<double>& values, const FitSamples& samples, Loss::Kind loss) {
    double squares = 0, weights = 0;
    for (std::size_t c = 0; c < samples.channels.count(); ++c)
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const double r = mapValue(loss, values[c * samples.size() + k], samples.wiZ[k]).value -
                             mapValue(loss, samples.value(c, k), samples.wiZ[k]).value;
            const double weight = samples.weight(c, k);
            squares += weight * r * r;
            weights += weight;
        }
    return std::sqrt(squares / weights);
}

}  // namespace hshfit::brdfs
