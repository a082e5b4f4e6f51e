#include <brdfs/analytic/facet_text.h>

#include <utility>

namespace hshfit::embedded {
extern const std::string_view facet_axes, facet_density, facet_terms;
}  // namespace hshfit::embedded

namespace hshfit::brdfs {

FacetText facetText(std::vector<FacetText::Number> numbers, std::vector<std::string> flags) {
    return {.axes = embedded::facet_axes,
            .density = embedded::facet_density,
            .terms = embedded::facet_terms,
            .numbers = std::move(numbers),
            .flags = std::move(flags)};
}

}  // namespace hshfit::brdfs
