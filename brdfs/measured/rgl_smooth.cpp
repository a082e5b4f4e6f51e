// The smooth reading of RGL tables.

#include <brdfs/measured/rgl.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// Whittaker's smoother (1923): the z with the least sum of (z - y)^2 + strength (third
/// differences of z)^2. It halves a wave of `period` nodes.
Eigen::VectorXd whittaker(const Eigen::VectorXd& y, double period) {
    const Eigen::Index count = y.size();
    Eigen::MatrixXd third = Eigen::MatrixXd::Zero(count - 3, count);
    for (Eigen::Index i = 0; i < count - 3; ++i) third.row(i).segment<4>(i) << -1, 3, -3, 1;
    const double strength = std::pow(2 * std::sin(pi / period), -6);
    const Eigen::MatrixXd normal =
        Eigen::MatrixXd::Identity(count, count) + strength * third.transpose() * third;
    return normal.ldlt().solve(y);
}

/// The density of normals without detail finer than `period` nodes along elevation. Logarithms
/// are smoothed, so that it stays positive. Values below a millionth of their row's largest stay,
/// as 0 and its rounding at the horizon, and so do runs of fewer than eight between them.
Plane withoutRipple(const Plane& ndf, double period) {
    Plane smooth = ndf;
    for (std::size_t row = 0; row < ndf.rows; ++row) {
        float* values = smooth.values.data() + row * ndf.columns;
        const float least = 1e-6F * *std::max_element(values, values + ndf.columns);
        std::size_t begin = 0;
        while (begin < ndf.columns) {
            std::size_t end = begin;
            while (end < ndf.columns && values[end] > least) ++end;
            const auto count = static_cast<Eigen::Index>(end - begin);
            if (count >= 8) {
                Eigen::VectorXd logarithms(count);
                for (Eigen::Index i = 0; i < count; ++i)
                    logarithms[i] = std::log(double{values[begin + static_cast<std::size_t>(i)]});
                const Eigen::VectorXd found = whittaker(logarithms, period);
                for (Eigen::Index i = 0; i < count; ++i)
                    values[begin + static_cast<std::size_t>(i)] =
                        static_cast<float>(std::exp(found[i]));
            }
            begin = end + 1;
        }
    }
    return smooth;
}

/// Replaces the density of normals by a smooth one, and the colours of vertices so that f stays
/// at each of them.
void smoothNormals(RglTables& tables) {
    Spectra& spectra = tables.spectra;
    const double period =
        2 * static_cast<double>(tables.ndf.columns - 1) / static_cast<double>(spectra.columns - 1);
    if (!tables.jacobian || period < 2) return;
    const Plane smooth = withoutRipple(tables.ndf, period);
    const std::size_t slices = tables.incident.phi.size() * tables.incident.theta.size();
    float* value = spectra.values.data();
    for (std::size_t slice = 0; slice < slices; ++slice) {
        for (std::size_t row = 0; row < spectra.rows; ++row) {
            for (std::size_t column = 0; column < spectra.columns; ++column) {
                const auto [u, v] = tables.normals->sample(
                    static_cast<double>(column) / static_cast<double>(spectra.columns - 1),
                    static_cast<double>(row) / static_cast<double>(spectra.rows - 1), slice);
                const double is = smooth.at(u, v);
                const double ratio = is > 0 ? tables.ndf.at(u, v) / is : 1;
                for (std::size_t c = 0; c < spectra.channels; ++c, ++value)
                    *value = static_cast<float>(*value * ratio);
            }
        }
    }
    tables.ndf = smooth;
}

/// Averages colours over azimuth where wi is the normal: an isotropic material has no azimuth
/// there, and the columns of the square are elevations of h.
void averageAtNormal(RglTables& tables) {
    if (!tables.isotropic || tables.incident.theta.front() > radians(0.1)) return;
    Spectra& spectra = tables.spectra;
    const std::size_t width = spectra.columns * spectra.channels;
    for (std::size_t p = 0; p < tables.incident.phi.size(); ++p) {
        float* slice =
            spectra.values.data() + p * tables.incident.theta.size() * spectra.rows * width;
        for (std::size_t i = 0; i < width; ++i) {
            // The first and the last row are the same azimuth.
            double sum = (double{slice[i]} + slice[(spectra.rows - 1) * width + i]) / 2;
            for (std::size_t r = 1; r + 1 < spectra.rows; ++r) sum += slice[r * width + i];
            const double mean = sum / static_cast<double>(spectra.rows - 1);
            for (std::size_t r = 0; r < spectra.rows; ++r)
                slice[r * width + i] = static_cast<float>(mean);
        }
    }
}

}  // namespace

void RglTables::smooth() {
    smoothNormals(*this);
    averageAtNormal(*this);
}

}  // namespace hshfit::brdfs
