// Terms of disney.h. Included by disney.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
HWY_INLINE T mix(T a, T b, double share) {
    return a + (b - a) * share;
}

/// Smith's 2 G1/(2 cos) of GGX: 1/(z + sqrt(z^2 + (ax x)^2 + (ay y)^2)).
template <class T>
HWY_INLINE T smithVisible(const DisneyShape::Axes& axes, const Incoming<T>& w) {
    const T x = axes.ax * w.x, y = axes.ay * w.y;
    return bounded(1.0 / (w.z + sqrt(w.z * w.z + x * x + y * y)));
}

template <class T>
class DisneyTerms {
public:
    static constexpr std::size_t count = 4;

    HWY_INLINE DisneyTerms(const DisneyShape& shape, const Direction& wo)
        : shape_(shape), wo_(wo), inverseX_(1 / shape.axes.ax), inverseY_(1 / shape.axes.ay) {
        const Incoming<T> outgoing{T(wo.x), T(wo.y), T(wo.z)};
        masked_ = smithVisible(shape.masking, outgoing);
        coatMasked_ = smithVisible(coat, outgoing);
        outgoingEdge_ = schlickWeightOf(outgoing.z);
        peak_ = inverseX_ * inverseY_ / pi;
        const double squared = shape.gloss * shape.gloss;
        coatScale_ = (squared - 1) / (pi * std::log(squared));
    }

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const HalfVector<T> h(wo_, wi);
        const T cosine = h.dotOutgoing(), rise = schlickWeightOf(cosine);
        const T lobe = bounded(density(h) * bounded(smithVisible(shape_.masking, wi) * masked_));
        term[0] = diffuse(wi.z, cosine);
        term[1] = rise;
        term[2] = lobe * (1.0 - rise);
        term[3] = lobe * rise;
        if (shape_.clearcoat > 0)
            term[3] = term[3] + shape_.clearcoat * (0.04 + 0.96 * rise) * coatDensity(h) *
                                    bounded(smithVisible(coat, wi) * coatMasked_);
    }

private:
    static constexpr DisneyShape::Axes coat{0.25, 0.25};

    HWY_INLINE T diffuse(T incoming, T cosine) const {
        const T retro = shape_.roughness * cosine * cosine;
        const T edge = schlickWeightOf(incoming);
        const auto both = [&](T most) HWY_ATTR {
            return (1.0 + (most - 1.0) * edge) * (1.0 + (most - 1.0) * outgoingEdge_);
        };
        const T lifted = both(0.5 + 2.0 * retro);
        if (shape_.subsurface == 0) return lifted;
        const T sum = 1.0 / (incoming + T(wo_.z));
        const T flat = 1.25 * (both(retro) * bounded(sum - 0.5) + 0.5);
        return mix(lifted, bounded(flat), shape_.subsurface);
    }

    HWY_INLINE T density(const HalfVector<T>& h) const {
        const T x = h.x * inverseX_, y = h.y * inverseY_;
        const T ratio = h.squaredLength() / (h.z * h.z + x * x + y * y);
        return ratio * ratio * peak_;
    }

    HWY_INLINE T coatDensity(const HalfVector<T>& h) const {
        const T slope = h.squaredSlope();
        return coatScale_ * (1.0 + slope) / (shape_.gloss * shape_.gloss + slope);
    }

    DisneyShape shape_;
    Direction wo_;
    double inverseX_, inverseY_, peak_, coatScale_;
    T masked_, coatMasked_, outgoingEdge_;
};

void evalDisney(const DisneyShape& shape, const TermBatch& batch) {
    evalLanes<DisneyTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
