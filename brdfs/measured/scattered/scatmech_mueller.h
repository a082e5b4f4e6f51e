#pragma once

#include <brdfs/measured/mueller.h>
#include <brdfs/measured/scattered/scatmech.h>

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::brdfs {

/// Other elements of the Mueller matrices of a SCATMECH table than f11 (Germer 2017,
/// 10.1364/AO.56.009333; the page ZernikeExpansion_BRDF_Model of SCATMECH), from its rows i <= j:
///     f_ij = f_11 sum a lambda^p K_n^k(i) K_m^l(r),   i < j
///     f_ii = f_11 sum a lambda^p (K_n^k(i) K_m^l(r) + K_n^k(r) K_m^l(i)) / sqrt(2 + 2 [nk = ml])
///     K_n^k(theta, phi) = sqrt((n + 1) / pi) R_n^|k|(sqrt(2) sin(theta/2)) az_k(phi)
/// az_k = cos k phi for k > 0, 1/sqrt(2) for 0, -sin k phi below; (i) and (r) are the directions of
/// wi and wo. By reciprocity f_ji has (i) and (r) exchanged, and the other sign for 31, 32 and 43.
/// Azimuths are counted from the side of the plane of incidence that is away from wi, so that wi
/// has pi: published tables were measured like this. The axes of Stokes vectors are x, in that
/// plane, and y, carried along to the direction of the light ("xyxy" in SCATMECH). The BRDF is
/// isotropic.
class ZernikeMueller : public Brdf {
public:
    /// A row of the table, with i and j from 0.
    struct Row {
        int i = 0, j = 0;
        std::array<int, 2> n{}, k{};  ///< n and m; k and l
        int p = 0;
        double a = 0;
    };

    /// Throws InputError, starting with `name`, where no row is of one of the elements.
    ZernikeMueller(ZernikeExpansion reflectance, const std::vector<Row>& rows,
                   MuellerElements elements, std::string name);

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    std::vector<Fact> facts() const override;

private:
    struct Product {  ///< K of a mode at wi times K of one at wo, for a place in the matrix
        std::size_t place = 0, first = 0, second = 0;
        std::vector<double> weights;  ///< per wavelength
    };
    std::size_t mode(int n, int k);
    void addRow(const Row& row, std::size_t place);
    /// The elements over f_11, by wavelength.
    void ratios(const Direction& wo, const Direction& wi,
                std::vector<MuellerElements::Matrix>& out) const;
    void modes(const Direction& d, double phi, double* out) const;

    ZernikeExpansion reflectance_;
    MuellerElements elements_;
    Channels channels_;
    std::string name_;
    Laws laws_;
    std::vector<std::pair<int, int>> modes_;  ///< (n, k) in use
    std::vector<Product> products_;
    std::size_t rows_ = 0;
};

}  // namespace hshfit::brdfs
