#include "project.h"

#include <jobs/common/option_words.h>
#include <jobs/common/shared_options.h>

namespace hshfit::jobs {
namespace {

using options::at;

/// The most of any basis (bases::Entry::maxOrder), which its maker holds to.
constexpr Bounds<int> orders{1, 2801};

constexpr OptionRow projectRows[] = {
    OptionRow{"basis", at<&ProjectOptions::basis>, "See hshfit list bases"}.takes(
        {.words = basisWords}),
    OptionRow{"order", at<&ProjectOptions::order>,
              "Number of bands: l = 0 .. order-1; some bases have fewer"}
        .within(orders),
    OptionRow{"outgoing", at<&ProjectOptions::outgoing>,
              "WxH (parabolic map), N (elevations, isotropic) or THETA,PHI in degrees"}
        .takes({.syntax = Syntax::outgoing})
        .byDefault("32 if isotropic, else 32x32"),
    rgbRow(at<&ProjectOptions::rgb>),
    OptionRow{"cosine", at<&ProjectOptions::cosine>, "Project f cos(theta_i) instead of f"},
    OptionRow{"condon-shortley", at<&ProjectOptions::condonShortley>,
              "Give functions of odd m the Condon-Shortley sign"},
    toleranceRow(at<&ProjectOptions::tolerance>),
    evaluationsRow(at<&ProjectOptions::maxEvaluations>),
    OptionRow{"least-squares", at<&ProjectOptions::leastSquares>,
              "Fit scattered samples themselves, not the interpolation between them"},
    OptionRow{"regularise", at<&ProjectOptions::regularise>,
              "With --least-squares: Tikhonov weight, relative to the system's own scale"}
        .within(bounds::regularise),
    OptionRow{"kernel", at<&ProjectOptions::kernel>,
              "With --least-squares: degrees about an outgoing direction that count at most"}
        .within(bounds::kernel),
};

}  // namespace

OptionRows<ProjectOptions> projectOptions() {
    return {projectRows};
}

}  // namespace hshfit::jobs
