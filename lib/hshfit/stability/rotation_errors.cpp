#include <hshfit/stability/internal/rotation_errors.h>

#include <hshfit/rotation/band_matrix.h>
#include <hshfit/rotation/hemisphere_rotation.h>
#include <hshfit/rotation/sh_rotation.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace hshfit::stability {
namespace {

std::array<Rotation, 3> someRotations() {
    return {Rotation::euler(0.3, 1e-4, 1.2), Rotation::euler(0, pi / 2, 0),
            Rotation::euler(-1.7, 2.4, 0.8)};
}

std::vector<double> someValues(std::size_t count) {
    std::mt19937_64 random(1);
    std::vector<double> values(count);
    for (double& value : values) value = static_cast<double>(random() >> 11) * 0x1p-52 - 1;
    return values;
}

/// |M c in float - M c| / |c| for a matrix of `rows` rows.
double floatError(const std::vector<double>& matrix, std::size_t rows, const double* c) {
    const std::size_t columns = matrix.size() / rows;
    double difference = 0, norm = 0;
    for (std::size_t i = 0; i < rows; ++i) {
        float single = 0;
        double exact = 0;
        for (std::size_t j = 0; j < columns; ++j) {
            single += static_cast<float>(matrix[i * columns + j]) * static_cast<float>(c[j]);
            exact += matrix[i * columns + j] * c[j];
        }
        difference += (single - exact) * (single - exact);
    }
    for (std::size_t j = 0; j < columns; ++j) norm += c[j] * c[j];
    return std::sqrt(difference / norm);
}

/// All degrees to 20, the degrees of the tables, and some between.
std::vector<int> sampledDegrees(int order) {
    std::vector<int> degrees;
    for (int l = 0; l < std::min(order, 21); ++l) degrees.push_back(l);
    for (const int l : {32, 48, 64, 100, 150, 200, 300, 450, 600, 800})
        if (l < order) degrees.push_back(l);
    if (degrees.back() != order - 1) degrees.push_back(order - 1);
    return degrees;
}

DegreeErrors inFloat(int order) {
    DegreeErrors result{"sh", Precision::single,
                        std::vector<double>(static_cast<std::size_t>(order), unmeasured)};
    const std::vector<double> c = someValues(2 * static_cast<std::size_t>(order) + 1);
    const std::vector<int> degrees = sampledDegrees(order);
    tbb::parallel_for(std::size_t{0}, degrees.size(), [&](std::size_t k) {
        const int l = degrees[degrees.size() - 1 - k];
        double largest = 0;
        for (const Rotation& rotation : someRotations())
            largest = std::max(largest, floatError(bandMatrix(l, rotation),
                                                   2 * static_cast<std::size_t>(l) + 1, c.data()));
        result.error[static_cast<std::size_t>(l)] = largest;
    });
    return result;
}

}  // namespace

DegreeErrors rotationErrors(int order, Precision precision) {
    if (precision == Precision::single) return inFloat(order);
    const ShRotation rotate(order);
    const std::vector<double> c =
        someValues(static_cast<std::size_t>(order) * static_cast<std::size_t>(order));
    DegreeErrors result{"sh", Precision::twice,
                        std::vector<double>(static_cast<std::size_t>(order), 0.0)};
    const Rotation second = Rotation::euler(2.1, 0.9, -0.4);
    for (const Rotation& first : someRotations()) {
        const std::vector<double> twice = rotate.rotate(second, rotate.rotate(first, c));
        const std::vector<double> once = rotate.rotate(second * first, c);
        for (std::size_t l = 0; l < result.error.size(); ++l) {
            double difference = 0, norm = 0;
            for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i) {
                difference += (twice[i] - once[i]) * (twice[i] - once[i]);
                norm += c[i] * c[i];
            }
            result.error[l] = std::max(result.error[l], std::sqrt(difference / norm));
        }
    }
    return result;
}

DegreeErrors hemisphereRotationErrors(const Basis& basis, Precision precision) {
    const auto order = static_cast<std::size_t>(basis.order()), slots = order * order;
    DegreeErrors result{basis.name(), precision, std::vector<double>(order, 0.0)};
    const HemisphereRotation rotate(basis);
    const std::vector<double> c = someValues(slots);
    for (const Rotation& rotation : someRotations()) {
        const std::vector<double> matrix = rotate.matrix(rotation);
        const std::vector<double> back = precision == Precision::twice
                                             ? rotate.matrix(rotation.inverse())
                                             : std::vector<double>();
        for (std::size_t l = 0; l < order; ++l) {
            double error = 0;
            if (precision == Precision::single) {
                std::vector<double> band(slots, 0.0);
                for (std::size_t j = l * l; j < (l + 1) * (l + 1); ++j)
                    if (basis.has(static_cast<int>(l), static_cast<int>(j - l * l - l)))
                        band[j] = c[j];
                error = floatError(matrix, slots, band.data());
            }
            for (std::size_t j = l * l; j < (l + 1) * (l + 1) && !back.empty(); ++j) {
                double squared = 0;
                for (std::size_t i = 0; i < slots; ++i) {
                    const double off = matrix[i * slots + j] - back[j * slots + i];
                    squared += off * off;
                }
                error = std::max(error, std::sqrt(squared));
            }
            result.error[l] = std::max(result.error[l], error);
        }
    }
    return result;
}

}  // namespace hshfit::stability
