#pragma once

#include <brdfs/analytic/eon_shape.h>
#include <brdfs/analytic/ggx_shape.h>
#include <brdfs/analytic/thin_film.h>

#include <array>

namespace hshfit::brdfs {

/// Directional albedo of facets at nodes of sqrt(cos theta), with one more node beyond each end.
template <class N>
struct FacetAlbedo {
    static constexpr int steps = 24;
    std::array<N, steps + 3> values{};
};

template <class N>
struct OpenpbrShape {
    GgxShape<N> base, coat;
    N cosine, sine;  ///< of the turn of both
    EonShape<N> diffuse;
    N eta, coatEta, coatWeight, fuzzWeight, fuzzRoughness;
    FacetAlbedo<N> specularAlbedo, coatAlbedo;
    FilmShape<N> film;
};

}  // namespace hshfit::brdfs
