#include <brdfs/fit/filled_in.h>

namespace hshfit::brdfs {
namespace {

std::vector<FittedWavelength> spectrumOf(const ParametricSum& sum,
                                         const std::vector<std::vector<double>>& shapes,
                                         const std::vector<double>& linear,
                                         const std::vector<double>& wavelengths) {
    std::vector<FittedWavelength> spectrum;
    const std::size_t channels = wavelengths.size();
    for (std::size_t c = 0; c < channels; ++c) {
        std::vector<double> own;
        for (std::size_t k = 0; k < sum.linears().size(); ++k)
            own.push_back(linear[k * channels + c]);
        spectrum.push_back(
            {wavelengths[c], sum.filledIn({shapes[shapes.size() == 1 ? 0 : c]}, own, 1)});
    }
    return spectrum;
}

}  // namespace

void fillIn(const ParametricSum& sum, const std::vector<std::vector<double>>& shapes,
            const std::vector<double>& linear, const Channels& channels, FitResult& result) {
    result.spec.clear();
    result.spectrum.clear();
    if (channels.kind == Channels::Kind::spectral)
        result.spectrum = spectrumOf(sum, shapes, linear, channels.wavelengths);
    else
        result.spec = sum.filledIn(shapes, linear, channels.count());
}

}  // namespace hshfit::brdfs
