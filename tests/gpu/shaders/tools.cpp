#include "runners.h"
#include "slang_rules.h"

#include <fmt/format.h>
#include <kainjow/mustache.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace hshfit::shaders {
namespace {

namespace fs = std::filesystem;

const fs::path here = fs::path(HSHFIT_SOURCE) / "tests/gpu/shaders";

/// A folder that goes away with this object.
struct Folder {
    fs::path path;
    Folder() {
        std::string name = (fs::temp_directory_path() / "hshfit-shader-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
        path = name;
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    std::string file(const char* name) const { return (path / name).string(); }
};

struct Outcome {
    int status;
    std::string text;  ///< of both outputs
};

Outcome command(const std::string& line) {
    std::FILE* pipe = popen((line + " 2>&1").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("no shell");
    Outcome outcome{0, {}};
    std::array<char, 4096> part{};
    while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe))
        outcome.text.append(part.data(), n);
    const int status = pclose(pipe);
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return outcome;
}

void need(const char* tool, const char* package) {
    if (command(fmt::format("command -v {}", tool)).status != 0)
        throw Missing(fmt::format("{} is not installed ({})", tool, package));
}

void accept(const std::string& line) {
    const Outcome outcome = command(line);
    if (outcome.status != 0) throw Refused(outcome.text);
}

std::string textOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error("cannot read " + path.string());
    return {std::istreambuf_iterator<char>(file), {}};
}

void save(const std::string& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

template <class T>
void append(std::string& bytes, const T* values, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

/// The texels that the GPU samples: decoded, but neither scaled nor offset.
void appendArray(std::string& bytes, const gpu::Texels& first,
                 const std::vector<gpu::Texels>& levels = {}) {
    const int size[] = {first.width, first.height, static_cast<int>(first.layers),
                        1 + static_cast<int>(levels.size())};
    append(bytes, size, 4);
    std::vector<gpu::Texels> all{first};
    all.insert(all.end(), levels.begin(), levels.end());
    for (gpu::Texels& texels : all) {
        for (gpu::LaneScale& scale : texels.scales) scale = {};
        const std::vector<double> values = gpu::decode(texels);
        const std::vector<float> singles(values.begin(), values.end());
        append(bytes, singles.data(), singles.size());
    }
}

const char* wrapperOf(gpu::Language language) {
    switch (language) {
        case gpu::Language::glslEs:
            return "glsl_es.mustache";
        case gpu::Language::glsl:
            return "glsl.mustache";
        case gpu::Language::hlsl:
        case gpu::Language::slang:
            return "hlsl.mustache";
        case gpu::Language::wgsl:
            return "wgsl.mustache";
        case gpu::Language::metal:
            return "metal.mustache";
        case gpu::Language::osl:
            break;
    }
    return "osl.mustache";
}

struct Types {
    const char *real, *vector;
};
Types typesOf(gpu::Language language) {
    switch (language) {
        case gpu::Language::glslEs:
        case gpu::Language::glsl:
            return {"float", "vec3"};
        case gpu::Language::hlsl:
        case gpu::Language::slang:
        case gpu::Language::metal:
            return {"float", "float3"};
        case gpu::Language::wgsl:
            return {"f32", "vec3<f32>"};
        case gpu::Language::osl:
            break;
    }
    return {"float", "vector"};
}

/// WGSL has no macros: the harmonics of filtered maps make room for the input of tests.
std::string withFreeBinding(std::string snippet) {
    const std::string place = "@binding(3) var hsh_harmonics";
    const std::size_t at = snippet.find(place);
    if (at != std::string::npos) snippet.replace(at, place.size(), "@binding(5) var hsh_harmonics");
    return snippet;
}

}  // namespace

std::vector<float> inputNumbers(const ShaderJob& job) {
    std::vector<float> numbers;
    for (std::size_t k = 0; k < job.pairs.wo.size(); ++k) {
        for (const Direction& d : {job.pairs.wo[k], job.pairs.wi[k]})
            for (const double v : {d.x, d.y, d.z}) numbers.push_back(static_cast<float>(v));
    }
    for (const double v : job.environment.values) numbers.push_back(static_cast<float>(v));
    for (const double v : job.places) numbers.push_back(static_cast<float>(v));
    return numbers;
}

std::vector<float> blockNumbers(const ShaderJob& job) {
    if (job.form != "block") return {};
    const std::vector<double> values = gpu::decode(job.payload.coefficients);
    return {values.begin(), values.end()};
}

std::string wrapped(gpu::Language language, const ShaderJob& job, const std::string& snippet) {
    using kainjow::mustache::data;
    const bool grey = job.payload.head.channels.kind == Channels::Kind::grey;
    const bool spectral = job.payload.head.channels.kind == Channels::Kind::spectral;
    const Types types = typesOf(language);
    data page;
    const bool slang = language == gpu::Language::slang;
    page.set("snippet", slang ? moduleAsHlsl(snippet) : withFreeBinding(snippet));
    page.set("type", spectral ? "hsh_Values" : grey ? types.real : types.vector);
    page.set("lightElement", spectral ? "hsh_Values" : types.vector);
    page.set("spectral", spectral);
    page.set("v", spectral ? ".v" : "");
    page.set("of", spectral ? ".v[i]" : grey ? "" : "[i]");
    page.set("tabulated", job.payload.basisTexels.has_value() && job.places.empty());
    page.set("world", job.world);
    const bool wgsl = language == gpu::Language::wgsl;
    data words;
    words.set("let", wgsl ? "let" : types.real);
    words.set("let3", wgsl ? "let" : types.vector);
    words.set("vec3", types.vector);
    kainjow::mustache::mustache frame(textOf(here / "wrappers/frame.mustache"));
    frame.set_custom_escape([](const std::string& text) { return text; });
    page.set("frame", frame.render(words));
    const auto number = [&](const char* name, std::size_t value) {
        page.set(name, std::to_string(value));
    };
    number("channels", job.channels());
    number("lights", job.lights());
    number("outputs", job.outputs());
    page.set("form", !job.form.empty());
    page.set("bare", job.form == "constants");
    page.set("block", job.form == "block");
    number("environment", job.form.empty() ? job.environment.values.size() / job.lights() : 0);
    number("first", 6 * job.pairs.wo.size());
    const bool map = !job.places.empty();
    number("firstPlace", 6 * job.pairs.wo.size() + job.environment.values.size());
    page.set("map", map);
    // Texels of a map without a sampler are indices.
    const bool sharing = map && job.payload.basisTexels;
    const bool indices = map && isNormalised(job.payload.coefficients.number);
    page.set("sharing", sharing);
    const bool harmonics = !job.harmonics.empty();
    page.set("harmonics", harmonics);
    page.set("metalPass", fmt::format("map, {}{}{}", indices ? "" : "mapSampler, ",
                                      sharing ? "numbers, " : "", harmonics ? "harmonics, " : ""));
    page.set("at", map ? "uv, lod, " : "");
    kainjow::mustache::mustache wrapper(textOf(here / "wrappers" / wrapperOf(language)));
    wrapper.set_custom_escape([](const std::string& s) { return s; });
    return wrapper.render(page);
}

void keepTimed(const TimedCall& timed, std::vector<gpu::ComputeResource> resources) {
    const char* folder = std::getenv("HSHFIT_KEEP_SHADERS");
    if (folder == nullptr) return;
    constexpr std::size_t side = 1024;
    kainjow::mustache::data page;
    page.set("snippet", timed.snippet);
    page.set("before", timed.before);
    page.set("call", timed.call);
    page.set("side", std::to_string(side));
    kainjow::mustache::mustache text(textOf(here.parent_path() / "device/timed.mustache"));
    text.set_custom_escape([](const std::string& s) { return s; });
    const std::vector<std::uint32_t> words = toSpirv(gpu::Language::glsl, text.render(page));
    resources.push_back({.binding = 3, .numbers = {1}});
    resources.push_back({.binding = 4, .count = side * side});
    keepShader(
        folder,
        {.kind = timedKind,
         .language = "glsl",
         .name = fmt::format("{:02} {}", timed.place, timed.name),
         .shader = {.api = Api::vulkan,
                    .program = {reinterpret_cast<const char*>(words.data()), 4 * words.size()},
                    .resources = std::move(resources),
                    .invocations = side * side,
                    .outputs = 1}});
}

std::vector<float> run(gpu::Language language, const ShaderJob& job, const std::string& source) {
    switch (language) {
        case gpu::Language::glslEs:
            return runOpenGlEs(job, source);
        case gpu::Language::metal:
        case gpu::Language::osl:
            return runStub(job, source);
        default:
            return runVulkan(job, toSpirv(language, source), language == gpu::Language::glsl);
    }
}

Run runnerOf(gpu::Language language) {
    return [language](const ShaderJob& job, const std::string& source) {
        return run(language, job, source);
    };
}

std::string withFault(std::string snippet, const std::string& right, const std::string& wrong) {
    const std::size_t at = snippet.find(right);
    if (at == std::string::npos) throw std::invalid_argument("no '" + right + "' in the snippet");
    return snippet.replace(at, right.size(), wrong);
}

std::vector<std::uint32_t> toSpirv(gpu::Language language, const std::string& source) {
    need("spirv-val", "spirv-tools");
    const Folder folder;
    const std::string in = folder.file("shader.comp"), out = folder.file("shader.spv");
    save(in, source);
    if (language == gpu::Language::wgsl) {
        need("node", "nodejs");
        if (!fs::exists(here.parent_path() / "node_modules/naga-wasm"))
            throw Missing("naga-wasm is not installed (npm ci in tests/gpu)");
        accept(fmt::format("node '{}' '{}' '{}'", (here / "wgsl_to_spirv.mjs").string(), in, out));
    } else {
        need("glslangValidator", "glslang-tools");
        accept(
            fmt::format("glslangValidator {} --target-env vulkan1.1 -S comp -e main '{}' -o '{}'",
                        language == gpu::Language::glsl ? "-V" : "-D -V", in, out));
    }
    accept(fmt::format("spirv-val --target-env vulkan1.1 '{}'", out));
    const std::string bytes = textOf(out);
    std::vector<std::uint32_t> words(bytes.size() / 4);
    std::copy_n(bytes.data(), words.size() * 4, reinterpret_cast<char*>(words.data()));
    return words;
}

void validateSpirv(const std::vector<std::uint32_t>& words) {
    need("spirv-val", "spirv-tools");
    const Folder folder;
    std::string bytes;
    append(bytes, words.data(), words.size());
    save(folder.file("shader.spv"), bytes);
    accept(fmt::format("spirv-val --target-env vulkan1.1 '{}'", folder.file("shader.spv")));
}

std::string disassembled(const std::vector<std::uint32_t>& words) {
    need("spirv-dis", "spirv-tools");
    const Folder folder;
    std::string bytes;
    append(bytes, words.data(), words.size());
    save(folder.file("shader.spv"), bytes);
    const Outcome outcome = command(fmt::format("spirv-dis '{}'", folder.file("shader.spv")));
    if (outcome.status != 0) throw Refused(outcome.text);
    return outcome.text;
}

void validateFragment(const std::string& source) {
    need("glslangValidator", "glslang-tools");
    const Folder folder;
    save(folder.file("shader.frag"), source);
    accept(fmt::format("glslangValidator '{}'", folder.file("shader.frag")));
}

std::vector<float> runStub(const ShaderJob& job, const std::string& source) {
    need("g++", "g++");
    const Folder folder;
    save(folder.file("stub.cpp"), source);
    accept(fmt::format("g++ -std=c++20 -O1 -fsingle-precision-constant -I'{}' '{}' -o '{}'",
                       (here / "stubs").string(), folder.file("stub.cpp"), folder.file("stub")));
    std::string bytes;
    appendArray(bytes, job.payload.coefficients, job.levels);
    appendArray(bytes, job.payload.basisTexels.value_or(gpu::Texels{}));
    if (job.harmonics.empty())
        appendArray(bytes, gpu::Texels{});
    else
        appendArray(bytes, job.harmonics[0], {job.harmonics.begin() + 1, job.harmonics.end()});
    const std::vector<float> block = blockNumbers(job);
    const int length = static_cast<int>(block.size());
    append(bytes, &length, 1);
    append(bytes, block.data(), block.size());
    const std::vector<float> numbers = inputNumbers(job);
    const int sizes[] = {static_cast<int>(job.pairs.wo.size()), static_cast<int>(numbers.size()),
                         static_cast<int>(job.outputs())};
    append(bytes, sizes, 3);
    append(bytes, numbers.data(), numbers.size());
    save(folder.file("job"), bytes);
    const Outcome outcome = command(fmt::format("'{}' '{}' '{}'", folder.file("stub"),
                                                folder.file("job"), folder.file("results")));
    if (outcome.status != 0) throw std::runtime_error("the stub failed: " + outcome.text);
    const std::string found = textOf(folder.file("results"));
    std::vector<float> results(found.size() / 4);
    std::copy_n(found.data(), results.size() * 4, reinterpret_cast<char*>(results.data()));
    return results;
}

}  // namespace hshfit::shaders
