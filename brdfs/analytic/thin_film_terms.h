// The formula of thin_film.h for any number T. Compiled once for each instruction set.

#if defined(BRDFS_ANALYTIC_THIN_FILM_TERMS_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_THIN_FILM_TERMS_H
#undef BRDFS_ANALYTIC_THIN_FILM_TERMS_H
#else
#define BRDFS_ANALYTIC_THIN_FILM_TERMS_H
#endif

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/term_values.h>
#include <brdfs/analytic/thin_film.h>
#include <brdfs/lanes/lanes_angles.h>

#include <array>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// Gaussians of the extension: X has two, Y and Z one each.
struct FilmCurves {
    static constexpr std::size_t count = 4;
    static constexpr double place[count] = {1.6810e6, 2.2399e6, 1.7953e6, 2.2084e6};
    static constexpr double variance[count] = {4.3278e9, 4.5282e9, 9.3046e9, 6.6121e9};
    static constexpr double height[count] = {5.4856e-13, 9.7470e-14, 4.4201e-13, 5.2481e-13};
    static constexpr double unit = 1.0685e-7;
    /// Rec. 709's matrix, with the column of X for both of its Gaussians.
    static constexpr double rgb[3][count] = {{3.2404542, 3.2404542, -1.5371385, -0.4985314},
                                             {-0.9692660, -0.9692660, 1.8760108, 0.0415560},
                                             {0.0556434, 0.0556434, -0.2040259, 1.0572252}};

    static HWY_INLINE double amplitude(std::size_t j) {
        return height[j] * std::sqrt(2 * pi * variance[j]) / unit;
    }
};

/// The factors that all channels have in common at one cosine of incidence.
template <class T>
class FilmWaves {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    HWY_INLINE FilmWaves(const FilmShape<N>& film, R cosine) {
        const R c = min(max(cosine, R(0.0)), R(1.0));
        const T sine = (1.0 - c) * (1.0 + c) * T(1 / (film.ior * film.ior));
        const T below = sqrt(max(1.0 - sine, T(0.0)));
        top_ = T(film.top) + T(1 - film.top) * schlickWeightOf(c);
        rise_ = schlickWeightOf(below);
        const T phase = T(film.path) * below, squared = phase * phase;
        for (std::size_t j = 0; j < FilmCurves::count; ++j) {
            const T wave = cos(FilmCurves::place[j] * phase);
            const T damped = exp(-FilmCurves::variance[j] * squared), twice = damped * damped;
            first_[j] = 2 * FilmCurves::amplitude(j) * damped * wave;
            second_[j] =
                2 * FilmCurves::amplitude(j) * (twice * twice) * (2.0 * (wave * wave) - 1.0);
        }
    }

    HWY_INLINE T reflectance(const FilmBase<N>& base, std::size_t channel) const {
        const N& normal = base.reflectance[channel];
        const T r23 = T(normal) + T(1 - normal) * rise_;
        const T both = min(max(top_ * r23, T(1e-5)), T(0.9999)), root = sqrt(both);
        const T through = 1.0 - top_, rs = through * through * r23 / (1.0 - both);
        T sum = top_ + rs;
        const T once = (rs - through) * root * base.sign[channel], again = (rs - through) * both;
        for (std::size_t j = 0; j < FilmCurves::count; ++j)
            sum = sum + FilmCurves::rgb[channel][j] * (once * first_[j] + again * second_[j]);
        return min(max(sum, T(0.0)), T(1.0));
    }

private:
    T top_, rise_, first_[FilmCurves::count], second_[FilmCurves::count];
};

/// The part of a material's film that its base does not enter; `weight` is of the facets.
template <class N>
FilmShape<N> filmShape(const N& weight, const N& ior, const N& nanometres) {
    FilmShape<N> film{};
    film.weight = isZero(nanometres) ? N(0.0) : weight;
    constexpr double least = 0.03;
    const N share = min(nanometres / least, N(1.0));
    film.ior = 1 + (ior - 1) * (share * share * (3 - 2 * share));
    film.path = 4e-9 * pi * film.ior * nanometres;
    film.top = normalReflectanceOf(film.ior, N(0.0));
    return film;
}

template <class N>
void setFilmBase(const N& f0, std::size_t channel, const FilmShape<N>& film, FilmBase<N>& base) {
    const N root = sqrt(min(f0, N(0.9999))), index = (1 + root) / (1 - root);
    base.reflectance[channel] = normalReflectanceOf<N>(index / film.ior, N(0.0));
    base.sign[channel] = plain(index) >= plain(film.ior) ? -1 : 1;
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
