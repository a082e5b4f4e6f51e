#pragma once

// Writes small tensor files for tests, valid or with any field wrong. Independent of the reader.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace hshfit::test {

struct TensorField {
    std::string name;
    std::uint8_t type = 10;  // f32
    std::vector<std::uint64_t> shape;
    std::string data;
};

template <class Value>
std::string octetsOf(const std::vector<Value>& values) {
    std::string octets(values.size() * sizeof(Value), '\0');
    if (!values.empty()) std::memcpy(octets.data(), values.data(), octets.size());
    return octets;
}

inline TensorField floatField(std::string name, std::vector<std::uint64_t> shape,
                              const std::vector<float>& values) {
    return {std::move(name), 10, std::move(shape), octetsOf(values)};
}

/// Appends a value as it lies in memory (tests run on little-endian machines).
template <class Value>
void put(std::string& out, Value value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline std::string tensorFile(const std::vector<TensorField>& fields) {
    std::size_t offset = 18;
    for (const TensorField& field : fields) {
        offset += 13 + field.name.size() + 8 * field.shape.size();
    }
    std::string out("tensor_file\0\1\0", 14);
    put(out, static_cast<std::uint32_t>(fields.size()));
    for (const TensorField& field : fields) {
        put(out, static_cast<std::uint16_t>(field.name.size()));
        out += field.name;
        put(out, static_cast<std::uint16_t>(field.shape.size()));
        put(out, field.type);
        put(out, static_cast<std::uint64_t>(offset));
        for (const std::uint64_t size : field.shape) put(out, size);
        offset += field.data.size();
    }
    for (const TensorField& field : fields) out += field.data;
    return out;
}

/// A smooth synthetic material. All sizes differ, so that an exchange of axes fails a test.
struct RglShape {
    std::vector<float> phi = {0};
    std::vector<float> theta = {0.0F, 0.5F, 1.0F, 1.5707964F};
    std::uint64_t normalRows = 7, normalColumns = 6, colourRows = 4, colourColumns = 5;
    std::uint64_t channels = 3;  ///< other than 3: spectra with wavelengths
    bool jacobian = true;
};

inline std::vector<TensorField> rglFields(const RglShape& shape) {
    const auto fill = [](const std::vector<std::uint64_t>& sizes, float seed) {
        std::uint64_t count = 1;
        for (const auto size : sizes) count *= size;
        std::vector<float> values(count);
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = 0.2F + std::abs(std::sin(seed + 0.7F * static_cast<float>(i)));
        }
        return floatField({}, sizes, values);
    };
    const std::uint64_t azimuths = shape.phi.size(), elevations = shape.theta.size();
    const auto named = [](TensorField field, std::string name) {
        field.name = std::move(name);
        return field;
    };
    std::vector<TensorField> fields = {
        {"description", 1, {5}, "smoke"},
        floatField("phi_i", {azimuths}, shape.phi),
        floatField("theta_i", {elevations}, shape.theta),
        floatField("sigma", {2, 5}, {1, .9F, .8F, .7F, .6F, 1, .9F, .8F, .7F, .6F}),
        floatField("ndf", {2, 4}, {9, 4, 1, .1F, 9, 4, 1, .1F}),
        named(fill({azimuths, elevations, shape.normalRows, shape.normalColumns}, 1), "vndf"),
        named(
            fill({azimuths, elevations, shape.channels, shape.colourRows, shape.colourColumns}, 2),
            shape.channels == 3 ? "rgb" : "spectra"),
        {"jacobian", 1, {1}, std::string(1, shape.jacobian ? '\1' : '\0')},
    };
    if (shape.channels != 3) {
        std::vector<float> wavelengths(shape.channels);
        for (std::size_t i = 0; i < wavelengths.size(); ++i) {
            wavelengths[i] = 400.0F + 50.0F * static_cast<float>(i);
        }
        fields.push_back(floatField("wavelengths", {shape.channels}, wavelengths));
    }
    return fields;
}

/// Mueller matrices over difference and half angles; every element but M00 is 777. Without
/// `withAngles` their fields are empty, as in published files.
struct PbsdfShape {
    std::uint64_t azimuths = 7, differences = 5, halves = 4;
    std::vector<std::uint16_t> wavelengths = {450, 650};
    bool withAngles = true;

    /// Node i of `count` from `from` to `to`.
    static double node(std::uint64_t i, std::uint64_t count, double from, double to) {
        return from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1);
    }
};

/// m00(phi_d, theta_d, theta_h, index of the wavelength).
template <class Reflectance>
std::vector<TensorField> pbsdfFields(const PbsdfShape& shape, const Reflectance& m00) {
    const double pi = std::acos(-1.0);
    const auto angles = [&](const std::string& name, std::uint64_t count, double from, double to) {
        if (!shape.withAngles) return TensorField{name, 10, {0, count}, ""};
        std::vector<float> values;
        for (std::uint64_t i = 0; i < count; ++i) {
            values.push_back(static_cast<float>(PbsdfShape::node(i, count, from, to)));
        }
        return floatField(name, {1, count}, values);
    };
    std::vector<float> m;
    for (std::uint64_t p = 0; p < shape.azimuths; ++p)
        for (std::uint64_t d = 0; d < shape.differences; ++d)
            for (std::uint64_t h = 0; h < shape.halves; ++h)
                for (std::size_t w = 0; w < shape.wavelengths.size(); ++w) {
                    m.push_back(
                        static_cast<float>(m00(PbsdfShape::node(p, shape.azimuths, -pi, pi),
                                               PbsdfShape::node(d, shape.differences, 0, pi / 2),
                                               PbsdfShape::node(h, shape.halves, 0, pi / 2), w)));
                    m.insert(m.end(), 15, 777.0F);
                }
    return {
        angles("phi_d", shape.azimuths, -pi, pi),
        angles("theta_d", shape.differences, 0, pi / 2),
        angles("theta_h", shape.halves, 0, pi / 2),
        {"wvls", 3, {shape.wavelengths.size()}, octetsOf(shape.wavelengths)},
        floatField(
            "M", {shape.azimuths, shape.differences, shape.halves, shape.wavelengths.size(), 4, 4},
            m)};
}

}  // namespace hshfit::test
