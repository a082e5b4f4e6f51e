#include <brdfs/analytic/thin_film.h>

#include <brdfs/analytic/thin_film_terms.h>

namespace hshfit::brdfs {

std::array<double, 3> thinFilmReflectance(double cosine, double ior, double nanometres,
                                          const std::array<double, 3>& f0) {
    using namespace HWY_NAMESPACE;
    const FilmShape<double> film = filmShape(1.0, ior, nanometres);
    FilmBase<double> base{};
    for (std::size_t c = 0; c < 3; ++c) setFilmBase(f0[c], c, film, base);
    const FilmWaves<double> waves(film, cosine);
    return {waves.reflectance(base, 0), waves.reflectance(base, 1), waves.reflectance(base, 2)};
}

}  // namespace hshfit::brdfs
