#include "material_json.h"

#include <nlohmann/json.hpp>

namespace hshfit::jobs {
namespace {

namespace ml = material_library;
using Json = nlohmann::ordered_json;

Json errorJson(const ml::FormError& error) {
    return {{"mean_log", error.meanLog},
            {"log", error.logError},
            {"relative_l2", error.relativeL2},
            {"maximum", error.maximum},
            {"largest", error.largest},
            {"flip", error.flip > 0 ? Json(error.flip) : Json(nullptr)}};
}

}  // namespace

Json materialJson(const ml::Material& material) {
    return {{"name", material.name},
            {"source", material.source},
            {"kind", ml::nameOf(material.kind)},
            {"channels", material.channels},
            {"bytes", material.bytes},
            {"error", errorJson(material.error)},
            {"fallback", material.fallback.empty() ? Json(nullptr) : Json(material.fallback)}};
}

}  // namespace hshfit::jobs
