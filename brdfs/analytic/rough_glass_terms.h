// The term of rough_glass.h. Included by rough_glass.cpp once for each instruction set.

#include <brdfs/analytic/ggx_facets.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// With h = s (-(i.x + n o.x), -(i.y + n o.y), n o.z - i.z), not made 1 long, of the mirrored
/// wo = (o.x, o.y, o.z), n = n_o / n_i and s the sign of n - 1:
///     i.h = s (n c - 1) = a,   -o.h = s (n - c) = b,   |h|^2 = 1 + n^2 - 2 n c,
/// c the cosine of the angle between -i and o. The denominator of Eq. 21 is then |h|^2, and
///     1 - F = 2 n a b (1 / (a + n b)^2 + 1 / (n a + b)^2).
template <class T>
class RoughGlassTerms {
    using R = RealOf<T>;

public:
    static constexpr std::size_t count = 1;

    HWY_INLINE RoughGlassTerms(const RoughGlassShape& shape, const OutgoingOf<T>& wo)
        : wo_(wo), shape_(shape), outgoing_(scaledMasking({R(wo.x), R(wo.y), R(wo.z)})) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const double n = shape_.index, s = n > 1 ? 1.0 : -1.0;
        const R c = wi.z * R(wo_.z) - wi.x * R(wo_.x) - wi.y * R(wo_.y);
        const R a = s * (n * c - 1.0), b = s * (n - c);
        const R z = s * (n * R(wo_.z) - wi.z);
        const R x = wi.x + n * R(wo_.x), y = wi.y + n * R(wo_.y);
        const R least = min(min(a, b), z);
        const R inside = max(least, R(1e-150));
        const R product = max(a, inside) * max(b, inside);
        const R sumA = max(a, inside) + n * max(b, inside),
                sumB = n * max(a, inside) + max(b, inside);
        const R through = 2.0 * n * product * (1.0 / (sumA * sumA) + 1.0 / (sumB * sumB));
        const R above = max(wi.z, R(1e-100));
        const R masked = scaledMasking({wi.x, wi.y, above}) * outgoing_;
        const R lobe = n * n * product * through * density(x * x + y * y, max(z, inside)) / masked;
        term[0] = select(least > R(0.0), bounded(lobe), R(0.0));
    }

private:
    /// z (1 + Lambda(w)), which is z / G_1.
    HWY_INLINE R scaledMasking(const Incoming<R>& w) const {
        const R s = (w.x * w.x + w.y * w.y) * (shape_.alpha * shape_.alpha);
        if (!shape_.beckmann) return 0.5 * (w.z + sqrt(w.z * w.z + s));
        const R root = max(sqrt(s), R(1e-140));
        return w.z + 0.5 * root * ierfc(w.z / root);
    }

    /// D / |h|^4 of h with height z and the square q of its length along the surface.
    HWY_INLINE R density(R q, R z) const {
        const double inverse = 1 / (shape_.alpha * shape_.alpha);
        const R zz = z * z;
        if (shape_.beckmann) return bounded(exp(-q * inverse / zz) * (inverse / pi) / (zz * zz));
        const R sum = zz + q * inverse;
        return bounded((inverse / pi) / (sum * sum));
    }

    OutgoingOf<T> wo_;
    RoughGlassShape shape_;
    R outgoing_;
};

void evalRoughGlass(const RoughGlassShape& shape, const TermBatch& batch) {
    evalLanes<RoughGlassTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
