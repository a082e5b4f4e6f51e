#include <hshfit/brdf/transmission.h>

#include <hshfit/error.h>

#include <fmt/format.h>

namespace hshfit::inline brdf {
namespace {

std::string sideText(const Brdf& brdf) {
    const std::string name = brdf.name();
    const std::string_view side = transmissionSide(name);
    return side.empty() ? "a reflection" : fmt::format("a transmission ({})", side);
}

}  // namespace

std::string_view transmissionSide(std::string_view specification) {
    constexpr std::string_view key = "side=";
    for (std::size_t at = specification.find(key); at != std::string_view::npos;
         at = specification.find(key, at + 1)) {
        if (at == 0 || (specification[at - 1] != ':' && specification[at - 1] != ',')) continue;
        for (const std::string_view side : {"transmission-front", "transmission-back"})
            if (specification.substr(at + key.size()).starts_with(side))
                return specification.substr(at + key.size(), side.size());
    }
    return {};
}

std::vector<Lobe> outgoingLobesOf(const Brdf& brdf, const Direction& wi) {
    const auto* known = dynamic_cast<const HasOutgoingLobes*>(&brdf);
    return known ? known->outgoingLobes(wi) : brdf.lobes(wi);
}

void requireReflection(const Brdf& brdf, std::string_view taker) {
    if (!transmits(brdf)) return;
    throw UsageError(
        fmt::format("{}: is a transmission, and {} takes reflections; "
                    "docs/reference/transmission.md says which commands "
                    "take transmissions",
                    brdf.name(), taker));
}

void requireSameSide(const Brdf& a, const Brdf& b) {
    const std::string nameA = a.name(), nameB = b.name();
    if (transmissionSide(nameA) == transmissionSide(nameB)) return;
    throw UsageError(
        fmt::format("{} is {}, but {} is {}; both have to be of the same side (option side)", nameA,
                    sideText(a), nameB, sideText(b)));
}

}  // namespace hshfit::inline brdf
