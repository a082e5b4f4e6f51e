#include "picture.h"

#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/representation/forms/represented_brdf.h>

namespace hshfit::jobs {

bool hasOneDirection(const Brdf& brdf) {
    const auto isOne = [](const OutgoingSet& set) {
        return !set.directions.empty() && set.map == OutgoingSet::Map::direction;
    };
    if (const auto* r = dynamic_cast<const Reconstruction*>(&brdf))
        return isOne(r->coefficients().outgoing);
    const auto* r = dynamic_cast<const RepresentedBrdf*>(&brdf);
    return r && isOne(r->representation().head.outgoing);
}

std::optional<PictureError> pictureErrorOf(const Brdf& f, const Brdf& g) {
    if (hasOneDirection(f) || hasOneDirection(g)) return std::nullopt;
    if (f.channels().kind == Channels::Kind::named) return std::nullopt;
    return pictureError(f, g);
}

}  // namespace hshfit::jobs
