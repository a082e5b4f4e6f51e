#pragma once

#include <brdfs/measured/mueller.h>
#include <brdfs/rows/format.h>
#include <hshfit/brdf/brdf.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// R_n^l(r), l >= 0, n - l even.
double zernikeRadial(int n, int l, double r);

/// A reciprocal isotropic BRDF in products of Zernike functions (Koenderink & van Doorn 1998,
/// 10.1364/JOSAA.15.002903; Germer 2017, 10.1364/AO.56.009333), for unpolarised light:
///     f = sum a lambda^p N_{nm}^l (R_n^l(r_i) R_m^l(r_o) + R_m^l(r_i) R_n^l(r_o)) cos l (phi_o -
///     phi_i),    r = sqrt(2) sin(theta/2),   N = sqrt((n + 1)(m + 1) / D) / (2 pi)
/// D = 4 for n = 0 or (n = m and l = 0), 2 for n = m or l = 0, else 1; lambda in um. Values below 0
/// count as 0. Tables may be normalised to unit reflectance, as the table of PTFE is; `scale` then
/// multiplies f.
class ZernikeExpansion : public Brdf {
public:
    /// One line of the file with i = j = 1.
    struct Term {
        int n = 0, m = 0, l = 0, p = 0;
        double a = 0;
    };

    /// `wavelengths` in nm, ascending; empty: grey, for a table that does not depend on them.
    ZernikeExpansion(const std::vector<Term>& terms, std::vector<double> wavelengths,
                     std::string name, std::size_t otherTerms = 0);

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    std::vector<Fact> facts() const override;

private:
    struct Product {  ///< R_n^l(r_i) R_m^l(r_o), with both orders of n and m listed
        int radial = 0, other = 0, l = 0;  ///< indices into radials_
        std::vector<double> weights;       ///< per channel
    };
    void radials(const Direction& d, double* out) const;

    std::string name_;
    Channels channels_;
    Laws laws_;
    std::vector<std::pair<int, int>> radials_;  ///< (n, l) in use
    std::vector<Product> products_;
    int highest_ = 0;  ///< l
    std::size_t terms_ = 0, otherTerms_ = 0;
};

struct ScatmechOptions {
    double wavelength = 0, scale = 1;
    MuellerElements elements = MuellerElements();
};

/// Reads a SCATMECH coefficient table, rows i, j, n, m, k, l, p, a between commas or blanks. Rows
/// of other Mueller elements than those asked for are checked and left out. `wavelength` in nm;
/// 0: grey where no row depends on it, else 351, 532, 633 and 1064 nm, at which PTFE was measured.
/// Every a is multiplied by `scale`. Throws InputError, with `where` and the line, for any other
/// content.
std::unique_ptr<Brdf> readScatmech(std::string_view text, const std::string& where,
                                   std::string name, const ScatmechOptions& options = {});

/// The row of the table of formats.
const Format& scatmechFormat();

}  // namespace hshfit::brdfs
