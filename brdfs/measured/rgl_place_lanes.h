// Positions of directions in the tables of an RGL file, as many at a time as a register holds.
// Included by rgl_eval_lanes.h once for each instruction set.

#include <brdfs/lanes/lanes_batch.h>
#include <brdfs/measured/angle_lanes.h>
#include <brdfs/measured/rgl.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// The positions of a block of directions in the tables.
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

/// Parameters common to all directions of a call.
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
    // The azimuth of h, relative to the azimuth of wi where the tables turn with wi.
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

HWY_INLINE void placeBlock(const RglCall& call, const DirectionBatch& wi, RglBlock& block) {
    forEachLanes(wi, [&](Lanes x, Lanes y, Lanes z, std::size_t k)
                         HWY_ATTR { place(call, x, y, z, block, k); });
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
