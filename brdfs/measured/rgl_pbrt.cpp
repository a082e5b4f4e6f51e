#include <brdfs/measured/rgl_pbrt.h>

#include <algorithm>
#include <utility>

namespace hshfit::brdfs {

const std::array<std::array<float, 3>, colourWavelengths> colourSpectra{{
    {0.052699F, 0.000000F, 0.947301F},
    {0.049561F, 0.000000F, 0.950439F},
    {0.028301F, 0.000000F, 0.971699F},
    {0.008023F, 0.000000F, 0.991977F},
    {0.000000F, 0.268313F, 0.731687F},
    {0.000000F, 0.737267F, 0.262733F},
    {0.000000F, 1.000000F, 0.000000F},
    {0.000000F, 1.000000F, 0.000000F},
    {0.000000F, 1.000000F, 0.000000F},
    {0.143042F, 0.783910F, 0.073048F},
    {0.788740F, 0.210190F, 0.001070F},
    {1.000000F, 0.000000F, 0.000000F},
    {1.000000F, 0.000000F, 0.000000F},
    {1.000000F, 0.000000F, 0.000000F},
    {1.000000F, 0.000000F, 0.000000F},
    {1.000000F, 0.000000F, 0.000000F},
}};

std::array<double, colourWavelengths> colourNanometres() {
    std::array<double, colourWavelengths> nanometres{};
    for (std::size_t k = 0; k < nanometres.size(); ++k)
        nanometres[k] = 400 + 20 * static_cast<double>(k);
    return nanometres;
}

void makeFitForPbrt(RglTables& tables, std::vector<std::string>& alterations) {
    if (!tables.jacobian) {
        tables.ndf = Plane{2, 2, std::vector<float>(4, 4.0F)};
        tables.sigma = Plane{2, 2, std::vector<float>(4, 1.0F)};
        tables.jacobian = true;
    }
    if (tables.channels.kind == Channels::Kind::spectral) return;
    alterations.emplace_back(
        "spectra of 16 wavelengths stand for red, green and blue, which they are under D65");
    Spectra& spectra = tables.spectra;
    std::vector<float> values(spectra.values.size() / 3 * colourWavelengths);
    for (std::size_t i = 0; i < spectra.values.size() / 3; ++i) {
        const float* rgb = &spectra.values[3 * i];
        for (std::size_t k = 0; k < colourWavelengths; ++k)
            values[colourWavelengths * i + k] = colourSpectra[k][0] * rgb[0] +
                                                colourSpectra[k][1] * rgb[1] +
                                                colourSpectra[k][2] * rgb[2];
    }
    spectra.values = std::move(values);
    spectra.channels = colourWavelengths;
    const auto nanometres = colourNanometres();
    tables.channels = Channels::spectral({nanometres.begin(), nanometres.end()});
}

}  // namespace hshfit::brdfs
