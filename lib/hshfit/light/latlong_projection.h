#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/quadrature/azimuth_tables.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline light {

/// Spherical harmonics of a latitude-longitude picture whose radiance is constant within a pixel,
/// exact but for rounding at any order and size: no pixel is a point. Rows come from the top in any
/// number at a time, so that the picture need not be in memory; 48 n^2 bytes and the tables of one
/// row are kept for order n. Runs on all threads; results do not depend on their number.
///
/// A ring is a step in theta and in azimuth. Its azimuth integrals are those at pixel centres times
/// sin(m d/2) / (m d/2). T_l^m sin(theta) is a trigonometric polynomial of degree l + 1, so that
/// the Fourier coefficients of the steps in theta up to degree n, in closed form, have the same
/// integrals as the steps; those are sums over n + 1 equispaced theta.
class LatlongProjection {
public:
    LatlongProjection(int order, std::size_t width, std::size_t height);

    /// The next `count` rows, [row][column][R, G, B].
    void addRows(const float* rows, std::size_t count);

    /// After all rows: [R, G, B][slot], without the Condon-Shortley sign, in the world of
    /// PictureLight, the picture turned by `turn` radians about +z.
    void coefficients(double turn, double* out) const;
    /// Integral of L^2 over the rows so far, by channel.
    const Rgb& energy() const { return energy_; }

private:
    void addBlock(const float* rows, std::size_t count);
    void addFourierSums(std::size_t count);
    /// Cosine (odd m) or sine (even m) of k pi / (2 height).
    double wave(std::size_t k, bool sine) const;

    int order_;
    std::size_t width_, height_, repeats_;  ///< times that a column counts, so that 4 divides all
    std::size_t rows_ = 0;                  ///< so far
    AzimuthColumns columns_;
    AzimuthTable table_;
    std::vector<double> waves_;     ///< cos(k pi / (2 height)), a whole period
    std::vector<double> spectrum_;  ///< [row of the block][channel][column]
    std::vector<double> fourier_;   ///< [degree][channel][column]
    Rgb energy_{};
};

}  // namespace hshfit::inline light
