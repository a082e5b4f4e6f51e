#pragma once

#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <vector>

// Klems patches, implemented independently of the reader.

namespace hshfit::test {

struct KlemsRing {
    double lower, upper;
    int azimuths;
};

inline const std::vector<KlemsRing> klemsFull{{0, 5, 1},    {5, 15, 8},   {15, 25, 16},
                                              {25, 35, 20}, {35, 45, 24}, {45, 55, 24},
                                              {55, 65, 24}, {65, 75, 16}, {75, 90, 12}};
inline const std::vector<KlemsRing> klemsHalf{{0, 6.5, 1},      {6.5, 19.5, 8},   {19.5, 32.5, 12},
                                              {32.5, 45.5, 16}, {45.5, 58.5, 20}, {58.5, 71.5, 12},
                                              {71.5, 90, 8}};
inline const std::vector<KlemsRing> klemsOldHalf{
    {0, 6.5, 1},      {6.5, 19.5, 8},   {19.5, 32.5, 12}, {32.5, 46.5, 16},
    {46.5, 61.5, 20}, {61.5, 76.5, 12}, {76.5, 90, 4}};
inline const std::vector<KlemsRing> klemsQuarter{
    {0, 9, 1}, {9, 27, 8}, {27, 45, 12}, {45, 63, 12}, {63, 90, 8}};

inline int patchesOf(const std::vector<KlemsRing>& rings) {
    int sum = 0;
    for (const KlemsRing& ring : rings) sum += ring.azimuths;
    return sum;
}

/// The patch whose centre is nearest in azimuth within the ring of elevation; -1: none.
inline int patchAt(const std::vector<KlemsRing>& rings, double x, double y, double z) {
    const double theta = degrees(std::acos(std::min(z, 1.0)));
    const double phi = degrees(std::atan2(y, x));
    int first = 0;
    for (const KlemsRing& ring : rings) {
        if (theta >= ring.lower && theta < ring.upper) {
            int best = 0;
            double nearest = 1000;
            for (int j = 0; j < ring.azimuths; ++j) {
                const double away = std::abs(std::remainder(phi - 360.0 * j / ring.azimuths, 360));
                if (away < nearest) nearest = away, best = j;
            }
            return first + best;
        }
        first += ring.azimuths;
    }
    return -1;
}

/// Integral of cos(theta) over each patch.
inline std::vector<double> projectedSolidAngles(const std::vector<KlemsRing>& rings) {
    std::vector<double> result;
    for (const KlemsRing& ring : rings) {
        const double up = std::sin(radians(ring.upper)), low = std::sin(radians(ring.lower));
        for (int j = 0; j < ring.azimuths; ++j) {
            result.push_back(pi * (up - low) * (up + low) / ring.azimuths);
        }
    }
    return result;
}

}  // namespace hshfit::test
