// Terms of gltf_pbr.h. Included by gltf_pbr.cpp once for each instruction set.

#include <brdfs/analytic/charlie_lobe.h>
#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/ggx_facets.h>
#include <brdfs/analytic/sheen_albedo.h>
#include <brdfs/analytic/term_columns.h>
#include <brdfs/analytic/thin_film_terms.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class GltfPbrTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = 8;

    HWY_INLINE GltfPbrTerms(const GltfPbrShape<N>& shape, const OutgoingOf<T>& wo)
        : shape_(shape),
          wo_(wo),
          z_(wo.z),
          base_(shape.base),
          coat_(shape.coat),
          turn_{shape.cosine, shape.sine},
          sheen_(shape.curve, R(wo.z)) {
        const Incoming<R> outgoing{R(wo.x), R(wo.y), R(wo.z)};
        outgoing_ = base_.scaledLambda(turn_(outgoing, R(1.0)));
        coatOutgoing_ = coat_.scaledLambda(outgoing);
        coatFresnel_ = 0.04 + 0.96 * schlickWeightOf(z_);
        under_ = 1.0 - T(shape.clearcoat) * coatFresnel_;
        if (!isZero(shape.sheen)) outgoingAlbedo_ = albedo(z_);
    }

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const Incoming<R> above{wi.x, wi.y, max(wi.z, R(0.0))};
        const HalfVector<R> h(wo_, above);
        const R rise = schlickWeightOf(h.dotOutgoing());
        T under = under_;
        term[3] = T(0.0);
        if (!isZero(shape_.sheen)) {
            term[3] = under_ * bounded(sheen_(above.z, sheen_.lambda(above.z), h.squaredSlope()));
            under = under * (1.0 - T(shape_.sheenPeak) * max(albedo(above.z), outgoingAlbedo_));
        }
        const Incoming<R> half{h.x, h.y, h.z};
        const T lobe =
            base_.lobe(turn_(half, h.squaredLength()), turn_(above, R(1.0)), z_, outgoing_);
        const T specular(shape_.specular), transmitted(1 - shape_.f0);
        const T reflected = under * lobe;
        if (isZero(shape_.film.weight)) {
            term[0] = under * (1.0 - specular + specular * transmitted * (1.0 - rise));
            term[1] = reflected * (1.0 - rise);
            term[2] = reflected * rise;
            term[5] = term[6] = term[7] = T(0.0);
        } else {
            const T bare = reflected * T(1 - shape_.film.weight);
            term[0] = under *
                      underFilm(h.dotOutgoing(), rise, T(shape_.film.weight) * reflected, term + 5);
            term[1] = bare * (1.0 - rise);
            term[2] = bare * rise;
        }
        term[4] = isZero(shape_.clearcoat) ? T(0.0)
                                           : coatFresnel_ * coat_.lobe(h, above, z_, coatOutgoing_);
    }

private:
    /// The share of the diffuse part under the film; writes `lobe` times the film's reflectances.
    HWY_INLINE T underFilm(R cosine, R rise, T lobe, T* term) const {
        const FilmShape<N>& film = shape_.film;
        const FilmWaves<T> waves(film, cosine);
        T largest(0.0);
        for (std::size_t c = 0; c < 3; ++c) {
            T sum(0.0);
            if (!isZero(film.dielectricScale[c])) {
                const N& f0 = shape_.f0Of[c];
                const T under = waves.reflectance(film.dielectric, c);
                const T bare = T(shape_.specular) * (T(f0) + T(1 - f0) * rise);
                largest = max(largest, bare + T(film.weight) * (under - bare));
                sum = T(film.dielectricScale[c]) * under;
            }
            if (!isZero(film.metalScale[c]))
                sum = sum + T(film.metalScale[c]) * waves.reflectance(film.metal, c);
            term[c] = lobe * sum;
        }
        return 1.0 - largest;
    }
    /// E from the table of the shape (sheen_albedo.h).
    HWY_INLINE T albedo(R z) const {
        constexpr int steps = SheenAlbedoTable::steps;
        const R x = sqrt(max(z, R(0.0))) * steps;
        const R at = truncated(min(x, R(steps - 1.0))), t = x - at;
        const N* row = shape_.albedo.data();
        const T a = gather(row, at), b = gather(row + 1, at), c = gather(row + 2, at),
                d = gather(row + 3, at);
        const T third = 3.0 * (b - c) + d - a, second = 2.0 * a - 5.0 * b + 4.0 * c - d;
        return b + 0.5 * t * (c - a + t * (second + t * third));
    }

    const GltfPbrShape<N>& shape_;
    OutgoingOf<T> wo_;
    R z_;
    GgxFacets<T> base_, coat_;
    Turn<T> turn_;
    T outgoing_, coatOutgoing_, under_, outgoingAlbedo_;
    R coatFresnel_;
    CharlieLobe<T> sheen_;
};

struct GltfPbrFormula {
    template <class T>
    using Terms = GltfPbrTerms<T>;

    template <class N>
    static N widthOf(const N& roughness) {
        return max(N(1e-4), roughness * roughness);
    }
    /// Whether R, G and B have reflectances of their own.
    static bool coloured(const Parameters& p) {
        return p.number("iridescenceFactor") > 0 && p.number("iridescenceThickness") > 0;
    }
    template <class N>
    static N f0(const Values<N>& p, std::size_t channel) {
        return min(N(1.0),
                   normalReflectanceOf(p("ior"), N(0.0)) * p.of("specularColorFactor", channel));
    }
    /// With the colours of all channels, of which the base's are given to lobes by their weights.
    template <class N>
    static void setFilm(const Values<N>& p, GltfPbrShape<N>& shape) {
        FilmShape<N>& film = shape.film;
        film = filmShape(p("iridescenceFactor"), p("iridescenceIor"), p("iridescenceThickness"));
        if (isZero(film.weight)) return;
        for (std::size_t c = 0; c < 3; ++c) {
            shape.f0Of[c] = f0(p, c);
            setFilmBase(shape.specular * shape.f0Of[c], c, film, film.dielectric);
            setFilmBase(p.of("baseColorFactor", c), c, film, film.metal);
            const N metallic = p("metallicFactor");
            film.dielectricScale[c] = 1 - metallic;
            film.metalScale[c] = p.wanted(c) ? metallic : N(0.0);
        }
    }
    /// The shape of one channel; gltf_pbr.cpp puts in the largest of all.
    template <class N>
    static GltfPbrShape<N> shape(const Values<N>& p) {
        const N alpha = widthOf(p("roughnessFactor")),
                coat = widthOf(p("clearcoatRoughnessFactor"));
        const N strength = p("anisotropyStrength"), rotation = p("anisotropyRotation");
        const N along = alpha + (1 - alpha) * strength * strength;
        const N least(SheenAlbedoTable::leastRoughness),
            sheenRoughness = max(least, p("sheenRoughnessFactor"));
        GltfPbrShape<N> shape{.base = {{along, alpha}},
                              .coat = {{coat, coat}},
                              .cosine = cos(rotation),
                              .sine = sin(rotation),
                              .specular = p("specularFactor"),
                              .f0 = f0(p, p.channel()),
                              .clearcoat = p("clearcoatFactor"),
                              .sheen = p("sheenColorFactor"),
                              .sheenPeak = p("sheenColorFactor"),
                              .curve = charlieCurve(sheenRoughness * sheenRoughness),
                              .albedo = {},
                              .f0Of = {},
                              .film = {}};
        setFilm(p, shape);
        if (!isZero(shape.sheen)) setAlbedo(sheenRoughness, shape);
        return shape;
    }
    template <class N>
    static void setAlbedo(const N& roughness, GltfPbrShape<N>& shape) {
        SheenAlbedoTable::Row values, slopes;
        SheenAlbedoTable::instance().at(plain(roughness), values, slopes);
        for (std::size_t k = 0; k < values.size(); ++k)
            shape.albedo[k] = values[k] + slopes[k] * (roughness - plain(roughness));
    }
    /// Weights of the diffuse part, F0 and the white rest of the lobe, the sheen, the coat, and the
    /// lobe under a film in each channel.
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        const N metallic = p("metallicFactor"), base = p("baseColorFactor");
        const N dielectric = (1 - metallic) * p("specularFactor");
        // Without a film its terms are no part of f, smooth or not.
        const bool film = !isZero(p("iridescenceFactor")) && !isZero(p("iridescenceThickness"));
        const auto own = [&](std::size_t c) { return N(film && p.channel() == c ? 1.0 : 0.0); };
        return {N(0.0),
                {(1 - metallic) * base / pi, dielectric * f0(p, p.channel()) + metallic * base,
                 dielectric + metallic, p("sheenColorFactor"), p("clearcoatFactor"), own(0), own(1),
                 own(2)}};
    }
};

void evalGltfPbr(const GltfPbrShape<double>& shape, const TermBatch& batch) {
    evalLanes<GltfPbrTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> gltfPbrColumns(const ColumnRequest& request) {
    return columnsOf<GltfPbrFormula, 4, 2>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
