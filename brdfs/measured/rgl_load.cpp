// Checked RGL tables from the fields of a tensor file.

#include <brdfs/measured/rgl.h>
#include <hshfit/error.h>
#include <hshfit/files/tensor_file.h>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

using Field = TensorFile::Field;

/// Ascending values in [least, most] of a field with one dimension.
std::vector<double> loadNodes(const TensorFile& file, const Field& field, double least,
                              double most) {
    const std::vector<float> values = file.floats(field, 1);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i] < least || values[i] > most) {
            file.fail(field, fmt::format("value {} is {}, expected {:.6g} to {:.6g}", i, values[i],
                                         least, most));
        }
        if (i > 0 && !(values[i] > values[i - 1])) {
            file.fail(field, fmt::format("value {} ({}) is not above value {} ({})", i, values[i],
                                         i - 1, values[i - 1]));
        }
    }
    return {values.begin(), values.end()};
}

/// Throws unless the field has the sizes `expected`; 0 there stands for any size from 2.
void checkShape(const TensorFile& file, const Field& field,
                std::initializer_list<std::uint64_t> expected) {
    bool same = field.shape.size() == expected.size();
    std::string text;
    std::size_t i = 0;
    for (const std::uint64_t size : expected) {
        same = same && (size == 0 ? field.shape[i] >= 2 : field.shape[i] == size);
        text += fmt::format("{}{}", i++ == 0 ? "" : " x ", size == 0 ? "n" : std::to_string(size));
    }
    if (same) return;
    file.fail(field, fmt::format("has the shape {}, expected {} (n: 2 or more)",
                                 shapeText(field.shape), text));
}

void checkLeast(const TensorFile& file, const Field& field, const std::vector<float>& values,
                float least) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!(values[i] >= least)) {
            file.fail(field, fmt::format("value {} (offset {}) is {}, expected at least {:.3g}", i,
                                         field.offset + i * sizeof(float), values[i], least));
        }
    }
}

Plane loadPlane(const TensorFile& file, std::string_view name, float least) {
    const Field& field = file.field(name);
    checkShape(file, field, {0, 0});
    Plane plane{field.shape[0], field.shape[1], file.floats(field, 2)};
    checkLeast(file, field, plane.values, least);
    return plane;
}

/// The number of times that the azimuths cover the circle; see RglTables.
int reductionOf(const TensorFile& file, const Field& field, const std::vector<double>& phi) {
    if (phi.size() <= 2) return 0;
    const double span = phi.back() - phi.front();
    for (const int reduction : {1, 2, 4}) {
        if (std::fabs(span * reduction / (2 * pi) - 1) > 0.05) continue;
        // A quarter is mirrored at the axes and therefore has to lie between two of them.
        const double quarters = phi.front() / (pi / 2);
        if (reduction == 4 && std::fabs(quarters - std::round(quarters)) > 0.05) {
            file.fail(field, fmt::format("starts at {:.4g} degrees, expected a multiple of 90 for "
                                         "a quarter of the circle",
                                         degrees(phi.front())));
        }
        return reduction;
    }
    file.fail(field, fmt::format("spans {:.4g} degrees, expected 360, 180 or 90 (or at most two "
                                 "azimuths, if isotropic)",
                                 degrees(span)));
}

std::vector<float> loadDensities(const TensorFile& file, const Field& field) {
    std::vector<float> values = file.floats(field, 4);
    checkLeast(file, field, values, 0);
    const std::size_t square = field.shape[2] * field.shape[3];
    for (std::size_t slice = 0; slice < values.size() / square; ++slice) {
        double sum = 0;
        for (std::size_t i = 0; i < square; ++i) sum += values[slice * square + i];
        if (sum > 0 && sum <= std::numeric_limits<float>::max()) continue;
        file.fail(field, fmt::format("slice {} (offset {}) sums to {}, cannot be normalised", slice,
                                     field.offset + slice * square * sizeof(float), sum));
    }
    return values;
}

const Field& spectraField(const TensorFile& file) {
    if (const Field* rgb = file.find("rgb")) return *rgb;
    if (const Field* spectra = file.find("spectra")) return *spectra;
    return file.field("rgb");  // throws, with the fields that exist
}

/// Transposes [slice][channel][row][column] to [slice][row][column][channel].
Spectra loadSpectra(const TensorFile& file, const Field& field) {
    const std::vector<float> values = file.floats(field, 5);
    Spectra spectra{field.shape[2], field.shape[3], field.shape[4],
                    std::vector<float>(values.size())};
    const std::size_t square = spectra.rows * spectra.columns;
    const std::size_t slices = field.shape[0] * field.shape[1];
    for (std::size_t s = 0; s < slices; ++s) {
        for (std::size_t c = 0; c < spectra.channels; ++c) {
            const float* from = values.data() + (s * spectra.channels + c) * square;
            float* to = spectra.values.data() + s * spectra.channels * square + c;
            for (std::size_t i = 0; i < square; ++i) to[i * spectra.channels] = from[i];
        }
    }
    return spectra;
}

/// Whether the two halves of a table with one half per azimuth are the same.
bool sameHalves(const std::vector<float>& values) {
    return std::equal(values.begin(), values.begin() + values.size() / 2,
                      values.begin() + values.size() / 2);
}

void refusePolarimetric(const TensorFile& file) {
    const Field* mueller = file.find("M");
    if (mueller == nullptr || file.find("vndf") != nullptr) return;
    file.fail(*mueller,
              fmt::format("holds polarimetric Mueller matrices ({}); read are RGL files with ndf, "
                          "sigma, vndf and rgb or spectra",
                          shapeText(mueller->shape)));
}

bool loadJacobian(const TensorFile& file) {
    const Field& field = file.field("jacobian");
    const auto octets = file.octets(field);
    if (octets.size() != 1 || octets[0] > 1) {
        file.fail(field, "is not one octet of value 0 or 1");
    }
    return octets[0] == 1;
}

std::string loadDescription(const TensorFile& file) {
    const Field* field = file.find("description");
    if (field == nullptr || field->type != TensorFile::Type::u8) return {};
    std::string text;
    for (const unsigned char c : file.octets(*field)) {
        if (text.size() < 400) text += c < ' ' || c == 127 ? ' ' : static_cast<char>(c);
    }
    return text;
}

}  // namespace

RglTables RglTables::load(const TensorFile& file) {
    refusePolarimetric(file);
    RglTables tables;
    tables.description = loadDescription(file);
    tables.jacobian = loadJacobian(file);

    const Field& phi = file.field("phi_i");
    tables.incident.phi = loadNodes(file, phi, -4 * pi, 4 * pi);
    // pi/2 rounded to float may be above pi/2.
    tables.incident.theta = loadNodes(file, file.field("theta_i"), 0, pi / 2 + 1e-6);
    tables.reduction = reductionOf(file, phi, tables.incident.phi);
    const std::uint64_t azimuths = tables.incident.phi.size();
    const std::uint64_t elevations = tables.incident.theta.size();

    tables.ndf = loadPlane(file, "ndf", 0);
    tables.sigma = loadPlane(file, "sigma", std::numeric_limits<float>::min());

    const Field& normals = file.field("vndf");
    checkShape(file, normals, {azimuths, elevations, 0, 0});
    const std::vector<float> densities = loadDensities(file, normals);

    const Field& colours = spectraField(file);
    if (colours.name == "rgb") {
        tables.channels = Channels::rgb();
    } else {
        tables.channels = Channels::spectral(loadNodes(file, file.field("wavelengths"), 1, 1e6));
    }
    checkShape(file, colours, {azimuths, elevations, tables.channels.count(), 0, 0});
    tables.spectra = loadSpectra(file, colours);

    const bool sameAzimuths =
        azimuths == 1 || (sameHalves(densities) && sameHalves(tables.spectra.values));
    bool sigmaConstant = true;
    for (std::size_t i = tables.sigma.columns; i < tables.sigma.values.size(); ++i) {
        sigmaConstant = sigmaConstant &&
                        tables.sigma.values[i] == tables.sigma.values[i - tables.sigma.columns];
    }
    tables.isotropic = tables.reduction == 0 && sameAzimuths && sigmaConstant;
    tables.normals =
        std::make_unique<VisibleNormals>(densities, normals.shape[2], normals.shape[3]);
    return tables;
}

}  // namespace hshfit::brdfs
