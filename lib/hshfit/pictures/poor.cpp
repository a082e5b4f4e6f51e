#include <hshfit/pictures/poor.h>

#include <hshfit/percent.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::inline pictures {

std::optional<std::string> poorReason(const std::optional<double>& captured,
                                      const std::optional<PictureError>& error,
                                      const PoorBounds& bounds) {
    if (captured && !(*captured >= bounds.captured))
        return *captured > 0 ? fmt::format("{} of the energy is captured", percent(*captured))
                             : fmt::format("the error is {} of f (relative L2)",
                                           percent(std::sqrt(1 - *captured)));
    if (!error) return std::nullopt;
    const bool dips = error->dip.value >= error->peak.value;
    const SeenDifference& extremum = dips ? error->dip : error->peak;
    if (extremum.value > bounds.extremum)
        return fmt::format("a false {} of {} in the highlight", dips ? "dip" : "peak",
                           percent(extremum.value, 2));
    if (error->flip.mean > bounds.flip)
        return fmt::format("pictures differ by FLIP {:.2g}, most under the light \"{}\"",
                           error->flip.mean, error->flip.light);
    return std::nullopt;
}

}  // namespace hshfit::inline pictures
