#pragma once

#include <hshfit/transport/radiance_cache/incoming_functions.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

/// The hemisphere in rings times azimuths of equal solid angle, or of equal projected solid angle
/// where the functions have the cosine, with the functions at the edges between them: by these,
/// the edges' motion gives the gradient of coefficients (Ward & Heckbert 1992, here for any
/// functions). Cell j * azimuths + k lies in ring j, counted from the pole. Immutable.
class HemisphereStrata {
public:
    /// At most `rays` cells, about pi times as many azimuths as rings. Throws UsageError below 4.
    /// `bends` are kept if asked for.
    HemisphereStrata(const IncomingFunctions& functions, int rays, bool bends = false);

    std::size_t rings() const { return rings_; }
    std::size_t azimuths() const { return azimuths_; }
    std::size_t cells() const { return rings_ * azimuths_; }
    /// The measure of a cell: solid angle, or projected solid angle.
    double measure() const;
    bool cosine() const { return cosine_; }

    /// A direction of a cell for x and y in [0, 1), uniform in the measure.
    Direction direction(std::size_t cell, double x, double y) const;
    double azimuthAt(std::size_t k, double y) const;

    /// Per unit of motion and per difference of radiance over an edge that a unit's distance away:
    /// the functions' share of the edge towards the ring before (none for ring 0) and towards the
    /// azimuth before.
    const float* ringEdge(std::size_t cell) const { return ringEdges_.data() + cell * size_; }
    const float* azimuthEdge(std::size_t cell) const { return azimuthEdges_.data() + cell * size_; }
    bool bends() const { return !ringBends_.empty(); }
    /// Per unit of motion squared and per difference of radiance over an edge that a unit's
    /// distance away: the second derivatives xx, xy and yy, [derivative][function] (record.h).
    const float* ringBend(std::size_t cell) const { return ringBends_.data() + 3 * cell * size_; }
    const float* azimuthBend(std::size_t cell) const {
        return azimuthBends_.data() + 3 * cell * size_;
    }
    /// The integral of each function: coefficients of radiance 1.
    const std::vector<float>& ofOne() const { return ofOne_; }

private:
    double polarAngleAt(double ring) const;

    std::size_t rings_, azimuths_, size_;
    bool cosine_;
    std::vector<float> ringEdges_, azimuthEdges_, ringBends_, azimuthBends_, ofOne_;
};

}  // namespace hshfit::inline transport::inline radiance_cache
