// RglBrdf::eval for RGB, included by rgl.cpp once for each instruction set. Angles are computed for
// as many directions as a register holds; what is read from the tables for one direction lies
// side by side there and is taken up by one register as well: density and integral of two vertices,
// the sums of two rows, a colour.

#include <brdfs/measured/angle_lanes.h>
#include <brdfs/measured/rgl.h>

#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// Four doubles, and the four floats of a table that they come from; in one register or two.
using Quad [[gnu::vector_size(32)]] = double;
using FloatQuad [[gnu::vector_size(16)]] = float;

HWY_INLINE void loadQuad(const float* from, Quad& to) {
#if HWY_MAX_BYTES >= 32  // what the compiler makes of the conversion below goes through memory
    const hn::FixedTag<double, 4> doubles;
    hn::StoreU(hn::PromoteTo(doubles, hn::LoadU(hn::FixedTag<float, 4>(), from)), doubles,
               reinterpret_cast<double*>(&to));
#else
    FloatQuad floats;
    std::memcpy(&floats, from, sizeof floats);
    to = __builtin_convertvector(floats, Quad);
#endif
}

/// Where a block of directions lies in the tables.
struct RglBlock {
    static constexpr std::size_t size = 64;

    double uIncident[size], vIncident[size], uHalf[size], vHalf[size];
    /// The node below phi_i and theta_i, and the weight of the next.
    double phiNode[size], phiFraction[size], thetaNode[size], thetaFraction[size];
};

HWY_INLINE void locate(const std::vector<double>& nodes, Lanes value, double* node,
                       double* fraction) {
    Lanes lower = 0.0, from = nodes.front(), to = nodes[1];
    for (std::size_t i = 1; i + 1 < nodes.size(); ++i) {
        const auto beyond = value >= Lanes(nodes[i]);
        lower = select(beyond, static_cast<double>(i), lower);
        from = select(beyond, nodes[i], from);
        to = select(beyond, nodes[i + 1], to);
    }
    store(lower, node);
    store(min(max((value - from) / (to - from), 0.0), 1.0), fraction);
}

/// A copy of wi, folded into the measured azimuths, and of the half vector.
struct RglFold {
    Lanes ix, iy, iz, hx, hy, hz;

    /// `middle`: of the measured azimuths.
    HWY_INLINE RglFold(int reduction, const Direction& middle, const Direction& wo, Lanes x,
                       Lanes y, Lanes z) {
        const Lanes zero = 0.0, one = 1.0;
        Lanes signX = one, signY = one;
        if (reduction == 2) {
            const Lanes along = x * middle.x + y * middle.y;
            signX = signY = select(along < zero, -one, one);
        } else if (reduction == 4) {
            signX = select(x * middle.x < zero, -one, one);
            signY = select(y * middle.y < zero, -one, one);
        }
        ix = signX * x, iy = signY * y, iz = max(z, zero);
        hx = signX * (x + wo.x), hy = signY * (y + wo.y), hz = iz + wo.z;
    }
};

HWY_INLINE Lanes floorOf(Lanes x) {
    return Lanes(hn::Floor(x.v));
}

/// What is the same for all directions of a call.
struct RglCall {
    const RglTables& tables;
    VisibleNormals::View normals;
    Direction wo, middle;
    double turnStart;           ///< of the turn that has the measured azimuths in its middle
    bool azimuths, elevations;  ///< slices lie on both sides in phi_i, in theta_i

    RglCall(const RglTables& all, const Direction& outgoing)
        : tables(all), normals(all.normals->view()), wo(outgoing) {
        const auto& phi = all.incident.phi;
        const double mean = (phi.front() + phi.back()) / 2;
        if (all.reduction > 1) middle = {std::cos(mean), std::sin(mean), 0};
        turnStart = mean - pi;
        azimuths = !all.isotropic && phi.size() > 1;
        elevations = all.incident.theta.size() > 1;
    }
};

HWY_INLINE void place(const RglCall& call, Lanes x, Lanes y, Lanes z, RglBlock& block,
                      std::size_t k) {
    const RglTables& tables = call.tables;
    const RglFold d(tables.reduction, call.middle, call.wo, x, y, z);
    const Lanes thetaIncident = quadrantAngle(sqrt(d.ix * d.ix + d.iy * d.iy), d.iz);
    const Lanes thetaHalf = quadrantAngle(sqrt(d.hx * d.hx + d.hy * d.hy), d.hz);
    store(sqrt(2 / pi * thetaIncident), block.uIncident + k);
    store(sqrt(2 / pi * thetaHalf), block.uHalf + k);
    if (call.elevations)
        locate(tables.incident.theta, thetaIncident, block.thetaNode + k, block.thetaFraction + k);
    // The azimuth of h, as seen from that of wi where the material is turned with it.
    const bool relative = tables.reduction == 0;
    const Lanes sine = relative ? d.ix * d.hy - d.iy * d.hx : d.hy;
    const Lanes cosine = relative ? d.ix * d.hx + d.iy * d.hy : d.hx;
    store(rayAngle(sine, cosine) * (0.5 / pi) + 0.5, block.vHalf + k);
    if (tables.isotropic) return;
    const Lanes angle = rayAngle(d.iy, d.ix);
    const Lanes phi = angle - 2 * pi * floorOf((angle - call.turnStart) * (0.5 / pi));
    if (call.azimuths) locate(tables.incident.phi, phi, block.phiNode + k, block.phiFraction + k);
    const Lanes v = phi * (0.5 / pi) + 0.5;
    store(v - floorOf(v), block.vIncident + k);
}

/// IncidentGrid::slices of a direction of the block: 1, 2 or 4.
template <int count>
HWY_INLINE void slicesAt(const RglCall& call, const RglBlock& block, std::size_t k,
                         Slices& slices) {
    const auto elevations = static_cast<std::uint32_t>(call.tables.incident.theta.size());
    const auto first = call.elevations ? static_cast<std::uint32_t>(block.thetaNode[k]) : 0;
    slices.index[0] = first;
    slices.weight[0] = 1;
    const int inRow = call.elevations ? 2 : 1;
    if (call.elevations) {
        slices.index[1] = first + 1;
        slices.weight[1] = block.thetaFraction[k];
        slices.weight[0] = 1 - slices.weight[1];
    }
    if (count == inRow) return;
    const auto row = static_cast<std::uint32_t>(block.phiNode[k]) * elevations;
    const double fraction = block.phiFraction[k];
    for (int i = 0; i < inRow; ++i) {
        slices.index[i] += row;
        slices.index[i + inRow] = slices.index[i] + elevations;
        slices.weight[i + inRow] = slices.weight[i] * fraction;
        slices.weight[i] *= 1 - fraction;
    }
}

/// The place in the square of colours: VisibleNormals::invert with a slice's sums in a register.
template <int count>
HWY_INLINE VisibleNormals::Point invert(const VisibleNormals::View& normals, double u, double v,
                                        const Slices& slices) {
    const GridPosition p(u, v, normals.columns, normals.rows);
    const std::size_t cell = p.row * normals.columns + p.column;
    Quad along = {}, across = {};  // {low, before, high, -} and {rowBelow, below, rowAbove, -}
    for (int i = 0; i < count; ++i) {
        const std::size_t slice = slices.index[i];
        const double weight = slices.weight[i] * normals.scale[slice];
        const float* corner =
            normals.vertices + 2 * (slice * normals.rows * normals.columns + cell);
        Quad lower, upper, rows;
        loadQuad(corner, lower);
        loadQuad(corner + 2 * normals.columns, upper);
        loadQuad(normals.rowSums + 2 * (slice * normals.rows + p.row), rows);
        along += weight * (lower + p.b * (upper - lower));
        across += weight * rows;
    }
    const double low = along[0], before = along[1], high = along[2];
    const double rowBelow = across[0], below = across[1], rowAbove = across[2];
    const double whole = rowBelow + p.b * (rowAbove - rowBelow);
    const double part = before + p.a * (low + 0.5 * p.a * (high - low));
    return {.x = whole > 0 ? part / whole : u,
            .y = below + p.b * (rowBelow + 0.5 * p.b * (rowAbove - rowBelow))};
}

/// Spectra::at for three channels. Of two neighbours the second is read from one float before its
/// red on, so that nothing behind the table is touched.
template <int count>
HWY_INLINE void colourAt(const Spectra& spectra, const VisibleNormals::Point& point,
                         const Slices& slices, double factor, double* out, std::size_t stride) {
    const GridPosition p(point.x, point.y, spectra.columns, spectra.rows);
    const std::size_t cell = p.row * spectra.columns + p.column;
    const double w00 = (1 - p.a) * (1 - p.b), w10 = p.a * (1 - p.b);
    const double w01 = (1 - p.a) * p.b, w11 = p.a * p.b;
    Quad left = {}, right = {};
    for (int i = 0; i < count; ++i) {
        const float* corner =
            spectra.values.data() + 3 * (slices.index[i] * spectra.rows * spectra.columns + cell);
        const float* above = corner + 3 * spectra.columns;
        Quad c00, c10, c01, c11;
        loadQuad(corner, c00);
        loadQuad(corner + 2, c10);
        loadQuad(above, c01);
        loadQuad(above + 2, c11);
        left += slices.weight[i] * (w00 * c00 + w01 * c01);
        right += slices.weight[i] * (w10 * c10 + w11 * c11);
    }
    for (int c = 0; c < 3; ++c) {
        const double value = (left[c] + right[c + 1]) * factor;
        out[c * stride] = value > 0 ? value : 0;
    }
}

HWY_INLINE void placeBlock(const RglCall& call, const DirectionBatch& wi, RglBlock& block) {
    const std::size_t lanes = lanesIn<Lanes>();
    Lanes x, y, z;
    std::size_t k = 0;
    for (; k + lanes <= wi.count; k += lanes) {
        load(wi.x + k, x), load(wi.y + k, y), load(wi.z + k, z);
        place(call, x, y, z, block, k);
    }
    if (k == wi.count) return;
    constexpr std::size_t most = HWY_MAX_BYTES / sizeof(double);
    double rest[3][most] = {};
    const double* const axes[] = {wi.x, wi.y, wi.z};
    for (int i = 0; i < 3; ++i) std::copy_n(axes[i] + k, wi.count - k, rest[i]);
    load(rest[0], x), load(rest[1], y), load(rest[2], z);
    place(call, x, y, z, block, k);
}

template <int count>
HWY_INLINE void evalSlices(const RglCall& call, const DirectionBatch& wi, double* out) {
    const RglTables& tables = call.tables;
    const double cosine = std::max(call.wo.z, 1e-9);
    RglBlock block;
    std::fill_n(block.vIncident, RglBlock::size, 0.5);
    Slices slices;
    for (std::size_t begin = 0; begin < wi.count; begin += RglBlock::size) {
        const std::size_t size = std::min(RglBlock::size, wi.count - begin);
        placeBlock(call, {wi.x + begin, wi.y + begin, wi.z + begin, size}, block);
        for (std::size_t k = 0; k < size; ++k) {
            double* to = out + begin + k;
            if (!(wi.z[begin + k] > 0)) {
                for (std::size_t c = 0; c < 3; ++c) to[c * wi.count] = 0;
                continue;
            }
            const double u = block.uHalf[k], v = block.vHalf[k];
            slicesAt<count>(call, block, k, slices);
            const VisibleNormals::Point point = invert<count>(call.normals, u, v, slices);
            double factor = 1 / cosine;
            if (tables.jacobian)
                factor *= tables.ndf.at(u, v) /
                          (4 * tables.sigma.at(block.uIncident[k], block.vIncident[k]));
            colourAt<count>(tables.spectra, point, slices, factor, to, wi.count);
        }
    }
}

void evalRgl(const RglTables& tables, const Direction& wo, DirectionBatch wi, double* out) {
    const RglCall call(tables, wo);
    if (call.azimuths && call.elevations)
        evalSlices<4>(call, wi, out);
    else if (call.azimuths || call.elevations)
        evalSlices<2>(call, wi, out);
    else
        evalSlices<1>(call, wi, out);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
