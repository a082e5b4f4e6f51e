#include "code.h"
#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "job_options.h"

#include <hshfit/error.h>
#include <hshfit/percent.h>

#include <jobs/lighting/irradiance.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct IrradianceArguments {
    std::vector<std::string> specs;
    jobs::IrradianceOptions options;
};

Json nineJson(const NineRgb& nine) {
    Json rows = Json::array();
    for (const Rgb& rgb : nine) rows.push_back({rgb[0], rgb[1], rgb[2]});
    return rows;
}

Json errorJson(const IrradianceErrors& error) {
    return {{"maximum", error.maximum},
            {"mean", error.mean},
            {"worst_normal", directionJson(error.worst)},
            {"negative", error.negative}};
}

Json conventionJson(const Convention& c, const NineRgb& radiance) {
    return {{"name", c.name},
            {"engine", c.engine},
            {"signs", c.signs},
            {"up", c.up},
            {"handedness", c.handedness},
            {"quantity", c.quantity},
            {"divided_by_pi", c.divided},
            {"constants", c.constants},
            {"order", c.order},
            {"import", {{"turn", c.turn}, {"mirror", false}, {"source", c.import}}},
            {"source", c.source},
            {"evidence", c.evidence},
            {"values", engineValues(c, radiance)},
            {"shader", engineShader(c, radiance)}};
}

Json answer(const jobs::LitSurface& lit, const IrradianceArguments& arguments) {
    Json conventions = Json::array();
    for (const Convention* each : lit.conventions)
        conventions.push_back(conventionJson(*each, lit.radiance));
    const ZonalForm& zonal = lit.zonal;
    Json linear = Json::array();
    for (const Rgb& rgb : zonal.linear) linear.push_back({rgb[0], rgb[1], rgb[2]});
    return {
        {"format", "hshfit-irradiance"},
        {"version", 1},
        {"light", lit.light},
        {"order", arguments.options.order},
        {"turn", lit.turn},
        {"radiance", nineJson(lit.radiance)},
        {"irradiance", nineJson(lit.irradiance)},
        {"window", {{"name", lit.window}, {"factors", lit.factors}}},
        {"mean_irradiance", lit.meanIrradiance},
        {"normals", arguments.options.normals},
        {"error", errorJson(lit.error)},
        {"nine", {{"bytes", sizeof(float) * 27}, {"error", errorJson(lit.nineError)}}},
        {"zonal",
         {{"linear", linear},
          {"quadratic", zonal.quadratic},
          {"axis", {zonal.axis.x, zonal.axis.y, zonal.axis.z}},
          {"bytes", sizeof(float) * 15},
          {"error", errorJson(lit.zonalError)}}},
        {"geomerics",
         {{"order", 2}, {"bytes", sizeof(float) * 12}, {"error", errorJson(lit.geomericsError)}}},
        {"conventions", conventions}};
}

std::string errorText(const char* name, std::size_t numbers, const IrradianceErrors& error) {
    return fmt::format(
        "{:<18} {:>3} bytes  error at most {} (normal {}), mean {}{}\n", name,
        numbers * sizeof(float), percent(error.maximum), directionText(error.worst),
        percent(error.mean),
        error.negative < 0 ? fmt::format(", down to {}", percent(error.negative)) : "");
}

/// 0 for what sums of double precision leave of nothing.
Rgb withoutRounding(Rgb values, double scale) {
    for (double& value : values)
        if (std::abs(value) < 1e-13 * scale) value = 0;
    return values;
}

std::string text(const jobs::LitSurface& lit, const IrradianceArguments& arguments) {
    std::string out = fmt::format(
        "mean irradiance {:.6g}; errors against direct integration at {} normals, relative to it\n",
        lit.meanIrradiance, arguments.options.normals);
    const auto numbers =
        static_cast<std::size_t>(3 * arguments.options.order * arguments.options.order);
    out += errorText(fmt::format("order {}", arguments.options.order).c_str(), numbers, lit.error);
    // The numbers and shaders below hold three bands.
    if (arguments.options.order > 3) out += errorText("order 3, as below", 27, lit.nineError);
    out += errorText("zonal order 3", 15, lit.zonalError);
    out += errorText("geomerics order 2", 12, lit.geomericsError);
    // Within the 80 columns of a terminal.
    out += " l  m  radiance R, G, B                   irradiance R, G, B\n";
    for (int l = 0; l < 3; ++l) {
        for (int m = -l; m <= l; ++m) {
            const auto k = static_cast<std::size_t>(l * (l + 1) + m);
            const Rgb a = withoutRounding(lit.radiance[k], lit.meanIrradiance),
                      b = withoutRounding(lit.irradiance[k], lit.meanIrradiance);
            out += fmt::format("{:2} {:2} {:12.5g}{:12.5g}{:12.5g} {:12.5g}{:12.5g}{:12.5g}\n", l,
                               m, a[0], a[1], a[2], b[0], b[1], b[2]);
        }
    }
    return out;
}

std::string factsOf(const Convention& c, const IrradianceArguments& arguments) {
    return fmt::format(
        "\n{}: {}\n  signs {}; up {}; {}-handed\n  {}; divided by pi: {}\n"
        "  constants folded in: {}; {}\n  import of a panorama: {}; turn {:g}, no mirror{}\n",
        c.name, c.engine, c.signs, c.up, c.handedness, c.quantity, c.divided, c.constants, c.order,
        c.import, c.turn, arguments.options.engine.empty() ? "" : ", applied");
}

void runIrradiance(const IrradianceArguments& arguments, const Globals& globals) {
    const jobs::LitSurface lit = jobs::irradianceOfLight(arguments.specs, arguments.options);
    for (const std::string& remark : lit.remarks) note(globals, remark);
    if (globals.json) return printJson(answer(lit, arguments));
    printText(text(lit, arguments));
    for (const Convention* each : lit.conventions) {
        printText(factsOf(*each, arguments));
        printCode(engineShader(*each, lit.radiance));
    }
}

constexpr ArgumentRow irradianceArguments[] = {
    required("SPEC", at<&IrradianceArguments::specs>,
             "One or more lights, which add up: kind:key=value,…, the path of a picture, or "
             "PATH:convention=NAME of nine numbers (docs/explanation/irradiance.md)",
             lightRead),
};

}  // namespace

CommandRows irradianceRows() {
    return {irradianceArguments, {jobs::irradianceOptions().rows}};
}

void addIrradiance(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<IrradianceArguments>();
    addArguments(command, irradianceArguments, *arguments);
    addOptions(command, jobs::irradianceOptions(), arguments->options);
    command.callback([arguments, &globals] { runIrradiance(*arguments, globals); });
}

}  // namespace hshfit::cli
