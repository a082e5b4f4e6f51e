#pragma once

#include <brdfs/fit/correlation_file.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Errors of two values may be correlated: exp(-apart / length), of the outgoing directions of two
/// samples of a scan, of the wavelengths of one, and the product of both; or as a file states.
struct SigmaCorrelation {
    double angle = 0;       ///< length in radians; 0: samples are independent
    double wavelength = 0;  ///< in nm; 0: wavelengths are independent
    std::shared_ptr<const CorrelationBlocks> blocks = {};  ///< in place of lengths

    bool ofAngles() const {
        return angle > 0 || (blocks && blocks->angle.size + blocks->scan.size > 0);
    }
    bool ofWavelengths() const { return wavelength > 0 || (blocks && blocks->wavelength.size > 0); }
    bool any() const { return ofAngles() || ofWavelengths(); }
};

/// The standard uncertainty of each measured value, as somebody states it:
///     formula   sigma^2 = (relative |f|)^2 + absolute^2
///     column    a column of the data file (ASTM: sigma, or sigma_NAME for each channel)
///     file      a companion file: a line of names, then a row for each sample of the data file in
///               its order, those below the horizon included, with commas; the column sigma, or a
///               column for each channel under its name (R, 550nm), and a column scan if there is
///               one
struct SigmaStatement {
    enum class From { nothing, formula, column, file };
    From from = From::nothing;
    double relative = 0, absolute = 0;  ///< absolute in 1/sr
    std::string path;
    std::string text;  ///< as it was stated
    SigmaCorrelation correlation = {};
};

/// "2%", "0.001", "2%+0.001", "column" or "FILE.csv", with ",correlation:angle=3deg" or
/// ",correlation:wavelength=20nm" or both with a comma behind it, or ",covariance=FILE";
/// empty: nothing. Throws UsageError, and InputError for the file.
SigmaStatement parseSigma(std::string_view text);

/// The samples whose errors may be correlated:
///     column     samples of one number in the column scan of the companion file of the
///                uncertainties, or else of the data file (ASTM)
///     incidence  samples of one incident direction
///     runs       so many after one another in the data file
struct ScanStatement {
    enum class From { nothing, column, incidence, runs };
    From from = From::nothing;
    std::size_t length = 0;
    std::string text;  ///< as it was stated
};

/// "column", "incidence" or a number from 1 on; empty: nothing. Throws UsageError.
ScanStatement parseScans(std::string_view text);

}  // namespace hshfit::brdfs
