#include "bound_module.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <sstream>

namespace hshfit::shaders {
namespace {

using gpu::ComputeResource;
using Kind = ComputeResource::Kind;
using Words = std::vector<std::string>;

/// The instructions of a listing by the name of their result, and its decorations.
struct Listing {
    std::map<std::string, Words> results;
    std::map<std::string, std::map<std::string, std::string>> decorations;
    std::map<std::string, std::map<int, Words>> members;

    explicit Listing(const std::string& text) {
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            std::istringstream parts(line);
            Words words;
            for (std::string word; parts >> word;) words.push_back(word);
            if (words.size() > 2 && words[1] == "=") {
                results[words[0]] = {words.begin() + 2, words.end()};
            } else if (words.size() > 2 && words[0] == "OpDecorate") {
                decorations[words[1]][words[2]] = words.size() > 3 ? words[3] : "";
            } else if (words.size() > 3 && words[0] == "OpMemberDecorate") {
                Words& of = members[words[1]][std::stoi(words[2])];
                of.insert(of.end(), words.begin() + 3, words.end());
            }
        }
    }
    bool has(const std::string& type, const char* word) const {
        const auto found = members.find(type);
        return found != members.end() && std::ranges::count(found->second.at(0), word) > 0;
    }
    /// Offsets of a structure's members; 0 of what is none.
    std::vector<int> offsets(const std::string& type) const {
        if (results.at(type)[0] != "OpTypeStruct") return {0};
        std::vector<int> all;
        for (const auto& [k, words] : members.at(type))
            all.push_back(std::stoi(*(std::ranges::find(words, "Offset") + 1)));
        return all;
    }
    std::string image(const Words& type) const {
        // OpTypeImage %float Dim Depth Arrayed …
        const Words& of = results.at(type[1]);
        const char* shape = of[2] == "Cube" ? "cube" : of[4] == "1" ? "2d_array" : "2d";
        return fmt::format("combined_image_sampler {}", shape);
    }
    std::string buffer(const std::string& type) const {
        const Words& array = results.at(results.at(type)[1]);
        const int stride = std::stoi(decorations.at(results.at(type)[1]).at("ArrayStride"));
        if (has(type, "NonReadable")) return "storage_buffer write";
        std::string line =
            fmt::format("storage_buffer read {} [{}]", stride, fmt::join(offsets(array[1]), ","));
        if (array[0] == "OpTypeArray") line += fmt::format(" {}", results.at(array[2]).back());
        return line;
    }
};

}  // namespace

std::vector<float> itemNumbers(const std::vector<std::vector<Direction>>& fields) {
    std::vector<float> numbers;
    for (std::size_t k = 0; k < fields.front().size(); ++k)
        for (const std::vector<Direction>& field : fields)
            for (const double v : {field[k].x, field[k].y, field[k].z, -7.0})
                numbers.push_back(static_cast<float>(v));
    return numbers;
}

std::vector<ComputeResource> boundTo(const gpu::Payload& payload) {
    std::vector<ComputeResource> bound{
        {.binding = 0, .kind = Kind::sampledTexture, .texels = payload.coefficients}};
    if (payload.basisTexels)
        bound.push_back(
            {.binding = 1, .kind = Kind::sampledTexture, .texels = *payload.basisTexels});
    return bound;
}

std::vector<ComputeResource> boundTo(const gpu::FormPayload& payload, gpu::Storage storage) {
    if (storage == gpu::Storage::texture)
        return {{.kind = Kind::sampledTexture, .texels = payload.texels}};
    if (storage != gpu::Storage::block) return {};
    const std::vector<double> numbers = gpu::decode(payload.texels);
    return {{.kind = Kind::uniforms, .numbers = {numbers.begin(), numbers.end()}}};
}

BoundShader boundModule(const std::vector<std::uint32_t>& words, std::vector<float> items,
                        std::size_t count, std::size_t outputs,
                        std::vector<ComputeResource> bound) {
    bound.push_back({.binding = 2, .numbers = std::move(items)});
    bound.push_back({.binding = 3, .count = count * outputs});
    return {.api = Api::vulkan,
            .program = gpu::spirvBytes(words),
            .resources = std::move(bound),
            .invocations = (count + 2 * gpu::spirvGroup - 1) / gpu::spirvGroup * gpu::spirvGroup,
            .outputs = outputs,
            .written = 3};
}

std::vector<std::string> listedBindings(const std::string& text) {
    const Listing listing(text);
    std::vector<std::string> lines;
    for (const auto& [name, of] : listing.decorations) {
        if (!of.contains("Binding")) continue;
        // OpVariable %pointer Class; OpTypePointer Class %type
        const Words& variable = listing.results.at(name);
        const std::string type = listing.results.at(variable[1]).back();
        const Words& words = listing.results.at(type);
        std::string what = variable[2] == "Uniform"           ? "uniform_buffer"
                           : words[0] == "OpTypeSampledImage" ? listing.image(words)
                                                              : listing.buffer(type);
        lines.push_back(fmt::format("{}.{} {}", of.at("DescriptorSet"), of.at("Binding"), what));
    }
    std::ranges::sort(lines);
    return lines;
}

std::vector<std::string> statedBindings(const std::string& text) {
    const nlohmann::json document = nlohmann::json::parse(text);
    std::vector<std::string> lines;
    for (const nlohmann::json& binding : document.at("bindings")) {
        const std::string type = binding.at("type");
        std::string line = fmt::format("{}.{} {}", document.at("descriptor_set").get<int>(),
                                       binding.at("binding").get<int>(), type);
        if (type == "combined_image_sampler")
            line += fmt::format(" {}", binding.at("image").get<std::string>());
        if (type == "storage_buffer")
            line += fmt::format(" {}", binding.at("access").get<std::string>());
        if (type == "storage_buffer" && binding.at("access") == "read") {
            std::vector<int> offsets;
            for (const nlohmann::json& field : binding.at("fields"))
                offsets.push_back(field.at("offset"));
            line +=
                fmt::format(" {} [{}]", binding.at("stride").get<int>(), fmt::join(offsets, ","));
            if (binding.contains("items")) line += fmt::format(" {}", binding["items"].get<int>());
        }
        lines.push_back(line);
    }
    std::ranges::sort(lines);
    return lines;
}

}  // namespace hshfit::shaders
