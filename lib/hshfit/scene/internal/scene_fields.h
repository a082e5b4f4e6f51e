#pragma once

#include <hshfit/files/json_fields.h>
#include <hshfit/light/lights.h>
#include <hshfit/scene/scene.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::scene {

using Keys = std::vector<std::string_view>;

/// Fails for a key beside the valid ones.
void onlyKeys(const JsonFields& fields, const Keys& valid);
[[noreturn]] void failWord(const JsonFields& fields, const char* key, const Keys& valid);

/// A number within [low, high].
double numberIn(const JsonFields& fields, const char* key, double low, double high);
/// Degrees within [low, high], as radians.
double angle(const JsonFields& fields, const char* key, double low, double high);
double angleOr0(const JsonFields& fields, const char* key, double low, double high);
/// One number for grey, or three; radiance from 0 to 1e9.
Rgb colour(const JsonFields& fields, const char* key);
/// Elements of an array; at least one.
std::vector<JsonFields> elements(const JsonFields& fields, const char* key);
/// "name", which files are named after: letters, digits, '-', '_', '.'.
std::string nameOf(const JsonFields& fields);
/// A path beside the scene file, or an absolute one.
std::string placeOf(const std::string& file, const std::string& scene);

constexpr double brightest = 1e9;

/// The object of one element of "objects", and the camera of one of "cameras".
Object objectOf(const JsonFields& fields, const std::vector<Material>& materials,
                const std::string& scene);
Camera cameraOf(const JsonFields& fields);

/// The lights of one element of "lights": one, or by its specification several.
std::vector<Light> lightsOf(const JsonFields& fields, const std::string& scene);

}  // namespace hshfit::scene
