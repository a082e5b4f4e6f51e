#pragma once

// The least and the largest value of options that more than one front end takes: the command line
// and Python read them here.

namespace hshfit::jobs {

/// Both ends are allowed.
template <class Number>
struct Bounds {
    Number least, most;
};

namespace bounds {

// Projection and curves.
inline constexpr Bounds<double> tolerance{1e-13, 1}, evaluations{1e3, 1e12};
inline constexpr Bounds<double> regularise{0, 1e3}, kernel{0.1, 180};
inline constexpr Bounds<int> curveOrders{1, 1000};

// Fits.
inline constexpr Bounds<int> starts{1, 10000}, iterations{1, 100000};
inline constexpr Bounds<double> grazingCut{0, 90}, robustScale{0, 1e300};

// Bases: figures, matrices, rotation.
inline constexpr Bounds<int> plotOrder{1, 8}, matrixOrder{1, 2048};
inline constexpr Bounds<double> rotationTolerance{1e-12, 1};
inline constexpr Bounds<int> rotationTables{2, 10001};

// Light.
inline constexpr Bounds<int> lightOrder{1, 1000}, irradianceOrder{1, 100}, normals{16, 1000000};

// Samples of a BRDF.
inline constexpr Bounds<int> sampleCount{0, 10000000}, sampleElevations{0, 1000},
    sampleTrials{1, 100000000};

// Pictures.
inline constexpr Bounds<int> pictureSize{8, 4096}, pictureSamples{1, 16};
inline constexpr Bounds<double> dome{0, 1e6}, fieldOfView{0.1, 170}, pictureTolerance{1e-6, 0.5};
inline constexpr Bounds<double> seconds{0.01, 1e7};

// Scenes: global illumination, precomputed transfer, plans.
inline constexpr Bounds<int> pathSamples{1, 1 << 24}, mostBounces{0, 1000000},
    fewestBounces{0, 1000};
inline constexpr Bounds<int> cacheRays{4, 1 << 24};
inline constexpr Bounds<double> cacheLoss{0, 1};
inline constexpr Bounds<int> passes{0, 100000}, transferRays{1, 1 << 24}, transferOrder{1, 16},
    localOrder{0, 16}, clusters{0, 4096}, components{0, 64}, referenceSamples{0, 1 << 20};
inline constexpr Bounds<double> clusterError{1e-9, 10}, transferMemory{1e-3, 1e9};
inline constexpr Bounds<int> planOrder{1, 32};

// Forms and their trade.
inline constexpr Bounds<int> tradeOrders{1, 1000}, tradeRanks{0, 1000}, pairCount{256, 1 << 24};

// Maps of materials; memory in MiB.
inline constexpr Bounds<int> mapOrder{1, 32}, mapRank{1, 4096}, mapHarmonics{3, 101},
    mapClusters{1, 65536}, mapChecks{0, 4096}, mapMemory{16, 1 << 20};
inline constexpr Bounds<double> mapTolerance{1e-6, 0.1}, mapError{1e-6, 1};

}  // namespace bounds
}  // namespace hshfit::jobs
