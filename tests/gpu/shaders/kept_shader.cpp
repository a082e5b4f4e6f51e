#include "kept_shader.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace hshfit::shaders {
namespace {

namespace fs = std::filesystem;
using gpu::ComputeResource;
using Json = nlohmann::json;

std::string readFile(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InputError(path.string() + ": cannot be read");
    return {std::istreambuf_iterator<char>(file), {}};
}

void writeFile(const fs::path& path, const std::string& bytes) {
    std::ofstream file(path, std::ios::binary);
    file << bytes;
    if (!file.flush()) throw OutputError(path.string() + ": cannot be written");
}

/// FNV-1a of 64 bits.
std::string checksum(const std::string& bytes) {
    std::uint64_t sum = 0xcbf29ce484222325U;
    for (const char byte : bytes) sum = (sum ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
    return fmt::format("{:016x}", sum);
}

/// The files of numbers beside the descriptions.
struct Numbers {
    fs::path folder;

    std::string put(const std::string& bytes) const {
        const std::string name = checksum(bytes) + ".bin";
        const fs::path path = folder / name;
        if (!fs::exists(path)) {
            writeFile(path, bytes);
        } else if (readFile(path) != bytes) {
            throw OutputError(path.string() + ": two files of numbers with one checksum");
        }
        return name;
    }
    template <class T>
    std::string put(const std::vector<T>& values) const {
        return put(
            std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)));
    }
    std::string bytes(const Json& name) const { return readFile(folder / name.get<std::string>()); }
    template <class T>
    std::vector<T> get(const Json& name) const {
        const std::string all = bytes(name);
        std::vector<T> values(all.size() / sizeof(T));
        std::memcpy(values.data(), all.data(), values.size() * sizeof(T));
        return values;
    }
};

Json described(const gpu::Texels& texels, const Numbers& numbers) {
    return {{"width", texels.width},
            {"height", texels.height},
            {"layers", texels.layers},
            {"number", gpu::numberName(texels.number)},
            {"bytes", numbers.put(texels.bytes)}};
}

gpu::Texels texelsOf(const Json& json, const Numbers& numbers) {
    gpu::Texels texels;
    texels.width = json.at("width");
    texels.height = json.at("height");
    texels.layers = json.at("layers");
    texels.number = gpu::parseNumber(json.at("number").get<std::string>());
    texels.bytes = numbers.get<std::byte>(json.at("bytes"));
    return texels;
}

Json described(const ComputeResource& resource, const Numbers& numbers) {
    Json levels = Json::array();
    for (const gpu::Texels& level : resource.levels) levels.push_back(described(level, numbers));
    return {{"binding", resource.binding},
            {"kind", resource.kind},
            {"shape", resource.shape},
            {"texels", described(resource.texels, numbers)},
            {"levels", levels},
            {"numbers", numbers.put(resource.numbers)},
            {"count", resource.count}};
}

ComputeResource resourceOf(const Json& json, const Numbers& numbers) {
    ComputeResource resource;
    resource.binding = json.at("binding");
    resource.kind = json.at("kind");
    resource.shape = json.at("shape");
    resource.texels = texelsOf(json.at("texels"), numbers);
    for (const Json& level : json.at("levels")) resource.levels.push_back(texelsOf(level, numbers));
    resource.numbers = numbers.get<float>(json.at("numbers"));
    resource.count = json.at("count");
    return resource;
}

std::vector<float> singles(const std::vector<double>& values) {
    return {values.begin(), values.end()};
}

std::string fileName(const KeptShader& kept) {
    std::string name =
        fmt::format("{} {} {} {}", kept.kind, kept.name, apiName(kept.shader.api), kept.language);
    std::ranges::replace_if(
        name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '.'; }, '_');
    return name + ".json";
}

}  // namespace

double largestDifference(const Wanted& wanted, std::span<const float> found) {
    double largest = found.size() < wanted.values.size() ? 1e30 : 0;
    for (std::size_t i = 0; i < std::min(found.size(), wanted.values.size()); ++i) {
        if (std::isnan(wanted.values[i])) continue;
        double d = std::abs(static_cast<double>(found[i]) - wanted.values[i]) / wanted.scales[i];
        if (!(d < 1e30)) d = 1e30;
        largest = std::max(largest, d);
    }
    return largest;
}

double Bounds::here() const {
    return std::getenv("HSHFIT_TEST_GPU") != nullptr ? gpu : software;
}

void keepShader(const std::string& folder, const KeptShader& kept) {
    const Numbers numbers{fs::path(folder) / "numbers"};
    fs::create_directories(numbers.folder);
    Json resources = Json::array();
    for (const ComputeResource& resource : kept.shader.resources)
        resources.push_back(described(resource, numbers));
    const Json json = {{"kind", kept.kind},
                       {"language", kept.language},
                       {"name", kept.name},
                       {"api", kept.shader.api},
                       {"program", numbers.put(kept.shader.program)},
                       {"resources", resources},
                       {"invocations", kept.shader.invocations},
                       {"outputs", kept.shader.outputs},
                       {"written", kept.shader.written},
                       {"values", numbers.put(singles(kept.wanted.values))},
                       {"scales", numbers.put(singles(kept.wanted.scales))},
                       {"software", kept.bounds.software},
                       {"gpu", kept.bounds.gpu}};
    const fs::path path = fs::path(folder) / fileName(kept);
    if (fs::exists(path))
        throw OutputError(path.string() + ": two shaders of one kind, language and name");
    writeFile(path, json.dump(1));
}

std::vector<std::string> keptShaders(const std::string& folder) {
    std::vector<std::string> paths;
    if (!fs::is_directory(folder)) throw InputError(folder + ": no folder of shaders");
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".json") paths.push_back(entry.path().string());
    std::ranges::sort(paths);
    return paths;
}

KeptShader readKeptShader(const std::string& path) {
    const Numbers numbers{fs::path(path).parent_path() / "numbers"};
    const Json json = Json::parse(readFile(path));
    KeptShader kept{
        .kind = json.at("kind"),
        .language = json.at("language"),
        .name = json.at("name"),
        .shader = {.api = json.at("api"), .program = numbers.bytes(json.at("program"))}};
    for (const Json& resource : json.at("resources"))
        kept.shader.resources.push_back(resourceOf(resource, numbers));
    kept.shader.invocations = json.at("invocations");
    kept.shader.outputs = json.at("outputs");
    kept.shader.written = json.at("written");
    const std::vector<float> values = numbers.get<float>(json.at("values")),
                             scales = numbers.get<float>(json.at("scales"));
    kept.wanted = {{values.begin(), values.end()}, {scales.begin(), scales.end()}};
    kept.bounds = {json.at("software"), json.at("gpu")};
    return kept;
}

}  // namespace hshfit::shaders
