#pragma once

#include <brdfs/fit/instrument/aperture.h>
#include <brdfs/fit/instrument/slit.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

struct FitSamples;

/// A number of the instrument that is known, or that the fit finds.
struct InstrumentTerm {
    enum class From { nothing, stated, fitted };
    From from = From::nothing;
    double value = 0;
    bool fitted() const { return from == From::fitted; }
};

/// The zero of an angle as a number that the fit finds, one for all samples or one for each scan:
/// normal about 0 with a standard deviation of `width` degrees (turned.h).
struct AngleZero {
    enum class Of { nothing, campaign, scan };
    Of of = Of::nothing;
    double width = 0;
    bool fitted() const { return of != Of::nothing; }
};

/// The cosines by which readings were divided: cos(theta_o), cos(theta_i), or both.
enum class Cosines { scatter, incidence, both };

/// The terms between f and a reading of scan s at one wavelength:
///     a_s ((1 - v) F + v V) + o + d / c
///     F  f averaged over both apertures, weighted by cos(theta_i) cos(theta_o), and over the slit,
///        at the stated directions turned by the zeros of the angles, times the cosines c there
///        over the cosines c at the stated directions
///     V  directional albedo of wi over pi: the mean radiance of the hemisphere
///     v  stray light, the share that reaches the detector from all of the hemisphere
///     o  offset, 1/sr
///     d  dark signal that readings divide by the cosines c, 1/sr
///     a  scale of the scan: log-normal with mean 1 and standard deviation `scaleWidth` of ln a
///        where that is above 0; else 1 for the first scan, and free for the others
/// o and d are one number for each wavelength or colour.
struct Instrument {
    Aperture source, detector;
    double tolerance = 1e-4;  ///< relative, of averages over apertures and of V
    Slit slit;
    InstrumentTerm offset, dark, stray;
    Cosines darkOver = Cosines::scatter;
    bool scales = false;
    double scaleWidth = 0;
    AngleZero incidenceZero, detectorZero;

    bool any() const;
    bool zeros() const { return incidenceZero.fitted() || detectorZero.fitted(); }
    bool averages() const { return source.finite() || detector.finite(); }
};

/// An instrument in words: apertures and slit as parseAperture and parseSlit take them; "fit" or a
/// number for offset, dark and stray; "fit" or a width such as "2%" for the scale of each scan;
/// degrees for the width of a zero, with ":scan" behind it for one for each scan. Behind dark,
/// ":out", ":in" or ":both" names the cosines that readings were divided by (ASTM E2392 divides by
/// the cosine of the scattered direction). Empty: none.
struct InstrumentText {
    std::string source = {}, detector = {}, bandwidth = {}, offset = {}, dark = {}, stray = {},
                scale = {}, incidenceZero = {}, detectorZero = {};
    double tolerance = Instrument().tolerance;

    bool any() const;
};

/// Throws UsageError.
Instrument parseInstrument(const InstrumentText& text);

/// Throws UsageError for samples that are no readings of an instrument, a scale or zero per scan
/// without scans, and a width of scales or zeros without stated uncertainties.
void checkInstrument(const Instrument& instrument, const FitSamples& samples);

/// "out", "in" or "both".
std::string_view nameOf(Cosines cosines);
/// 1 / c.
double overCosines(Cosines cosines, double cosIn, double cosOut);

}  // namespace hshfit::brdfs
