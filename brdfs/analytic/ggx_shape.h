#pragma once

namespace hshfit::brdfs {

/// Roughness along the two axes: both equal to `alpha`, or `ax` and `ay`.
template <class N>
struct RoughnessOf {
    N ax, ay;
};

template <class N>
struct GgxShape {
    RoughnessOf<N> r;

    /// D has a pole at the slope i alpha.
    N widthX() const { return r.ax; }
    N widthY() const { return r.ay; }
};

}  // namespace hshfit::brdfs
