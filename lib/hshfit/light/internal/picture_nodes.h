#pragma once

#include <hshfit/light/light_nodes.h>

#include <memory>

namespace hshfit::inline light {

/// The nodes of a picture in a domain (light_nodes.h).
void addPictureNodes(const PictureLight& light, const LightDomain& domain, int order, int level,
                     LightNodes& nodes);

/// Solid angles of the pixels' parts in a domain; of layouts other than latlong, whole pixels.
class PictureWeights {
public:
    PictureWeights(const PictureLight& light, const LightDomain& domain);
    ~PictureWeights();
    double solidAngle(std::size_t row, std::size_t column) const;

private:
    struct Kept;
    std::unique_ptr<Kept> kept_;
};

}  // namespace hshfit::inline light
