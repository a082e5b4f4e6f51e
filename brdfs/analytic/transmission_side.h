#pragma once

#include <brdfs/rows/spec.h>

#include <string>

namespace hshfit::brdfs {

/// The option `side` of a model of transmission: the side of the incident light.
inline Parameter transmissionSideParameter(std::string_view help) {
    return {.name = "side",
            .help = help,
            .kind = Parameter::Kind::choice,
            .choices = {"transmission-front", "transmission-back"}};
}

/// The name with its side, which a transmission always states (hshfit/brdf/transmission.h).
inline std::string withSide(const std::string& name, const Parameters& parameters) {
    if (parameters.choice("side") != "transmission-front") return name;
    return name + (name.find(':') == std::string::npos ? ":" : ",") + "side=transmission-front";
}

}  // namespace hshfit::brdfs
