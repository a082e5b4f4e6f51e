#include "rotate.h"

#include <jobs/common/nine_numbers.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/error.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/rotation/band_matrix.h>
#include <hshfit/rotation/basis_change.h>
#include <hshfit/rotation/sh_rotation.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::jobs {
namespace {

constexpr std::size_t largestMatrix = std::size_t{1} << 22;

/// Whether the plane y = 0 is mapped to itself, sides included.
bool keepsMirrorPlane(const Rotation& rotation) {
    const auto& r = rotation.matrix();
    return std::abs(r[1]) + std::abs(r[3]) + std::abs(r[5]) + std::abs(r[7]) < 1e-12 && r[4] > 0;
}

/// The energy that stays; the part that the coefficients do not hold may have gone or stayed.
Energy leftOf(Energy energy, double captured, double lost) {
    if (!energy.finite) return energy;
    energy.error += std::max(0.0, energy.value - captured);
    energy.value *= 1 - lost;
    return energy;
}

using Rows = std::vector<std::vector<double>>;

Rows rowsOf(const std::vector<double>& values, std::size_t columns) {
    Rows rows;
    for (auto at = values.begin(); at != values.end(); at += static_cast<std::ptrdiff_t>(columns))
        rows.emplace_back(at, at + static_cast<std::ptrdiff_t>(columns));
    return rows;
}

Rows shRotation(int toOrder, int fromOrder, const Rotation& rotation) {
    Rows rows(static_cast<std::size_t>(toOrder * toOrder),
              std::vector<double>(static_cast<std::size_t>(fromOrder * fromOrder), 0.0));
    for (int l = 0; l < std::min(toOrder, fromOrder); ++l) {
        const std::vector<double> band = bandMatrix(l, rotation);
        const auto width = static_cast<std::size_t>(2 * l + 1),
                   first = static_cast<std::size_t>(l * l);
        for (std::size_t i = 0; i < width; ++i)
            std::copy_n(band.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                        rows[first + i].begin() + static_cast<std::ptrdiff_t>(first));
    }
    return rows;
}

Rows product(const Rows& a, const Rows& b) {
    Rows rows(a.size(), std::vector<double>(b[0].size(), 0.0));
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t k = 0; k < b.size(); ++k)
            for (std::size_t j = 0; a[i][k] != 0 && j < b[0].size(); ++j)
                rows[i][j] += a[i][k] * b[k][j];
    return rows;
}

Rows changeOf(const MatrixOptions& options) {
    const auto from = bases::make(options.from, options.orderOfFrom());
    const auto to = bases::make(options.to, options.order);
    return rowsOf(BasisChange(*from, *to, options.weight).dense(),
                  static_cast<std::size_t>(from->slots()));
}

Rows unsignedMatrix(const MatrixOptions& options) {
    const auto from = bases::make(options.from, options.orderOfFrom());
    const auto to = bases::make(options.to, options.order);
    const std::size_t entries =
        static_cast<std::size_t>(from->slots()) * static_cast<std::size_t>(to->slots());
    if (entries > largestMatrix)
        throw UsageError(fmt::format("a matrix of {} x {} entries; at most {} in all", to->slots(),
                                     from->slots(), largestMatrix));
    if (!options.rotation && !options.euler) return changeOf(options);
    if (options.weight)
        throw UsageError(fmt::format("a rotation has no weight: leave out {}",
                                     Setting{"MatrixOptions::weight"}));
    const Rotation rotation = options.rotation ? *options.rotation : options.euler->rotation();
    if (options.from == "sh") {
        const Rows turned = shRotation(options.orderOfFrom(), options.orderOfFrom(), rotation);
        if (options.to == "sh") return shRotation(options.order, options.orderOfFrom(), rotation);
        return product(changeOf(options), turned);
    }
    if (options.to == "sh")
        return product(shRotation(options.order, options.order, rotation), changeOf(options));
    if (options.from != options.to || options.orderOfFrom() != options.order)
        throw UsageError(fmt::format(
            "a rotation from {} of order {} to {} of order {}: give one basis and order, or sh as "
            "one of the bases",
            options.from, options.orderOfFrom(), options.to, options.order));
    return rowsOf(HemisphereRotation(*from).matrix(rotation),
                  static_cast<std::size_t>(from->slots()));
}

const Rotation& rotationOf(const RotateOptions& options) {
    if (!options.rotation)
        throw UsageError(fmt::format("no rotation; give one of {}, {} and {}",
                                     Setting{"RotateOptions::euler", "A,B,C"},
                                     Setting{"RotateOptions::axis", "X,Y,Z,ANGLE"},
                                     Setting{"RotateOptions::up", "THETA,PHI"}));
    return *options.rotation;
}

}  // namespace

Rotated rotate(Coefficients& c, const RotateOptions& options) {
    const auto basis = bases::make(c.basis, c.order, {.condonShortley = c.condonShortley});
    const HemisphereRotation rotation(*basis, options.way);
    // Loss and error weigh outgoing directions by their solid angles.
    const double largest =
        *std::max_element(c.outgoing.solidAngles.begin(), c.outgoing.solidAngles.end());
    const std::size_t perDirection = c.channels.count() * c.slots();
    const auto scaleOf = [&](std::size_t i) {
        return std::sqrt(std::max(c.outgoing.solidAngles[i / perDirection], 1e-12 * largest));
    };
    double captured = 0;
    for (std::size_t i = 0; i < c.values.size(); ++i) {
        c.values[i] *= scaleOf(i);
        captured += c.values[i] * c.values[i];
    }
    const HemisphereRotated rotated = rotation.rotate(rotationOf(options), c.values);
    for (std::size_t i = 0; i < c.values.size(); ++i) c.values[i] = rotated.values[i] / scaleOf(i);
    c.energy = leftOf(c.energy, captured, rotated.lostEnergy);
    if (options.way.method != HemisphereMethod::exact) c.error += rotated.error;
    c.isotropic = c.isotropic && c.outgoing.map == OutgoingSet::Map::elevations;
    c.bilateral = c.bilateral && keepsMirrorPlane(*options.rotation);
    c.reciprocal = false;
    c.leastSquares.reset();
    c.source += " (rotated)";
    return {
        "brdf",        c.basis,      "hemisphere", c.order, options.way.method, rotated.lostEnergy,
        rotated.error, rotated.bands};
}

Rotated rotate(LightCoefficients& light, const RotateOptions& options, const std::string& name) {
    Rotated result{"light", light.basis, "sphere", light.order, options.way.method, 0, 0, 0};
    if (light.domain == LightCoefficients::Domain::sphere) {
        if (options.way.method != HemisphereMethod::exact)
            throw UsageError(
                fmt::format("'{}' is light on the whole sphere, which only the method "
                            "exact rotates",
                            name));
        const ShRotation turn(light.order, {.condonShortley = light.condonShortley});
        light.values = turn.rotate(rotationOf(options), light.values);
    } else {
        const auto basis =
            bases::make(light.basis, light.order, {.condonShortley = light.condonShortley});
        const HemisphereRotated rotated =
            HemisphereRotation(*basis, options.way).rotate(rotationOf(options), light.values);
        double captured = 0;
        for (const double value : light.values) captured += value * value;
        light.values = rotated.values;
        light.energy = leftOf(light.energy, captured, rotated.lostEnergy);
        if (options.way.method != HemisphereMethod::exact) light.error += rotated.error;
        light.curves.clear();
        result.domain = "hemisphere";
        result.lostEnergy = rotated.lostEnergy;
        result.error = rotated.error;
        result.bands = rotated.bands;
    }
    light.source += " (rotated)";
    return result;
}

Rotated rotate(const std::string& input, const std::string& output, const RotateOptions& options) {
    rotationOf(options);
    if (auto nine = nineNumbers(input)) {
        const Rotated result = rotate(*nine, options, input);
        writeLight(*nine, output);
        return result;
    }
    if (isLightFile(input)) {
        LightCoefficients light = readLight(input);
        const Rotated result = rotate(light, options, input);
        writeLight(light, output);
        return result;
    }
    Coefficients coefficients = readCoefficients(input);
    const Rotated result = rotate(coefficients, options);
    writeCoefficients(coefficients, output);
    return result;
}

std::vector<std::vector<double>> matrix(const MatrixOptions& options) {
    Rows rows = unsignedMatrix(options);
    if (!options.condonShortley) return rows;
    const auto sign = [](std::size_t slot) {
        return azimuthSign(gpu::bandOf(static_cast<int>(slot)).m, true);
    };
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t j = 0; j < rows[i].size(); ++j)
            if (sign(i) != sign(j) && rows[i][j] != 0) rows[i][j] = -rows[i][j];
    return rows;
}

}  // namespace hshfit::jobs
