#pragma once

#include <hshfit/brdf/brdf.h>

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline brdf {

/// A transmission, f_t over the two opposite hemispheres, is a `Brdf` whose outgoing direction is
/// given mirrored at the surface: wo = (x, y, z), z > 0, stands for (x, y, -z) below it, and wi is
/// above. Light that goes straight on is at mirrored(wi), as a mirror's is, so that maps of
/// outgoing directions, bases and half vectors serve both. Its integrals over wo are
/// transmittances. It has no law of exchange: f_t(wi, wo) and f_t(wo, wi) are light from the same
/// side, while Helmholtz reciprocity relates light from one side to light from the other.
///
/// The name of a transmission states its side: the option `side=transmission-front` or
/// `side=transmission-back` of a specification, which every form, file and sum of it keeps.

/// "transmission-front" or "transmission-back", as the specification states it; else "".
std::string_view transmissionSide(std::string_view specification);

/// Whether the name of the BRDF states a transmission.
inline bool transmits(const Brdf& brdf) {
    return !transmissionSide(brdf.name()).empty();
}

/// (x, y, -z): the direction below the surface that an outgoing direction of a transmission stands
/// for, and back.
inline Direction throughSurface(const Direction& d) {
    return {d.x, d.y, -d.z};
}

/// A BRDF whose peaks over wo for a wi are elsewhere than its peaks over wi for a wo (Brdf::lobes),
/// as refraction has them.
class HasOutgoingLobes {
public:
    virtual std::vector<Lobe> outgoingLobes(const Direction& wi) const = 0;

protected:
    ~HasOutgoingLobes() = default;
};

/// The lobes of a BRDF that does not say: the ones over wi, which are right where f is about the
/// mirror direction.
std::vector<Lobe> outgoingLobesOf(const Brdf& brdf, const Direction& wi);

/// Throws UsageError, in one line, for a transmission: `taker`, such as "merl", needs a reflection.
void requireReflection(const Brdf& brdf, std::string_view taker);

/// Throws UsageError unless both are reflections, or transmissions of light from the same side.
void requireSameSide(const Brdf& a, const Brdf& b);

}  // namespace hshfit::inline brdf
