#include "lighting.h"

#include <jobs/exports/export_material.h>
#include <jobs/source/source.h>

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/binaries/spirv_module.h>
#include <hshfit/gpu/containers/ktx2_image.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/light/catalog.h>
#include <hshfit/lighting/lighting_shader.h>
#include <hshfit/rendering/view.h>
#include <hshfit/version.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hshfit::jobs {
namespace {

using Json = nlohmann::ordered_json;
using Kind = LightingModel::Kind;
using Bytes = std::vector<std::byte>;

std::string_view lightingBytes(const Bytes& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// All that is written, under one name.
struct Output {
    const LightingExportOptions& options;
    std::string name;
    FileSet files;
    std::vector<std::string> names = {};

    Json add(const std::string& suffix, std::string_view text) {
        const std::string path = name + suffix;
        files.write(path, text);
        names.push_back(path);
        return {{"path", path}, {"bytes", text.size()}, {"sha256", sha256(text)}};
    }
};

Json writeTable(const LightingModel& model, const lighting::ElevationTable& table, Output& output) {
    const auto width = static_cast<int>(table.texels), height = static_cast<int>(table.height());
    const gpu::Texels texels = gpu::encode(table.values, width, height, 1, gpu::Number::float32);
    const gpu::Ktx2Image image{.number = texels.number,
                               .width = table.texels,
                               .height = table.height(),
                               .pairs = {{"hshfit:model", std::string(model.name)}}};
    const std::string stem = fmt::format(".{}.table", model.name);
    return {{"width", width},
            {"height", height},
            {"number", "float32"},
            {"files",
             {output.add(stem + ".ktx2", gpu::ktx2File(image, {&texels.bytes, 1})),
              output.add(stem + ".f32.bin", lightingBytes(texels.bytes))}}};
}

Json rgbRows(std::span<const Rgb> values) {
    Json rows = Json::array();
    for (const Rgb& value : values) rows.push_back(value);
    return rows;
}

/// The number of the cube's texels: as asked for, or the least that holds the light.
gpu::Number cubeNumber(const lighting::EnvironmentCube& cube, const LightingExportOptions& options,
                       const Listener& listener) {
    if (options.number == gpu::Number::float16 && !fitsHalf(cube))
        throw NumericError(
            "the cube of the light is brighter than float16 holds (65504); write it as float32, or "
            "scale the light down");
    if (options.number) return *options.number;
    if (fitsHalf(cube)) return gpu::Number::float16;
    listener.say(
        "the cube is brighter than float16 holds (65504) and written as float32; a light with "
        "scale=1e-3 and an exposure in its place fits float16");
    return gpu::Number::float32;
}

Json writeCube(const LightingModel& model, const lighting::EnvironmentCube& cube,
               const Listener& listener, Output& output) {
    const gpu::Number number = cubeNumber(cube, output.options, listener);
    const std::string stem = fmt::format(".{}.cube", model.name);
    std::vector<Bytes> levels;
    Json places = Json::array();
    Bytes all;
    for (const lighting::EnvironmentCube::Level& level : cube.levels) {
        std::vector<double> rgba;
        for (std::size_t k = 0; k < level.rgb.size(); k += 3) {
            for (std::size_t c = 0; c < 3; ++c) rgba.push_back(level.rgb[k + c]);
            rgba.push_back(1);
        }
        const auto face = static_cast<int>(level.face);
        levels.push_back(gpu::encode(rgba, face, face, 6, number).bytes);
        places.push_back({{"face", face}, {"offset", all.size()}, {"bytes", levels.back().size()}});
        all.insert(all.end(), levels.back().begin(), levels.back().end());
    }
    const std::size_t face = cube.levels.front().face;
    const gpu::Ktx2Image image{.number = number,
                               .width = face,
                               .height = face,
                               .faces = 6,
                               .pairs = {{"hshfit:light", output.options.light}}};
    const char* bits = number == gpu::Number::float16 ? "16" : "32";
    return {{"number", gpu::numberName(number)},
            {"faces", "+x -x +y -y +z -z of the world, as OpenGL 4.6, section 8.13"},
            {"levels", places},
            {"files",
             {output.add(stem + ".ktx2", gpu::ktx2File(image, levels)),
              output.add(fmt::format("{}.f{}.bin", stem, bits), lightingBytes(all))}}};
}

Json pointJson(const Direction& d) {
    return {d.x, d.y, d.z};
}

/// The light as the model takes it.
void describeLighting(const LightingModel& model, const LightingEnvironment& light,
                      const Listener& listener, Output& output, Json& document) {
    if (model.kind == Kind::coefficients) {
        document["light"] = rgbRows(light.harmonics->light());
    } else if (model.kind == Kind::splitSum) {
        document["irradiance"] = rgbRows(light.irradiance);
        document["cube"] = writeCube(model, light.cube, listener, output);
    } else if (model.kind == Kind::prefiltered) {
        document["cube"] = writeCube(model, light.engineCube, listener, output);
    } else {
        document["areas"] = Json::array();
        for (const lighting::AreaLight& area : light.areas) {
            Json corners = Json::array();
            for (const Direction& corner : area.corners) corners.push_back(pointJson(corner));
            document["areas"].push_back({{"corners", corners}, {"radiance", area.radiance}});
        }
    }
}

/// The shader as SPIR-V, with a file that says how it is bound.
Json writeLightingModule(const LightingModel& model, const lighting::LightingShader& shader,
                         const std::string& stem, Output& output) {
    const bool cube = model.kind == Kind::splitSum || model.kind == Kind::prefiltered;
    const auto slots = static_cast<std::size_t>(shader.order);
    const gpu::SpirvModule module = gpu::spirvLightingModule(
        {.prefix = shader.prefix,
         .function = lighting::lightingFunction(shader),
         .snippet = lighting::lightingShaderSource(gpu::Language::glsl, shader),
         .tangent = shader.azimuths.count > 1,
         .cube = cube,
         .areas = model.kind == Kind::cosines,
         .lights = model.kind == Kind::coefficients ? slots * slots
                   : model.kind == Kind::splitSum   ? 9
                                                    : 0});
    const std::string suffix = fmt::format("_{}.spv", stem);
    const Json file = output.add(suffix, gpu::spirvBytes(module.words));
    const Json bindings =
        output.add(suffix + ".json", gpu::moduleText(module, file["path"].get<std::string>()));
    return {{"target", "spirv"}, {"path", file["path"]}, {"bindings", bindings["path"]}};
}

lighting::LightingShader shaderFor(const LightingModel& model, const LightingTables& tables,
                                   const std::string& source, const std::string& prefix) {
    const lighting::ElevationTable& table = tables.table(model.kind);
    return {.kind = static_cast<lighting::LightingShader::Kind>(model.kind),
            .order = tables.harmonics ? tables.harmonics->order : 0,
            .levels = tables.splitSum ? tables.splitSum->levels : 0,
            .taps = tables.splitSum ? tables.splitSum->taps : 0,
            .engine = tables.prefiltered ? tables.prefiltered->engine : nullptr,
            .lobes = tables.prefiltered ? tables.prefiltered->lobes : 0,
            .inPlane = tables.inPlane,
            .rows = table.rows,
            .azimuths = table.azimuths,
            .texels = table.texels,
            .prefix = prefix,
            .source = source,
            .generator = std::string("hshfit ") + version};
}

Json writeLightingShaders(const LightingModel& model, const LightingTables& tables,
                          const std::string& source, const Listener& listener, Output& output) {
    const lighting::LightingShader shader = shaderFor(model, tables, source, output.options.prefix);
    const std::string stem = fmt::format("{}_{}", output.options.prefix, model.name);
    const auto chosen = gpu::selectTargets(output.options.targets);
    Json shaders = Json::array();
    for (const gpu::LanguageEntry& language : gpu::languages()) {
        if (std::ranges::none_of(chosen, [&](const gpu::Target* target) {
                return target->kind == gpu::Target::Kind::shader && target->name == language.name;
            }))
            continue;
        if (!std::ranges::count(lighting::lightingLanguages(), language.language)) {
            listener.say(fmt::format("left out: lighting has no shaders in {}", language.name));
            continue;
        }
        const Json file =
            output.add(gpu::shaderFileName("", language, stem),
                       gpu::fileText(language.language,
                                     lighting::lightingShaderSource(language.language, shader),
                                     output.name + "_" + stem));
        shaders.push_back({{"target", language.name}, {"path", file["path"]}});
    }
    if (!std::ranges::count(chosen, gpu::Target::Kind::binary, &gpu::Target::kind)) return shaders;
    try {
        shaders.push_back(writeLightingModule(model, shader, stem, output));
    } catch (const UsageError& error) {
        if (output.options.targets != "all") throw;
        listener.say(fmt::format("left out: {}", error.what()));
    }
    return shaders;
}

/// The order of the table's rows, where they are by azimuth too.
void describeAzimuths(const LightingTables& tables, Json& document) {
    const lighting::AzimuthNodes& azimuths = tables.azimuths;
    if (azimuths.count == 1) return;
    document["rows"]["azimuths"] = azimuths.count;
    document["rows"]["azimuth_formula"] =
        azimuths.folded
            ? "azimuth = (azimuths - 1) phi / 90 degrees, with phi of wo about the tangent taken "
              "into the first quarter; where x y < 0 there, the lobe is mirrored at the plane of "
              "incidence; row of the table = azimuth count + row"
            : "azimuth = azimuths phi / 360 degrees, with phi of wo about the tangent, the first "
              "after the last; row of the table = azimuth count + row";
}

/// Normals all over the sphere and viewers all over their hemispheres, with each model's radiance.
Json testsOf(std::span<const LightingModel* const> models, const LightingTables& tables,
             const LightingEnvironment& light) {
    Json tests = Json::array();
    constexpr std::size_t count = 64;
    const std::vector<Direction> normals = irradiance::normalLattice(count);
    for (std::size_t k = 0; k < count; ++k) {
        const lighting::ViewAxes axes(normals[k], normals[(k * 37 + 5) % count]);
        const double cosine = 0.03 + 0.97 * (static_cast<double>(k) + 0.5) / count;
        const Direction viewer = axes.toWorld({std::sqrt(1 - cosine * cosine), 0, cosine});
        Json test = {{"normal", pointJson(normals[k])}, {"viewer", pointJson(viewer)}};
        if (tables.azimuths.count > 1) test["tangent"] = pointJson(frameAt(normals[k]).tangent);
        for (const LightingModel* model : models)
            test[std::string(model->name)] =
                shadingOf(model->kind, tables, light)(normals[k], viewer);
        tests.push_back(test);
    }
    return tests;
}

/// The BRDF that errors are measured against: the source, or the file where it does not open.
std::unique_ptr<Brdf> truthOf(const std::string& path, const LightingExportOptions& options,
                              std::string& name, const Listener& listener) {
    if (!options.source.empty() || !looksLikeCoefficients(path)) {
        name = options.source.empty() ? path : options.source;
        return openSource(name, true);
    }
    try {
        name = readRepresentation(path).head.source;
        return openBrdf(name, true);
    } catch (const Error& error) {
        listener.say(
            fmt::format("errors are measured against the file: its source does not open "
                        "({}); name it with {}",
                        error.what(), Setting{"ExportOptions::source"}));
        name = path;
        return openSource(path, true);
    }
}

void sayWhatTimeLeftOut(const LightingExportOptions& options, std::size_t tried,
                        const Listener& listener) {
    const std::size_t asked =
        options.errors.lights.empty() ? lightExamples().size() : options.errors.lights.size();
    if (tried < asked)
        listener.say(fmt::format("errors: the time was over after {} of {} lights", tried, asked));
}

}  // namespace

LightingExport exportLighting(const std::string& path, const std::string& folder,
                              const LightingExportOptions& options, const Listener& listener) {
    const auto models = selectLightingModels(options.models);
    if (options.number && gpu::isNormalised(*options.number))
        throw UsageError(fmt::format("{}: the cube of a light takes float16 or float32",
                                     gpu::numberName(*options.number)));
    const std::vector<Light> lights = parseLights(options.light).lights;
    const auto brdf = openSource(path, true);
    Output output{options, options.name.empty() ? exportName(path) : options.name,
                  FileSet(folder, options.force)};
    const LightingTableOptions& how = options.errors.tables;
    const LightingTables tables = fitLightingTables(*brdf, models, how);
    const LightingEnvironment light = lightFor(tables, lights, how);
    std::string truthName;
    const auto truth = truthOf(path, options, truthName, listener);
    std::vector<LightingError> errors;
    if (options.measureError)
        errors = lightingErrors(lightingReferences(*truth, options.errors, listener), tables,
                                models, options.errors);
    if (options.measureError) sayWhatTimeLeftOut(options, errors.size() / models.size(), listener);
    requireReadable(*brdf);

    LightingExport result;
    Json& document = result.sidecar;
    document = {{"format", "hshfit-lighting"},
                {"version", 1},
                {"generator", std::string("hshfit ") + version},
                {"brdf", truthName},
                {"light", options.light},
                {"frame", "world, right-handed, +z up; directions point away from the surface"},
                {"rows",
                 {{"count", how.rows},
                  {"least_cosine", lighting::ElevationRows::leastCosine},
                  {"formula",
                   "row = (count - 1) sqrt((1 - sqrt(cos(theta_o))) / (1 - sqrt(least_cosine)))"}}},
                {"models", Json::array()}};
    describeAzimuths(tables, document);
    for (const LightingModel* model : models) {
        const int k = static_cast<int>(model->kind);
        Json entry = {{"model", model->name},
                      {"summary", model->summary},
                      {"bytes", tables.bytes(model->kind)},
                      {"light_bytes", light.bytes(model->kind)},
                      {"seconds", tables.seconds[k]},
                      {"light_seconds", light.seconds[k]}};
        if (model->kind == Kind::coefficients) entry["order"] = tables.harmonics->order;
        if (model->kind == Kind::splitSum) {
            entry["kernel_scale"] = tables.splitSum->firstScale;
            entry["kernel_width_degrees"] = degrees(tables.splitSum->firstWidth);
            if (tables.splitSum->taps > 0) {
                entry["taps"] = tables.splitSum->taps;
                entry["misplaced"] = tables.splitSum->misplaced;
            }
        }
        if (model->kind == Kind::prefiltered) {
            entry["engine"] = tables.prefiltered->engine->name;
            entry["lobes"] = tables.prefiltered->lobes;
        }
        entry["table"] = writeTable(*model, tables.table(model->kind), output);
        describeLighting(*model, light, listener, output, entry);
        entry["shaders"] = writeLightingShaders(*model, tables, truthName, listener, output);
        document["models"].push_back(entry);
    }
    document["errors"] = lightingErrorsJson(errors);
    document["tests"] = testsOf(models, tables, light);
    output.add(".lighting.json", jsonText(document, 1) + "\n");
    output.files.commit();
    result.files = std::move(output.names);
    return result;
}

LightingExportOptions withShared(const ExportOptions& shared, LightingExportOptions own) {
    own.targets = shared.targets;
    own.name = shared.name;
    own.source = shared.source;
    own.prefix = shared.shader.prefix;
    own.number = shared.number;
    own.measureError = shared.measureError;
    own.force = shared.force;
    own.errors.tables.order = shared.shader.environmentOrder;
    own.errors.lights = lightExamples();
    if (!shared.lights.empty()) {
        own.light = fmt::format("{}", fmt::join(shared.lights, "+"));
        own.errors.lights.insert(own.errors.lights.begin(), own.light);
    }
    return own;
}

Json lightingJson(const LightingExport& exported, const std::string& folder) {
    Json answer = exported.sidecar;
    answer["folder"] = folder;
    answer["files"] = exported.files;
    for (Json& model : answer["models"])
        for (const char* array : {"light", "irradiance", "areas", "cube"}) model.erase(array);
    answer["tests"] = answer["tests"].size();
    return answer;
}

}  // namespace hshfit::jobs
