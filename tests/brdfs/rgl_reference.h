#pragma once

// An independent reader of tensor files and evaluation of the RGL layout, from the description
// of the format and the formulas of Dupuy & Jakob 2018, without tables of integrals.

#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace hshfit::test {

class RglReference {
public:
    explicit RglReference(const std::string& bytes) {
        std::size_t at = 14;
        const auto take = [&](auto value) {
            std::memcpy(&value, bytes.data() + at, sizeof value);
            at += sizeof value;
            return value;
        };
        const auto fields = take(std::uint32_t{});
        for (std::uint32_t i = 0; i < fields; ++i) {
            const auto length = take(std::uint16_t{});
            const std::string name = bytes.substr(at, length);
            at += length;
            const auto dimensions = take(std::uint16_t{});
            const auto type = take(std::uint8_t{});
            const auto offset = take(std::uint64_t{});
            Table table;
            std::uint64_t count = 1;
            for (int d = 0; d < dimensions; ++d) {
                table.shape.push_back(take(std::uint64_t{}));
                count *= table.shape.back();
            }
            if (type == 10) {
                table.values.resize(count);
                std::memcpy(table.values.data(), bytes.data() + offset, 4 * count);
            }
            if (name == "jacobian") jacobian = bytes.at(offset) == 1;
            tables[name] = table;
        }
    }

    struct Table {
        std::vector<std::uint64_t> shape;
        std::vector<float> values;
    };
    std::map<std::string, Table> tables;
    bool jacobian = false;

    /// f cos(theta_o) per channel. Quarter circles: wi is mirrored into [-pi, -pi/2] first.
    std::vector<double> value(Direction wi, Direction wo) const {
        const auto& phis = tables.at("phi_i").values;
        const bool isotropic = phis.size() <= 2;
        if (!isotropic && phis.back() - phis.front() < 2) {
            if (wi.x > 0) wi.x = -wi.x, wo.x = -wo.x;
            if (wi.y > 0) wi.y = -wi.y, wo.y = -wo.y;
        }
        const double theta = polarAngle(wi), phi = azimuth(wi);
        const Direction sum{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
        const double u = std::sqrt(2 * polarAngle(sum) / pi);
        const double v = wrapped((azimuth(sum) - (isotropic ? phi : 0)) / (2 * pi) + 0.5);
        const Table& vndf = tables.at("vndf");
        const std::vector<double> p = mixed(vndf, isotropic ? 0 : phi, theta, 0, 1, true);
        const std::size_t rows = vndf.shape[2], columns = vndf.shape[3];
        const double row = rowIntegral(p, rows, columns, u, v);
        const double whole = rowIntegral(p, rows, columns, 1, v);
        double y = 0, all = 0;
        const std::size_t cells = rows - 1;
        for (std::size_t i = 0; i < cells; ++i) {
            const double from = double(i) / double(cells), to = double(i + 1) / double(cells);
            const double end = std::clamp(v, from, to);
            y += (end - from) * rowIntegral(p, rows, columns, 1, (from + end) / 2);
            all += (to - from) * rowIntegral(p, rows, columns, 1, (from + to) / 2);
        }
        const bool rgb = tables.contains("rgb");
        const Table& colours = tables.at(rgb ? "rgb" : "spectra");
        double factor = 1;
        if (jacobian) {
            factor = plane("ndf", u, v) /
                     (4 * plane("sigma", std::sqrt(2 * theta / pi), wrapped(phi / (2 * pi) + 0.5)));
        }
        std::vector<double> result;
        for (std::size_t c = 0; c < colours.shape[2]; ++c) {
            const auto slice =
                mixed(colours, isotropic ? 0 : phi, theta, c, colours.shape[2], false);
            const double f =
                bilinear(slice, colours.shape[3], colours.shape[4], row / whole, y / all);
            result.push_back(std::max(0.0, f * factor));
        }
        return result;
    }

private:
    static double wrapped(double v) { return v - std::floor(v); }

    static double bilinear(const std::vector<double>& table, std::size_t rows, std::size_t columns,
                           double x, double y) {
        const double a = std::clamp(x, 0.0, 1.0) * double(columns - 1);
        const double b = std::clamp(y, 0.0, 1.0) * double(rows - 1);
        const auto i = std::min(std::size_t(a), columns - 2),
                   j = std::min(std::size_t(b), rows - 2);
        const double s = a - double(i), t = b - double(j);
        const double* p = table.data() + j * columns + i;
        return (1 - t) * ((1 - s) * p[0] + s * p[1]) +
               t * ((1 - s) * p[columns] + s * p[columns + 1]);
    }

    /// The integral of a row at height v from 0 to u: cells are linear, the midpoint is exact.
    static double rowIntegral(const std::vector<double>& p, std::size_t rows, std::size_t columns,
                              double u, double v) {
        double sum = 0;
        for (std::size_t i = 0; i + 1 < columns; ++i) {
            const double from = double(i) / double(columns - 1);
            const double to = std::min(u, double(i + 1) / double(columns - 1));
            if (to > from) sum += (to - from) * bilinear(p, rows, columns, (from + to) / 2, v);
        }
        return sum;
    }

    double plane(const std::string& name, double u, double v) const {
        const Table& table = tables.at(name);
        return bilinear({table.values.begin(), table.values.end()}, table.shape[0], table.shape[1],
                        u, v);
    }

    static double hat(const std::vector<float>& nodes, std::size_t i, double at) {
        at = std::clamp<double>(at, nodes.front(), nodes.back());
        if (i > 0 && at < nodes[i]) {
            return std::max(0.0, (at - nodes[i - 1]) / (nodes[i] - nodes[i - 1]));
        }
        if (i + 1 < nodes.size() && at > nodes[i]) {
            return std::max(0.0, (nodes[i + 1] - at) / (nodes[i + 1] - nodes[i]));
        }
        return at == nodes[i] ? 1 : 0;
    }

    /// Slices of one channel, weighted for the incident direction; densities normalised first.
    std::vector<double> mixed(const Table& table, double phi, double theta, std::size_t channel,
                              std::size_t channels, bool normalise) const {
        const auto& phis = tables.at("phi_i").values;
        const auto& thetas = tables.at("theta_i").values;
        const std::size_t rows = table.shape[table.shape.size() - 2], columns = table.shape.back();
        std::vector<double> result(rows * columns);
        for (std::size_t p = 0; p < phis.size(); ++p) {
            for (std::size_t t = 0; t < thetas.size(); ++t) {
                double weight = hat(phis, p, phi) * hat(thetas, t, theta);
                if (weight == 0) continue;
                const float* from = table.values.data() +
                                    ((p * thetas.size() + t) * channels + channel) * rows * columns;
                if (normalise) {
                    double sum = 0;
                    for (std::size_t r = 0; r < rows; ++r)
                        for (std::size_t c = 0; c < columns; ++c) {
                            const bool edgeRow = r == 0 || r + 1 == rows;
                            const bool edgeColumn = c == 0 || c + 1 == columns;
                            sum += from[r * columns + c] * (edgeRow ? 0.5 : 1) *
                                   (edgeColumn ? 0.5 : 1);
                        }
                    weight /= sum;
                }
                for (std::size_t i = 0; i < result.size(); ++i) result[i] += weight * from[i];
            }
        }
        return result;
    }
};

}  // namespace hshfit::test
