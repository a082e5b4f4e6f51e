#pragma once

#include <jobs/common/inputs.h>
#include <jobs/common/listener.h>
#include <jobs/fits/figures.h>

#include <hshfit/accuracy/metrics.h>
#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/pictures/picture_error.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct CompareOptions {
    std::string metrics = "all";  ///< or names, separated by commas
    /// OutgoingSet::parse; empty: as the coefficients have them, else as in outgoingOrDefault.
    std::string outgoing = {};
    bool rgb = false;                           ///< wavelengths as linear Rec. 709
    std::optional<FigureOptions> figures = {};  ///< for print; none: not drawn
    /// Standard uncertainty of the reference's samples, for bars in figures: brdfs::parseSigma.
    std::string sigma = {};
};
OptionRows<CompareOptions> compareOptions();

/// The metrics asked for over the measured pairs of the reference alone, each counted once. Metrics
/// that need more than samples have no value.
struct AtSamples {
    std::size_t count = 0;  ///< pairs
    std::vector<MetricValue> metrics = {};
};

struct Compared {
    std::string a, b;  ///< names of the BRDFs
    OutgoingSet outgoing;
    std::vector<MetricValue> metrics = {};
    /// Over both hemispheres, whereas the outgoing set leaves out the horizon. None where the
    /// channels differ or `a` is not finite.
    std::optional<PairSummary> pairs = {};
    /// Where the reference is made of scattered samples, between which it is interpolated and
    /// beyond which it is 0.
    std::optional<AtSamples> samples = {};
    std::optional<PictureError> picture = {};  ///< pictureErrorOf
    std::string undrawn = {};             ///< a channel that is no reflectance, if there is one
    std::vector<std::string> files = {};  ///< of the page, where one was asked for
    FigureFiles figures = {};
};

/// Errors of the approximation `b` against the reference `a`, sources as in openSource. `output`
/// is a folder for a page with figures and spheres, or empty. A metric without a value has the
/// reason. Throws UsageError, InputError and OutputError.
Compared compare(const std::string& a, const std::string& b, const std::string& output,
                 const CompareOptions& options, const Listener& listener = {});

/// The comparisons of several, in the order of their names.
struct ManyCompared {
    std::vector<std::string> names = {};                ///< nameOf the approximation
    std::vector<std::string> folders = {};              ///< of their pages; empty: none
    std::vector<std::optional<Compared>> results = {};  ///< none where one failed
    std::vector<InputFailure> failures = {};            ///< also of inputs without a partner
    std::vector<std::string> kept = {};                 ///< folders whose page stands and is valid
};

/// One reference against each of `others`, or, where `a` is a folder or a pattern, its files
/// against files of the same name in the only one of `others`. Folders stand for their measured
/// files and coefficient files. Pages go to OUTPUT/NAME. A failure does not stop the rest. Throws
/// UsageError, also for names that come twice, InputError where no names agree, and OutputError.
ManyCompared compareMany(const std::string& a, const std::vector<std::string>& others,
                         const std::string& output, const CompareOptions& options,
                         const Listener& listener = {});
/// Writes the table of all as CSV: a row for each pair, with the value and the error of each
/// metric, and FLIP, false dip and false peak of the picture error. An earlier table is replaced,
/// any other file is not. Throws OutputError.
void writeComparisonTable(const ManyCompared& many, const std::string& path);

/// Compares BRDFs that are open; `rgb` is not used.
Compared compareBrdfs(const Brdf& a, const Brdf& b, const std::string& output,
                      const CompareOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
