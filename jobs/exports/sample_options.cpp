#include "sample.h"

namespace hshfit::jobs {
namespace {

using options::at;
using options::spelled;

std::vector<Word> methodWords() {
    return {{"auto", "the model's own; else proposal and table"},
            {"table"},
            {"proposal", "two fitted GGX lobes"},
            {"stored", "the proposal of an export"},
            {"cosine"}};
}

Direction sampledDirection(const std::string& text) {
    return anglesIn(text, "SampleOptions::outgoing").direction();
}

constexpr OptionRow sampleRows[] = {
    OptionRow{"outgoing",
              spelled<sampledDirection, options::untold<Direction>, &SampleOptions::outgoing>,
              "Outgoing direction THETA,PHI, degrees"}
        .takes({.syntax = Syntax::numbers})
        .byDefault("45,0"),
    OptionRow{"count", at<&SampleOptions::count>, "Directions to draw"}.within(bounds::sampleCount),
    OptionRow{"method", spelled<sampleMethod, sampleMethodName, &SampleOptions::method>,
              "Densities to draw from: auto (the model's own; else proposal and table), table, "
              "proposal (two fitted GGX lobes), stored (the proposal of an export, as its shaders "
              "draw) or cosine"}
        .takes({.words = methodWords}),
    OptionRow{"seed", at<&SampleOptions::seed>, "Seed of the random numbers"},
    OptionRow{"elevations", at<&SampleOptions::elevations>,
              "Outgoing elevations in the efficiency report"}
        .within(bounds::sampleElevations),
    OptionRow{"trials", at<&SampleOptions::trials>,
              "Samples that each row of the report is measured with"}
        .within(bounds::sampleTrials),
};

}  // namespace

OptionRows<SampleOptions> sampleOptions() {
    return {sampleRows};
}

}  // namespace hshfit::jobs
