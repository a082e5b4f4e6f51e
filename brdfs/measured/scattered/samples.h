#pragma once

#include <brdfs/measured/measured_brdf.h>
#include <brdfs/measured/mueller.h>
#include <brdfs/measured/scattered/chart.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/error.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The position of a sample in its file, for messages: "PATH: line N: …".
struct Row {
    const std::string& where;
    std::string_view unit;  ///< "line" or "sample"
    std::size_t number;

    InputError error(std::string_view message) const;
};

/// Measured pairs of directions with f in 1/sr for each, as a reader found them in a file.
struct Samples {
    std::vector<Direction> wi, wo;
    std::vector<double> values;  ///< [sample * channels.count() + channel]
    Channels channels;
    /// The coordinates of data with fewer of them than a pair has. A sample then stands for all
    /// pairs with its coordinates. Chart::anisotropic stands for full pairs.
    Chart chart = Chart::anisotropic;
    bool isotropic = false;  ///< as stated in the file
    /// The value of the option `side` (sides.h); empty for formats of reflections alone.
    std::string_view side = {};
    /// Values of others than M_00 are below 0 too, and neither exchange nor mirror holds for them.
    MuellerElements elements;
    Census census;
    std::vector<Fact> facts;           ///< the format and the facts of its header
    std::vector<std::string> leftOut;  ///< parts of the file that are not read
    /// The line (or number) in the file of each value, [sample * channels.count() + channel].
    std::vector<std::size_t> rows;
    /// The place of each sample among the `read` ones of the file, those below the horizon
    /// included.
    std::vector<std::size_t> order;
    std::size_t read = 0;
    /// Where the file states them: standard uncertainties of the values, as `values`, and a number
    /// for the scan of each sample.
    std::vector<double> sigmas, scans;

    std::size_t size() const { return wi.size(); }

    /// Appends a sample, or only counts it if one of its directions is below the horizon (by more
    /// than 1e-6 in z). Values below zero are kept and counted. Throws InputError for a value that
    /// is no finite number.
    void add(const Direction& in, const Direction& out, std::span<const double> f, const Row& row);
    /// Multiplies values and their uncertainties, and what the census says of them.
    void scale(double factor);
    /// Counts a sample among those below the horizon. Throws likewise.
    void leaveOut(std::span<const double> f, const Row& row);

private:
    void count(std::span<const double> f, const Row& row);
};

/// Checks a polar angle of a file, in radians. Throws InputError, with the name of the field,
/// for NaN, infinity, and angles more than 1e-3 above pi/2, which are most likely in degrees.
/// Negative angles are on the other side of the normal.
double checkedPolarAngle(double theta, const Row& row, std::string_view field);
/// Checks a polar angle up to pi likewise: beyond pi/2 it is on the back of the surface.
double checkedSidedAngle(double theta, const Row& row, std::string_view field);
/// Checks an azimuth in the same way, with a limit of two turns.
double checkedAzimuth(double phi, const Row& row, std::string_view field);

}  // namespace hshfit::brdfs
