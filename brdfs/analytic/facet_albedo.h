// The directional albedo of openpbr.h's facets. Compiled once for each instruction set.

#if defined(BRDFS_ANALYTIC_FACET_ALBEDO_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_FACET_ALBEDO_H
#undef BRDFS_ANALYTIC_FACET_ALBEDO_H
#else
#define BRDFS_ANALYTIC_FACET_ALBEDO_H
#endif

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/openpbr_shape.h>
#include <brdfs/analytic/table_nodes.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// GGX's facets with exact Fresnel reflectance and correlated masking, at the height zo; midpoints
/// over visible normals (Heitz 2018, JCGT 7(4)).
template <class X, class N, class Z>
HWY_INLINE X facetAlbedoOf(const X& alpha, const N& ior, Z zo) {
    // Over one half: the other is its mirror image.
    constexpr int rings = 16, azimuths = 10;
    const Z xo = sqrt(1.0 - zo * zo);
    const auto lambda = [&](const X& x2, const X& z) HWY_ATTR {
        return 0.5 * (sqrt(1.0 + alpha * alpha * x2 / (z * z)) - 1.0);
    };
    const X along = alpha * xo, stretched = sqrt(along * along + zo * zo);
    const X vx = along / stretched, vz = zo / stretched, half = 0.5 * (1.0 + vz);
    const X outgoing = lambda(X(xo * xo), X(zo));
    X sum = 0.0;
    for (int i = 0; i < rings; ++i) {
        const double radius = std::sqrt((i + 0.5) / rings);
        for (int j = 0; j < azimuths; ++j) {
            const double phi = pi * ((j + 0.5) / azimuths - 0.5);
            const double t1 = radius * std::cos(phi), rest = 1 - t1 * t1;
            const X t2 = (1.0 - half) * std::sqrt(rest) + half * (radius * std::sin(phi));
            const X t3 = sqrt(max(X(0.0), rest - t2 * t2));
            // T1 is +y, T2 the rest of the frame about the stretched direction.
            const X x = alpha * (t3 * vx - t2 * vz), y = alpha * t1,
                    z = max(X(0.0), t2 * vx + t3 * vz);
            const X length = sqrt(x * x + y * y + z * z);
            const X cosine = (x * xo + z * zo) / length, zi = 2.0 * cosine * z / length - zo;
            const X above = max(zi, X(1e-9));
            const X part = reflectanceOf<X>(min(X(1.0), cosine), ior, N(0.0)) * (1.0 + outgoing) /
                           (1.0 + outgoing + lambda(1.0 - above * above, above));
            sum = sum + select(min(zi, cosine) > X(0.0), part, X(0.0));
        }
    }
    return sum / double(rings * azimuths);
}

template <class N>
HWY_ATTR FacetAlbedo<N> facetAlbedoTable(const N& alpha, const N& ior) {
    using X = typename Node<N>::Number;
    using Value = typename Node<N>::Value;
    constexpr int steps = FacetAlbedo<N>::steps;
    FacetAlbedo<N> table;
    N* nodes = table.values.data() + 1;
    for (std::size_t k = 0; k <= steps; k += lanesIn<Value>()) {
        double heights[HWY_MAX_BYTES / sizeof(double)];
        for (std::size_t i = 0; i < lanesIn<Value>(); ++i) {
            const double root = std::clamp(static_cast<double>(k + i) / steps, 1e-3, 1.0);
            heights[i] = root * root;
        }
        Value height;
        load(heights, height);
        storeNode(facetAlbedoOf(X(alpha), ior, height),
                  std::min<std::size_t>(lanesIn<Value>(), steps + 1 - k), nodes + k);
    }
    table.values.front() = 2 * table.values[1] - table.values[2];
    table.values.back() = 2 * table.values[steps + 1] - table.values[steps];
    return table;
}

/// Catmull-Rom's cubic through the four nearest nodes.
template <class T, class N>
HWY_INLINE T facetAlbedoAt(const FacetAlbedo<N>& table, RealOf<T> cosine) {
    using R = RealOf<T>;
    constexpr int steps = FacetAlbedo<N>::steps;
    const R x = sqrt(min(max(cosine, R(0.0)), R(1.0))) * double(steps);
    const R at = truncated(min(x, R(steps - 1.0))), t = x - at;
    const N* row = table.values.data();
    const T a = gather(row, at), b = gather(row + 1, at), c = gather(row + 2, at),
            d = gather(row + 3, at);
    const T cubic = 3.0 * (b - c) + d - a, square = 2.0 * a - 5.0 * b + 4.0 * c - d;
    return min(max(b + 0.5 * t * (c - a + t * (square + t * cubic)), T(0.0)), T(1.0));
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
