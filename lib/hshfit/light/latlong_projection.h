#pragma once

#include <hshfit/light/lights.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace hshfit::inline light {

/// Spherical harmonics of a latitude-longitude picture whose radiance is constant within a pixel,
/// exact but for rounding at any order and size: no pixel is a point. Rows come from the top in any
/// number at a time, so that the picture need not be in memory; 48 n^2 bytes and the tables of one
/// row are kept for order n, and 48 n bytes a row where these are at most 512 MB and n is more than
/// 32 and at most half the rows. Runs on all threads; results do not depend on their number.
///
/// A ring is a step in theta and in azimuth. Its azimuth integrals are sums over pixel centres, by
/// a fast Fourier transform, times sin(m d/2) / (m d/2). T_l^m sin(theta) is a trigonometric
/// polynomial of degree l + 1, so that the Fourier coefficients of the steps in theta up to degree
/// n, in closed form, have the same integrals as the steps. The integrals are sums over n + 1
/// equispaced theta.
class LatlongProjection {
public:
    LatlongProjection(int order, std::size_t width, std::size_t height);
    ~LatlongProjection();

    /// The next `count` rows, [row][column][R, G, B].
    void addRows(const float* rows, std::size_t count);

    /// After all rows: [R, G, B][slot], without the Condon-Shortley sign, in the world of
    /// PictureLight, the picture turned by `turn` radians about +z.
    void coefficients(double turn, double* out) const;
    /// Integral of L^2 over the rows so far, by channel.
    const Rgb& energy() const { return energy_; }

private:
    struct Plans;
    void addBlock(const float* rows, std::size_t count, double* spectra);
    void addFourierSums(const double* spectra, std::size_t count);
    void transformRows();
    /// Integral of cos(j x) over a row about x = 0, times the weight of degree j.
    double stepWeight(std::size_t j) const;

    int order_;
    std::size_t width_, height_;
    std::size_t rows_ = 0;  ///< so far
    bool whole_;            ///< the spectra of all rows are kept
    std::unique_ptr<const Plans> plans_;
    std::vector<double> waves_;    ///< cos(k pi / (2 height)), a whole period
    std::vector<double> spectra_;  ///< [row, of the picture or of the block][channel][column]
    std::vector<double> fourier_;  ///< [degree][channel][column]
    Rgb energy_{};
};

}  // namespace hshfit::inline light
