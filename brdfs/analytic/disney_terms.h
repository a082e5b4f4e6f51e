// Terms of disney.h. Included by disney.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T, class Share>
HWY_INLINE T mix(T a, T b, Share share) {
    return a + (b - a) * share;
}

/// Smith's 2 G1/(2 cos) of GGX: 1/(z + sqrt(z^2 + (ax x)^2 + (ay y)^2)).
template <class T, class R>
HWY_INLINE T smithVisible(const T& ax, const T& ay, const Incoming<R>& w) {
    const T x = ax * w.x, y = ay * w.y;
    return bounded(1.0 / (w.z + sqrt(w.z * w.z + x * x + y * y)));
}

template <class T>
class DisneyTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = 4;

    HWY_INLINE DisneyTerms(const DisneyShape<N>& shape, const OutgoingOf<T>& wo)
        : shape_(shape), wo_(wo), inverseX_(1 / shape.axes.ax), inverseY_(1 / shape.axes.ay) {
        const Incoming<R> outgoing{R(wo.x), R(wo.y), R(wo.z)};
        maskingX_ = shape.masking.ax, maskingY_ = shape.masking.ay;
        masked_ = smithVisible(maskingX_, maskingY_, outgoing);
        coatMasked_ = smithVisible(R(coat), R(coat), outgoing);
        outgoingEdge_ = schlickWeightOf(outgoing.z);
        peak_ = 1 / shape.axes.ax * (1 / shape.axes.ay) / pi;
        const N squared = shape.gloss * shape.gloss;
        gloss_ = squared;
        coatScale_ = (squared - 1) / (pi * log(squared));
    }

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const HalfVector<R> h(wo_, wi);
        const R cosine = h.dotOutgoing(), rise = schlickWeightOf(cosine);
        const T lobe =
            bounded(density(h) * bounded(smithVisible(maskingX_, maskingY_, wi) * masked_));
        term[0] = diffuse(wi.z, cosine);
        term[1] = T(rise);
        term[2] = lobe * (1.0 - rise);
        term[3] = lobe * rise;
        if (!isZero(shape_.clearcoat))
            term[3] = term[3] + T(shape_.clearcoat) * (0.04 + 0.96 * rise) * coatDensity(h) *
                                    bounded(smithVisible(R(coat), R(coat), wi) * coatMasked_);
    }

private:
    static constexpr double coat = 0.25;

    HWY_INLINE T diffuse(R incoming, R cosine) const {
        const T retro = T(shape_.roughness) * cosine * cosine;
        const R edge = schlickWeightOf(incoming);
        const auto both = [&](T most) HWY_ATTR {
            return (1.0 + (most - 1.0) * edge) * (1.0 + (most - 1.0) * outgoingEdge_);
        };
        const T lifted = both(0.5 + 2.0 * retro);
        if (isZero(shape_.subsurface)) return lifted;
        const R sum = 1.0 / (incoming + R(wo_.z));
        const T flat = 1.25 * (both(retro) * bounded(sum - 0.5) + 0.5);
        return mix(lifted, bounded(flat), T(shape_.subsurface));
    }

    HWY_INLINE T density(const HalfVector<R>& h) const {
        const T x = h.x * inverseX_, y = h.y * inverseY_;
        const T ratio = h.squaredLength() / (h.z * h.z + x * x + y * y);
        return ratio * ratio * peak_;
    }

    HWY_INLINE T coatDensity(const HalfVector<R>& h) const {
        const R slope = h.squaredSlope();
        return coatScale_ * (1.0 + slope) / (gloss_ + slope);
    }

    const DisneyShape<N>& shape_;
    OutgoingOf<T> wo_;
    T inverseX_, inverseY_, peak_, gloss_, coatScale_, maskingX_, maskingY_, masked_;
    R coatMasked_, outgoingEdge_;
};

struct DisneyFormula {
    template <class T>
    using Terms = DisneyTerms<T>;

    template <class N>
    static DisneyShape<N> shape(const Values<N>& p) {
        const N roughness = p("roughness");
        const N old = (0.5 + roughness / 2) * (0.5 + roughness / 2);
        const DisneyAxes<N> own = axes(p);
        return {.roughness = roughness,
                .subsurface = p("subsurface"),
                .clearcoat = 0.25 * p("clearcoat"),
                .gloss = mix(N(0.1), N(0.001), p("clearcoatGloss")),
                .axes = own,
                .masking = p.chosen("masking", "2014") ? own : DisneyAxes<N>{old, old}};
    }
    template <class N>
    static DisneyAxes<N> axes(const Values<N>& p) {
        const N aspect = sqrt(1 - 0.9 * p("anisotropic"));
        const N alpha = p("roughness") * p("roughness");
        return {max(N(0.001), alpha / aspect), max(N(0.001), alpha * aspect)};
    }
    /// Weights of the diffuse part, sheen, 1 - F of the metallic or dielectric lobe, and the
    /// white part. `tint`: baseColor over its luminance, 1 for grey.
    template <class N>
    static Weights<N> weights(const Values<N>& p, double tint = 1) {
        const N metallic = p("metallic"), base = p("baseColor");
        const auto tinted = [&](const char* share, const N& scale) {
            return scale * mix(N(1.0), N(tint), p(share));
        };
        const N c0 = mix(tinted("specularTint", 0.08 * p("specular")), base, metallic);
        return {N(0.0),
                {(1 - metallic) * base / pi, tinted("sheenTint", (1 - metallic) * p("sheen")), c0,
                 N(1.0)}};
    }
};

void evalDisney(const DisneyShape<double>& shape, const TermBatch& batch) {
    evalLanes<DisneyTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> disneyColumns(const ColumnRequest& request) {
    return columnsOf<DisneyFormula, 4>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
