#pragma once

#include <brdfs/fit/instrument/instrument.h>

#include <cstddef>
#include <vector>

namespace hshfit::brdfs {

/// The instrument after a fit: stated and fitted numbers alike. FitResult::parameters has the
/// errors of the fitted numbers under the names "offset", "dark", "stray", "incidence zero",
/// "detector zero" and "scale N", N the number of the scan from 1 on. The zero of a scan has its
/// number too.
struct FittedInstrument {
    Instrument instrument;             ///< as it was asked for
    std::vector<double> offset, dark;  ///< of each channel; empty: none
    double stray = 0;
    std::vector<double> scales;  ///< of each scan; empty: none
    /// Degrees, of all samples or of each scan; empty: none.
    std::vector<double> incidenceZeros, detectorZeros;
    /// Pairs of directions over which f is averaged, in all, and at most for one sample.
    std::size_t nodes = 0, mostNodes = 0;
    /// The largest relative change of an average, and of the hemisphere's mean for stray light,
    /// by the next level of their quadratures.
    double averageChange = 0, strayChange = 0;
};

}  // namespace hshfit::brdfs
