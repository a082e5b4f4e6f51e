// Terms of openpbr.h. Included by openpbr.cpp once for each instruction set.

#include <brdfs/analytic/eon_lobe.h>
#include <brdfs/analytic/facet_albedo.h>
#include <brdfs/analytic/ggx_facets.h>
#include <brdfs/analytic/term_columns.h>
#include <brdfs/analytic/thin_film_terms.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// The fuzz for one wo: its albedo, the matrix, and the azimuth of wo. MaterialX's fits to the
/// authors' tables.
template <class T>
struct OpenpbrFuzz {
    using R = RealOf<T>;
    T albedo, a, b;
    R x, y;

    HWY_INLINE OpenpbrFuzz(const ParameterOf<T>& roughness, const Incoming<R>& wo)
        : albedo(0.0), a(1.0), b(0.0) {
        const R height = wo.z;
        const T y(roughness);
        const T width = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y));
        const T middle =
            y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y * y))) / (0.046391 + y);
        const T rest =
            y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) / (1.26264 + y * (-1.92021 + y));
        const T away = (height - middle) / width;
        const T peak = exp(-0.5 * away * away) / (width * std::sqrt(2 * pi)) + rest;
        albedo = min(max(peak, T(0.0)), T(1.0));
        a = (2.58126 * height + 0.813703 * y) * y /
            (1.0 + 0.310327 * height * height + 2.60994 * height * y);
        b = sqrt(max(R(0.0), 1.0 - height)) * (y - 1.0) * y * y * y /
            (0.0000254053 + 1.71228 * height - 1.71506 * height * y + 1.34174 * y * y);
        const R sine = sqrt(wo.x * wo.x + wo.y * wo.y);
        const auto tilted = sine > R(0.0);
        x = select(tilted, wo.x / sine, R(1.0));
        this->y = select(tilted, wo.y / sine, R(0.0));
    }
};

template <class T>
class OpenpbrTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = 11;

    HWY_INLINE OpenpbrTerms(const OpenpbrShape<N>& shape, const OutgoingOf<T>& wo)
        : shape_(shape),
          wo_(wo),
          z_(wo.z),
          base_(shape.base),
          coat_(shape.coat),
          turn_{shape.cosine, shape.sine},
          diffuse_(shape.diffuse, wo),
          fuzz_(shape.fuzzRoughness, {R(wo.x), R(wo.y), R(wo.z)}) {
        const Incoming<R> outgoing{R(wo.x), R(wo.y), R(wo.z)};
        outgoing_ = base_.scaledLambda(turn_(outgoing, R(1.0)));
        coatOutgoing_ = coat_.scaledLambda(turn_(outgoing, R(1.0)));
        underFuzz_ = 1.0 - T(shape.fuzzWeight) * fuzz_.albedo;
        under_ = underFuzz_;
        if (!isZero(shape.coatWeight))
            under_ = under_ * (1.0 - T(shape.coatWeight) * facetAlbedoAt<T>(shape.coatAlbedo, z_));
        underFacets_ = under_ * (1.0 - facetAlbedoAt<T>(shape.specularAlbedo, z_));
    }

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const Incoming<R> above{wi.x, wi.y, max(wi.z, R(0.0))};
        const HalfVector<R> h(wo_, above);
        const R cosine = h.dotOutgoing(), rest = 1.0 - cosine, rise = schlickWeightOf(cosine);
        const Turned<T> half = turn_({h.x, h.y, h.z}, h.squaredLength()),
                        incoming = turn_(above, R(1.0));
        T lobe = under_ * base_.lobe(half, incoming, z_, outgoing_);
        term[8] = term[9] = term[10] = T(0.0);
        if (!isZero(shape_.film.weight)) {
            addFilm(cosine, T(shape_.film.weight) * lobe, term + 8);
            lobe = lobe * T(1 - shape_.film.weight);
        }
        diffuse_(wi, term);
        for (int i = 0; i < 2; ++i) term[i] = underFacets_ * bounded(term[i]);
        term[2] = lobe * reflectanceOf<T>(cosine, shape_.eta, N(0.0));
        term[3] = lobe * (1.0 - rise);
        term[4] = lobe * rise;
        term[5] = lobe * (cosine * rise * rest);
        term[6] = T(0.0);
        if (!isZero(shape_.coatWeight))
            term[6] = underFuzz_ * coat_.lobe(half, incoming, z_, coatOutgoing_) *
                      reflectanceOf<T>(cosine, shape_.coatEta, N(0.0));
        term[7] = isZero(shape_.fuzzWeight) ? T(0.0) : fuzz(above);
    }

private:
    /// `lobe` times the film's reflectances.
    HWY_INLINE void addFilm(R cosine, T lobe, T* term) const {
        const FilmShape<N>& film = shape_.film;
        const FilmWaves<T> waves(film, cosine);
        for (std::size_t c = 0; c < 3; ++c) {
            T sum(0.0);
            if (!isZero(film.dielectricScale[c]))
                sum = T(film.dielectricScale[c]) * waves.reflectance(film.dielectric, c);
            if (!isZero(film.metalScale[c]))
                sum = sum + T(film.metalScale[c]) * waves.reflectance(film.metal, c);
            term[c] = lobe * sum;
        }
    }
    /// E_z / pi (a / |M wi|^2)^2, M = (a 0 b; 0 a 0; 0 0 1) in the plane of wo and the normal.
    HWY_INLINE T fuzz(const Incoming<R>& wi) const {
        const R along = wi.x * fuzz_.x + wi.y * fuzz_.y, across = wi.y * fuzz_.x - wi.x * fuzz_.y;
        const T x = fuzz_.a * along + fuzz_.b * wi.z, y = fuzz_.a * across;
        const T ratio = fuzz_.a / (x * x + y * y + wi.z * wi.z);
        return fuzz_.albedo / pi * (ratio * ratio);
    }

    const OpenpbrShape<N>& shape_;
    OutgoingOf<T> wo_;
    R z_;
    GgxFacets<T> base_, coat_;
    Turn<T> turn_;
    EonTerms<T> diffuse_;
    OpenpbrFuzz<T> fuzz_;
    T outgoing_, coatOutgoing_, underFuzz_, under_, underFacets_;
};

struct OpenpbrFormula {
    template <class T>
    using Terms = OpenpbrTerms<T>;

    template <class N>
    static N mix(const N& a, const N& b, const N& share) {
        return a + (b - a) * share;
    }
    template <class N>
    static RoughnessOf<N> axes(const N& roughness, const N& anisotropy) {
        const N across = 1 - anisotropy;
        const N along = roughness * roughness * sqrt(2 / (1 + across * across));
        return {max(N(1e-4), along), max(N(1e-4), across * along)};
    }
    /// Roughened by the coat.
    template <class N>
    static RoughnessOf<N> baseAxes(const Values<N>& p) {
        const N own = p("specular_roughness"), coat = p("coat_roughness");
        const N fourth = own * own * own * own + 2 * coat * coat * coat * coat;
        const N rougher = sqrt(sqrt(min(N(1.0), fourth)));
        return axes(mix(own, rougher, p("coat_weight")), p("specular_roughness_anisotropy"));
    }
    template <class N>
    static RoughnessOf<N> coatAxes(const Values<N>& p) {
        return axes(p("coat_roughness"), p("coat_roughness_anisotropy"));
    }
    /// The index of the base, against air or the coat, whose reflectance at normal incidence
    /// specular_weight scales.
    template <class N>
    static N eta(const Values<N>& p) {
        const N ior = p("specular_ior"), ratio = ior / p("coat_ior");
        const N index = mix(ior, max(ratio, 1 / ratio), p("coat_weight"));
        const N f0 = p("specular_weight") * normalReflectanceOf(index, N(0.0));
        const N root = sqrt(min(f0, N(0.99999)));
        return (1 + root) / (1 - root);
    }
    template <class N>
    static EonSettings<N> diffuse(const Values<N>& p) {
        return {eonRoughness(p("base_diffuse_roughness")), true};
    }
    static bool coloured(const Parameters& p) {
        return p.number("thin_film_weight") > 0 && p.number("thin_film_thickness") > 0;
    }
    template <class N>
    static void setFilm(const Values<N>& p, OpenpbrShape<N>& shape) {
        FilmShape<N>& film = shape.film;
        film = filmShape<N>(p("thin_film_weight"), p("thin_film_ior"),
                            1000 * p("thin_film_thickness"));
        if (isZero(film.weight)) return;
        const N metal = p("base_metalness");
        for (std::size_t c = 0; c < 3; ++c) {
            if (!p.wanted(c)) continue;
            setFilmBase(normalReflectanceOf(shape.eta, N(0.0)), c, film, film.dielectric);
            setFilmBase(p("base_weight") * p.of("base_color", c), c, film, film.metal);
            film.dielectricScale[c] = (1 - metal) * p.of("specular_color", c);
            film.metalScale[c] = metal * p("specular_weight");
        }
    }
    template <class N>
    static OpenpbrShape<N> shape(const Values<N>& p) {
        const N turn = p("geometry_tangent");
        OpenpbrShape<N> shape{.base = {baseAxes(p)},
                              .coat = {coatAxes(p)},
                              .cosine = cos(turn),
                              .sine = sin(turn),
                              .diffuse = diffuse(p).shape(),
                              .eta = eta(p),
                              .coatEta = p("coat_ior"),
                              .coatWeight = p("coat_weight"),
                              .fuzzWeight = p("fuzz_weight"),
                              .fuzzRoughness = max(N(0.01), p("fuzz_roughness")),
                              .specularAlbedo = {},
                              .coatAlbedo = {},
                              .film = {}};
        setFilm(p, shape);
        const auto average = [](const RoughnessOf<N>& r) HWY_ATTR { return sqrt(r.ax * r.ay); };
        if (!isZero(1 - p("base_metalness")))
            shape.specularAlbedo = facetAlbedoTable(average(shape.base.r), shape.eta);
        if (!isZero(shape.coatWeight))
            shape.coatAlbedo = facetAlbedoTable(average(shape.coat.r), shape.coatEta);
        return shape;
    }
    /// The colour that the coat gives to the layers under it.
    template <class N>
    static N tint(const Values<N>& p) {
        const N weight = p("coat_weight"), ior = p("coat_ior");
        const N inside = 1 - (1 - normalReflectanceOf(ior, N(0.0))) / (ior * ior);
        const N share = weight * p("coat_darkening");
        const N scale = mix(N(1.0), p("specular_weight"), p("base_metalness"));
        const N darker = (1 - inside) / (1 - scale * p("base_color") * inside);
        return mix(N(1.0), p("coat_color"), weight) * mix(N(1.0), darker, share);
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        const N metal = p("base_metalness"), specular = p("specular_weight");
        const N edge = p("specular_color"), base = p("base_weight") * p("base_color");
        constexpr double cosine = 1. / 7;
        const double rise = schlickWeightOf(cosine), bend = cosine * rise * (1 - cosine);
        const N dip = -(base + (1 - base) * rise) * (1 - specular * edge) / bend;
        const N under = tint(p), dielectric = (1 - metal) * under,
                conductor = metal * specular * under;
        const auto own = [&](std::size_t c) { return p.channel() == c ? under : N(0.0); };
        return {N(0.0),
                {dielectric * base / pi, dielectric * diffuse(p).multiple(base), dielectric * edge,
                 conductor * base, conductor, conductor * dip, p("coat_weight"),
                 p("fuzz_weight") * p("fuzz_color"), own(0), own(1), own(2)}};
    }
};

void evalOpenpbr(const OpenpbrShape<double>& shape, const TermBatch& batch) {
    evalLanes<OpenpbrTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> openpbrColumns(const ColumnRequest& request) {
    return columnsOf<OpenpbrFormula, 4, 3>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
