#include <hshfit/materials/materialx.h>

#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pugixml.hpp>

#include <cctype>
#include <cmath>

namespace hshfit::inline materials {
namespace {

void addInput(pugi::xml_node& shader, const MaterialXInput& input) {
    if (input.values.size() != 1 && input.values.size() != 3)
        throw UsageError(fmt::format("input '{}' has {} values; 1 and 3 are possible", input.name,
                                     input.values.size()));
    for (const double value : input.values)
        if (!std::isfinite(value))
            throw NumericError(
                fmt::format("input '{}' is not finite, which MaterialX cannot hold", input.name));
    pugi::xml_node child = shader.append_child("input");
    child.append_attribute("name") = input.name.c_str();
    child.append_attribute("type") = input.values.size() == 1 ? "float" : "color3";
    child.append_attribute("value") = fmt::format("{}", fmt::join(input.values, ", ")).c_str();
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
    pugi::xml_node surface = root.append_child(std::string(node).c_str());
    surface.append_attribute("name") = shader.c_str();
    surface.append_attribute("type") = "surfaceshader";
    for (const MaterialXInput& input : inputs) addInput(surface, input);
    pugi::xml_node own = root.append_child("surfacematerial");
    own.append_attribute("name") = material.c_str();
    own.append_attribute("type") = "material";
    own.append_attribute("doc") = std::string(doc).c_str();
    pugi::xml_node link = own.append_child("input");
    link.append_attribute("name") = "surfaceshader";
    link.append_attribute("type") = "surfaceshader";
    link.append_attribute("nodename") = shader.c_str();
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
