// RglBrdf::eval for RGB, included by rgl.cpp once for each instruction set. Angles are computed for
// as many directions as a register holds. Table entries for one direction are adjacent and
// loaded into one register too: density and integral of two vertices, the sums of two rows, a
// colour.

#include <brdfs/measured/rgl_place_lanes.h>

#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// Four doubles from four floats of a table, in one register or two.
using Quad [[gnu::vector_size(32)]] = double;
using FloatQuad [[gnu::vector_size(16)]] = float;

HWY_INLINE void loadQuad(const float* from, Quad& to) {
#if HWY_MAX_BYTES >= 32  // the compiler's code for the conversion below goes through memory
    const hn::FixedTag<double, 4> doubles;
    hn::StoreU(hn::PromoteTo(doubles, hn::LoadU(hn::FixedTag<float, 4>(), from)), doubles,
               reinterpret_cast<double*>(&to));
#else
    FloatQuad floats;
    std::memcpy(&floats, from, sizeof floats);
    to = __builtin_convertvector(floats, Quad);
#endif
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

/// Spectra::at for three channels. The second of two neighbours is read from one float before
/// its red on, so that no read goes beyond the table.
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
