#include <hshfit/materials/materialx.h>

#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pugixml.hpp>

#include <cctype>
#include <cmath>

namespace hshfit::inline materials {
namespace {

void addInput(pugi::xml_node& node, const char* name, const char* type, const char* from,
              const std::string& value) {
    pugi::xml_node child = node.append_child("input");
    child.append_attribute("name") = name;
    child.append_attribute("type") = type;
    child.append_attribute(from) = value.c_str();
}

pugi::xml_node addNode(pugi::xml_node& root, const char* category, const std::string& name,
                       const char* type) {
    pugi::xml_node node = root.append_child(category);
    node.append_attribute("name") = name.c_str();
    node.append_attribute("type") = type;
    return node;
}

/// Returns the name of the node that turns the tangent.
std::string addTurned(pugi::xml_node& root, const std::string& material,
                      const MaterialXInput& input) {
    const std::string turned = fmt::format("{}_{}", material, input.name);
    for (const char* vector : {"tangent", "normal"}) {
        pugi::xml_node node =
            addNode(root, vector, fmt::format("{}_{}", turned, vector), "vector3");
        addInput(node, "space", "string", "value", "world");
    }
    pugi::xml_node node = addNode(root, "rotate3d", turned, "vector3");
    addInput(node, "in", "vector3", "nodename", turned + "_tangent");
    addInput(node, "amount", "float", "value", fmt::format("{}", -input.values[0]));
    addInput(node, "axis", "vector3", "nodename", turned + "_normal");
    return turned;
}

void checkInput(const MaterialXInput& input) {
    if (input.values.size() != 1 && (input.tangent || input.values.size() != 3))
        throw UsageError(fmt::format("input '{}' has {} values; 1 and 3 are possible", input.name,
                                     input.values.size()));
    for (const double value : input.values)
        if (!std::isfinite(value))
            throw NumericError(
                fmt::format("input '{}' is not finite, which MaterialX cannot hold", input.name));
}

}  // namespace

std::string materialXName(std::string_view name) {
    std::string valid;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        valid += byte < 128 && std::isalnum(byte) ? c : '_';
    }
    if (valid.empty() || std::isdigit(static_cast<unsigned char>(valid.front())))
        valid.insert(0, "M_");
    return valid;
}

std::string materialXText(std::string_view name, std::string_view node,
                          const std::vector<MaterialXInput>& inputs, std::string_view doc) {
    const std::string material = materialXName(name), shader = material + "_shader";
    pugi::xml_document document;
    pugi::xml_node declaration = document.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    pugi::xml_node root = document.append_child("materialx");
    root.append_attribute("version") = "1.39";
    root.append_attribute("colorspace") = "lin_rec709";
    for (const MaterialXInput& input : inputs) checkInput(input);
    std::vector<std::string> turned;
    for (const MaterialXInput& input : inputs)
        turned.push_back(input.tangent ? addTurned(root, material, input) : "");
    pugi::xml_node surface = addNode(root, std::string(node).c_str(), shader, "surfaceshader");
    for (std::size_t k = 0; k < inputs.size(); ++k) {
        const MaterialXInput& input = inputs[k];
        const char* const type = input.values.size() == 1 ? "float" : "color3";
        if (input.tangent)
            addInput(surface, input.name.c_str(), "vector3", "nodename", turned[k]);
        else
            addInput(surface, input.name.c_str(), type, "value",
                     fmt::format("{}", fmt::join(input.values, ", ")));
    }
    pugi::xml_node own = addNode(root, "surfacematerial", material, "material");
    own.append_attribute("doc") = std::string(doc).c_str();
    addInput(own, "surfaceshader", "surfaceshader", "nodename", shader);
    struct : pugi::xml_writer {
        std::string text;
        void write(const void* bytes, std::size_t count) override {
            text.append(static_cast<const char*>(bytes), count);
        }
    } writer;
    document.save(writer, "  ");
    return writer.text;
}

}  // namespace hshfit::inline materials
