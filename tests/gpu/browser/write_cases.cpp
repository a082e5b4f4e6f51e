// write_cases FOLDER: what the browser checks run. Per variant NAME.json (both shaders with a main
// around them, texels, inputs and the expected outputs), the exported files of one of them in
// three/, pages of the viewer with values of their reference tables, and per form that is sampled
// samplingN.json with what the library draws and the albedo.

#include "../proposals/sample_cases.h"
#include "../shaders/runners.h"
#include "../shaders/variants.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/checksum.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/viewer.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/projection/projection.h>

#include <brdfs/catalog.h>

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <iostream>
#include <span>

namespace {

using namespace hshfit;
using Json = nlohmann::ordered_json;

template <class Value>
std::string encoded(const std::vector<Value>& values) {
    const auto bytes = std::as_bytes(std::span(values));
    return base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Json texelsJson(const gpu::Texels& texels) {
    return {{"width", texels.width},
            {"height", texels.height},
            {"layers", texels.layers},
            {"number", gpu::numberName(texels.number)},
            {"bytes", encoded(texels.bytes)}};
}

Json caseJson(const shaders::ShaderJob& job, const shaders::Variant& variant) {
    const auto source = [&](gpu::Language language) {
        const gpu::ShaderOptions options{.environmentOrder = job.environment.order};
        return wrapped(language, job, gpu::shaderSource(language, job.payload, options));
    };
    // A lookup in W texels is placed to 3 W 2^-25; neighbouring texels of noise differ by as much
    // as twice the largest value (shader_proof_test.cpp).
    const gpu::Texels& texels = job.payload.coefficients;
    const double noise = 6 * std::ldexp(texels.width + texels.height, -25);
    const double tolerance = variant.noise ? noise : 2e-6;
    // llvmpipe blends texels of 8 bits in 8 bits.
    const bool blended = texels.number == gpu::Number::unorm8 && texels.width > 1;
    Json document = {
        {"name", variant.name},
        {"tolerance", {{"swiftshader", tolerance}, {"llvmpipe", blended ? 1e-2 : tolerance}}},
        {"side", shaders::Pairs::side},
        {"channels", job.channels()},
        {"lights", job.lights()},
        {"slots", job.environment.values.size() / job.lights()},
        {"inputs", encoded(shaders::inputNumbers(job))},
        {"expected", encoded(shaders::reference(job))},
        {"glsl-es", source(gpu::Language::glslEs)},
        {"wgsl", source(gpu::Language::wgsl)},
        {"coefficients", texelsJson(texels)}};
    if (job.payload.basisTexels) document["basis"] = texelsJson(*job.payload.basisTexels);
    return document;
}

/// The files that three.js loads, of a map that is not square.
void writeForThree(const gpu::Payload& payload, const std::string& folder) {
    FileSet files(folder + "/three", true);
    const std::array containers = {&gpu::findContainer("bin"), &gpu::findContainer("exr"),
                                   &gpu::findContainer("js"), &gpu::findContainer("ktx2")};
    gpu::writeContainers(payload, containers, "material", {}, files);
    files.write("material_hsh.glsl", gpu::shaderSource(gpu::Language::glslEs, payload, {}));
    files.commit();
}

/// A page, and f where its table is interpolated: wo, wi (6 numbers a pair), then f in C++.
void writePage(const std::string& folder, const std::string& name, const std::string& spec,
               const OutgoingSet& outgoing) {
    const auto source = brdfs::open(spec);
    const auto basis = bases::make("hsh", 8);
    const Basis* const one[] = {basis.get()};
    const auto projections =
        project(*source, one, outgoing, {.quantity = Quantity::brdfCosine, .tolerance = 1e-3});
    const gpu::ViewerInput input =
        gpu::viewerInput(gpu::pack(projections[0].coefficients, {}), source.get());
    gpu::writeViewer(folder + "/" + name + ".html", input, true);

    const shaders::Pairs pairs = shaders::directionPairs();
    std::vector<float> inputs;
    std::vector<double> expected;
    for (std::size_t k = 0; k < pairs.wo.size(); ++k) {
        const Direction &wo = pairs.wo[k], &wi = pairs.wi[k];
        for (const double x : {wo.x, wo.y, wo.z, wi.x, wi.y, wi.z})
            inputs.push_back(static_cast<float>(x));
        double f = 0;
        input.reference->eval(wi, wo, &f);
        expected.push_back(f);
    }
    writeFile(folder + "/" + name + "_table.json",
              Json{{"inputs", encoded(inputs)}, {"expected", encoded(expected)}}.dump());
}

/// Directions that the library draws, with a flag where single precision may choose another lobe.
std::vector<double> drawnBy(const shaders::SampleCase& one, const shaders::ShaderJob& job) {
    std::vector<double> values;
    for (std::size_t k = 0; k < job.pairs.wo.size(); ++k) {
        const Direction &wo = job.pairs.wo[k], &u = job.pairs.wi[k];
        Direction wi{0, 0, 0};
        if (wo.z > 0) wi = one.sampler->sample(wo, {u.x, u.y, u.z}).wi;
        const bool unsure = wo.z > 0 && nearAChoice(one, wo, u.z);
        for (const double v : {wi.x, wi.y, wi.z, unsure ? 1.0 : 0.0}) values.push_back(v);
    }
    return values;
}

/// Another sample of the library at each elevation, x and y.
std::vector<double> sampleOf(const shaders::SampleCase& one, const Direction& wo) {
    UniformNumbers numbers(99);
    std::vector<double> values;
    for (int k = 0; k < 16384; ++k) {
        const Direction wi = one.sampler->sample(wo, numbers.next()).wi;
        values.push_back(wi.x), values.push_back(wi.y);
    }
    return values;
}

/// The albedo at polar angles 0, 2.5, … 90 degrees of the outgoing direction; the last just above
/// the horizon.
Json albedoJson(const Brdf& brdf) {
    Json rows = Json::array();
    for (int k = 0; k <= 36; ++k) {
        const double theta = std::min(89.9, 2.5 * k);
        rows.push_back(shaders::albedoOf(brdf, directionFromAngles(radians(theta), 0), 200));
    }
    return rows;
}

Json samplingJson(const shaders::SampleCase& one) {
    const std::vector<shaders::ShaderJob> jobs = shaders::sampleJobs(one);
    Json inputs = Json::array(), expected = Json::array(), drawn = Json::array();
    for (const shaders::ShaderJob& job : jobs) inputs.push_back(encoded(inputNumbers(job)));
    std::vector<double> densities;
    for (std::size_t k = 0; k < jobs[0].pairs.wo.size(); ++k)
        densities.push_back(one.sampler->pdf(jobs[0].pairs.wo[k], jobs[0].pairs.wi[k]));
    expected.push_back(encoded(densities));
    for (std::size_t k = 1; k < jobs.size(); ++k)
        expected.push_back(encoded(drawnBy(one, jobs[k])));
    for (const Direction& wo : shaders::sampleElevations())
        drawn.push_back(encoded(sampleOf(one, wo)));
    const auto program = [&](gpu::Language language) {
        return sampleProgram(language, jobs[0], sampleSnippet(language, one));
    };
    return {{"name", one.name},
            {"side", shaders::Pairs::side},
            {"channels", jobs[0].channels()},
            {"outputs", jobs[0].outputs()},
            {"textured", !one.form},
            {"cosine", one.cosine()},
            {"white", one.name == "basis, white"},
            {"isotropic", one.brdf->laws().isotropic},
            {"inputs", inputs},
            {"expected", expected},
            {"drawn", drawn},
            {"albedo", one.brdf->laws().isotropic ? albedoJson(*one.brdf) : Json(nullptr)},
            {"glsl-es", program(gpu::Language::glslEs)},
            {"wgsl", program(gpu::Language::wgsl)},
            {"snippet", sampleSnippet(gpu::Language::glslEs, one)},
            {"coefficients", texelsJson(one.payload.coefficients)}};
}

void writeSampling(const std::string& folder) {
    FileSet files(folder, true);
    Json names = Json::array();
    for (const shaders::SampleCase& one : shaders::sampleCases()) {
        const std::string file = "sampling" + std::to_string(names.size()) + ".json";
        files.write(file, samplingJson(one).dump());
        names.push_back(file);
    }
    files.write("sampling.json", names.dump());
    files.commit();
}

}  // namespace

int main(int count, char** words) {
    if (count != 2) {
        std::cerr << "usage: write_cases FOLDER\n";
        return 2;
    }
    const std::string folder = words[1];
    Json names;
    FileSet files(folder, true);
    for (shaders::Variant& variant : shaders::variants()) {
        const std::string file = "case" + std::to_string(names.size()) + ".json";
        names.push_back(file);
        const shaders::ShaderJob job = shaders::makeJob(variant.payload, variant.environmentOrder);
        files.write(file, caseJson(job, variant).dump());
        if (variant.name == "hsh 7") writeForThree(variant.payload, folder);
    }
    files.write("cases.json", names.dump());
    files.commit();
    writeSampling(folder);
    writePage(folder, "viewer", "phong:exponent=22", OutgoingSet::elevations(16));
    writePage(folder, "viewer_ward", "ward:ax=0.2,ay=0.5", OutgoingSet::parabolic(16, 16));
}
