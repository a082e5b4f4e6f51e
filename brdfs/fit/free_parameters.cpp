#include <brdfs/fit/free_parameters.h>

#include <brdfs/spec.h>
#include <hshfit/error.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

enum class When { always, isotropic, anisotropic };

/// A free parameter of a model: keys joined by '=', where starts are drawn, on which scale, for
/// which data, and which choice has to stand ("fresnel=dielectric"; empty: any).
struct Row {
    std::string_view model, keys;
    double startLow, startHigh;
    bool logarithmic = false;
    When when = When::always;
    std::string_view choice = {};
};

constexpr auto iso = When::isotropic, aniso = When::anisotropic;

// One line a row. Starts cover what published fits have; bounds are those of the model.
// clang-format off
constexpr Row rows[] = {
    {"lambert", "kd", 0, 1},
    {"oren-nayar", "kd", 0, 1},
    {"oren-nayar", "sigma", 5, 60},
    {"eon", "kd", 0.05, 0.9},
    {"eon", "roughness", 0.1, 0.9},
    {"openpbr-diffuse", "base_color", 0.05, 0.9},
    {"openpbr-diffuse", "base_diffuse_roughness", 0.1, 0.9},
    {"minnaert", "kd", 0, 1},
    {"minnaert", "k", 0.1, 3},
    {"phong", "kd", 0, 1},
    {"phong", "ks", 0, 1},
    {"phong", "exponent", 1, 3e3, true},
    {"blinn-phong", "kd", 0, 1},
    {"blinn-phong", "ks", 0, 1},
    {"blinn-phong", "exponent", 1, 2e4, true},
    {"lafortune", "kd", 0, 1},
    {"lafortune", "ks", 0, 1},
    {"lafortune", "Cy", -1.5, 1.5, false, aniso},
    {"lafortune", "Cz", 0.3, 1.5},
    {"lafortune", "exponent", 1, 1e3, true},
    {"ward", "kd", 0, 1},
    {"ward", "ks", 0, 1},
    {"ward", "ax=ay", 3e-3, 0.7, true, iso},
    {"ward", "ax", 3e-3, 0.7, true, aniso},
    {"ward", "ay", 3e-3, 0.7, true, aniso},
    {"ashikhmin-shirley", "kd", 0, 1},
    {"ashikhmin-shirley", "ks", 0, 1},
    {"ashikhmin-shirley", "Rs", 0.01, 0.9},
    {"ashikhmin-shirley", "nu=nv", 1, 1e5, true, iso},
    {"ashikhmin-shirley", "nu", 1, 1e5, true, aniso},
    {"ashikhmin-shirley", "nv", 1, 1e5, true, aniso},
    {"cook-torrance", "kd", 0, 1},
    {"cook-torrance", "ks", 0, 1},
    {"cook-torrance", "F0", 0.005, 0.95},
    {"cook-torrance", "m", 3e-3, 0.7, true},
    {"he", "kd", 0, 1},
    {"he", "ks", 0, 1},
    {"he", "sigma", 0.02, 2, true},
    {"he", "tau", 0.3, 100, true},
    {"he", "ior", 1.05, 4, true},
    {"abc", "kd", 0, 1},
    {"abc", "A", 0, 1},
    {"abc", "B", 10, 1e7, true},
    {"abc", "C", 0.1, 4, true},
    {"abc", "ior", 1.05, 4, true},
    {"sgd", "kd", 0, 1},
    {"sgd", "ks", 0, 1},
    {"sgd", "alpha", 1e-4, 0.5, true},
    {"sgd", "p", 0.05, 1.5},
    {"sgd", "Lambda", 0.3, 8},
    {"sgd", "c", 1e-7, 1, true},
    {"sgd", "k", 5, 60, true},
    {"sgd", "theta0", -0.4, 0.6},
    {"sgd", "F0", 0.02, 1},
    {"sgd", "F1", -0.2, 0.2},
    {"beckmann", "kd", 0, 1},
    {"beckmann", "F0", 0.02, 0.9, false, When::always, "fresnel=schlick"},
    {"beckmann", "ior", 1.05, 4, true, When::always, "fresnel=dielectric"},
    {"beckmann", "ior", 0.2, 4, true, When::always, "fresnel=conductor"},
    {"beckmann", "k", 0.5, 6, false, When::always, "fresnel=conductor"},
    {"beckmann", "alpha", 3e-3, 0.7, true, iso},
    {"beckmann", "ax", 3e-3, 0.7, true, aniso},
    {"beckmann", "ay", 3e-3, 0.7, true, aniso},
    {"ggx", "kd", 0, 1},
    {"ggx", "F0", 0.02, 0.9, false, When::always, "fresnel=schlick"},
    {"ggx", "ior", 1.05, 4, true, When::always, "fresnel=dielectric"},
    {"ggx", "ior", 0.2, 4, true, When::always, "fresnel=conductor"},
    {"ggx", "k", 0.5, 6, false, When::always, "fresnel=conductor"},
    {"ggx", "alpha", 3e-3, 0.7, true, iso},
    {"ggx", "ax", 3e-3, 0.7, true, aniso},
    {"ggx", "ay", 3e-3, 0.7, true, aniso},
    {"gtr", "kd", 0, 1},
    {"gtr", "F0", 0.02, 0.9, false, When::always, "fresnel=schlick"},
    {"gtr", "ior", 1.05, 4, true, When::always, "fresnel=dielectric"},
    {"gtr", "ior", 0.2, 4, true, When::always, "fresnel=conductor"},
    {"gtr", "k", 0.5, 6, false, When::always, "fresnel=conductor"},
    {"gtr", "alpha", 3e-3, 0.7, true},
    {"gtr", "gamma", 1, 4, true},
    {"disney", "baseColor", 0.05, 0.9},
    {"disney", "subsurface", 0.1, 0.9},
    {"disney", "metallic", 0.1, 0.9},
    {"disney", "specular", 0.1, 0.9},
    {"disney", "roughness", 0.05, 0.9},
    {"disney", "anisotropic", 0.1, 0.9, false, aniso},
    {"disney", "sheen", 0.1, 0.9},
    {"disney", "clearcoat", 0.1, 0.9},
    {"disney", "clearcoatGloss", 0.1, 0.9},
    {"charlie", "ks", 0, 1},
    {"charlie", "r", 0.05, 0.95},
    {"sg", "kd", 0, 1},
    {"sg", "ks", 0, 1},
    {"sg", "sharpness", 1, 1e4, true},
};
// clang-format on

const Parameter& declared(const Model& model, std::string_view key) {
    return *std::ranges::find(model.parameters, key, &Parameter::name);
}

bool applies(const Row& row, const Parameters& stated, const Model& model, bool isotropic) {
    if (row.model != model.name) return false;
    if (row.when == iso && !isotropic) return false;
    if (row.when == aniso && isotropic) return false;
    if (row.choice.empty()) return true;
    const std::size_t equals = row.choice.find('=');
    const std::string_view key = row.choice.substr(0, equals);
    const auto found = stated.words.find(key);
    const std::string_view word =
        found != stated.words.end() ? found->second : declared(model, key).choices.front();
    return word == row.choice.substr(equals + 1);
}

std::vector<std::string> split(std::string_view keys) {
    std::vector<std::string> parts;
    for (std::size_t start = 0; start <= keys.size();) {
        const std::size_t end = std::min(keys.find('=', start), keys.size());
        parts.emplace_back(keys.substr(start, end - start));
        start = end + 1;
    }
    return parts;
}

/// Starts are drawn within a factor of 30 of 1, or within the bounds if these are closer.
FreeParameter unlisted(const Parameter& parameter) {
    FreeParameter result{.keys = {std::string(parameter.name)},
                         .min = parameter.min,
                         .max = parameter.max,
                         .colour = parameter.kind == Parameter::Kind::colour};
    result.logarithmic = parameter.min > 0 && parameter.max > 100 * parameter.min;
    result.startLow = std::max(parameter.min, result.logarithmic ? 1 / 30. : -30.);
    result.startHigh = std::min(parameter.max, 30.);
    return result;
}

bool leavesOut(const Parameter& parameter) {
    const bool outside = parameter.fallback && (*parameter.fallback < parameter.min ||
                                                *parameter.fallback > parameter.max);
    return parameter.kind == Parameter::Kind::choice || outside;
}

}  // namespace

std::vector<FreeParameter> freeParameters(const Model& model, const Parameters& stated,
                                          bool isotropic, bool inSum) {
    std::vector<FreeParameter> free;
    bool listed = false;
    for (const Row& row : rows) {
        listed |= row.model == model.name;
        if (!applies(row, stated, model, isotropic)) continue;
        const Parameter& parameter = declared(model, row.keys.substr(0, row.keys.find('=')));
        free.push_back({.keys = split(row.keys),
                        .min = parameter.min,
                        .max = parameter.max,
                        .logarithmic = row.logarithmic,
                        .startLow = row.startLow,
                        .startHigh = row.startHigh,
                        .colour = parameter.kind == Parameter::Kind::colour});
    }
    if (!listed)
        for (const Parameter& parameter : model.parameters)
            if (!leavesOut(parameter)) free.push_back(unlisted(parameter));
    std::erase_if(free, [&](const FreeParameter& parameter) {
        const bool given = std::ranges::any_of(
            parameter.keys, [&](const std::string& key) { return stated.given(key); });
        const bool diffuse =
            inSum && parameter.keys.front() == "kd" && declared(model, "kd").fallback == 0.0;
        // Stated roughness in another form, or an index in place of F0.
        const bool replaced =
            (parameter.keys.front() == "alpha" && (stated.given("ax") || stated.given("ay"))) ||
            ((parameter.keys.front() == "ax" || parameter.keys.front() == "ay") &&
             stated.given("alpha")) ||
            ((parameter.keys.front() == "F0" || parameter.keys.front() == "Rs") &&
             stated.given("ior"));
        return given || diffuse || replaced;
    });
    return free;
}

Parameters statedParameters(const Model& model, std::string_view text) {
    std::vector<Parameter> optional = model.parameters;
    for (Parameter& parameter : optional)
        if (parameter.kind != Parameter::Kind::choice && !parameter.fallback)
            parameter.fallback = parameter.min;
    return parseParameters(model.name, optional, text);
}

}  // namespace hshfit::brdfs
