#include "plot.h"

#include <hshfit/bases/catalog.h>

#include <algorithm>

namespace hshfit::jobs {
namespace {

constexpr OptionRow plotRows[] = {
    OptionRow{"order", options::at<&PlotOptions::order>, "Bands to draw"}.within(bounds::plotOrder),
    OptionRow{"sphere", options::at<&PlotOptions::sphere>,
              "The whole sphere, for sh and esh (default: the hemisphere)"},
    OptionRow{"condon-shortley", options::at<&PlotOptions::condonShortley>,
              "Functions of odd m times -1, as both source papers have them"},
};

}  // namespace

OptionRows<PlotOptions> plotOptions() {
    return {plotRows};
}

Plotted plot(const std::string& basis, const std::string& output, const PlotOptions& options) {
    const bases::Entry& entry = bases::find(basis);
    const int order = std::min(options.order, entry.maxOrder);
    const auto made = bases::make(entry.name, order, {.condonShortley = options.condonShortley});
    writeBasisFigure(*made, options.domain(), output);
    return {made->name(), order, made->functionCount(order)};
}

}  // namespace hshfit::jobs
