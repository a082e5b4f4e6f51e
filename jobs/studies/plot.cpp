#include "plot.h"

#include <hshfit/bases/catalog.h>

#include <algorithm>

namespace hshfit::jobs {

Plotted plot(const std::string& basis, const std::string& output, const PlotOptions& options) {
    const bases::Entry& entry = bases::find(basis);
    const int order = std::min(options.order, entry.maxOrder);
    const auto made = bases::make(entry.name, order, {.condonShortley = options.condonShortley});
    writeBasisFigure(*made, options.domain, output);
    return {made->name(), order, made->functionCount(order)};
}

}  // namespace hshfit::jobs
