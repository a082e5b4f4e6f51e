#include <brdfs/measured/bsdf_xml/bsdf_xml.h>
#include <brdfs/measured/bsdf_xml/xml_frame.h>
#include <brdfs/rows/spec.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/mapped_file.h>

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

void put(pugi::xml_node parent, const char* name, const std::string& text) {
    parent.append_child(name).text().set(text.c_str());
}

void putWithUnit(pugi::xml_node parent, const char* name, const char* unit, const char* text) {
    pugi::xml_node node = parent.append_child(name);
    node.append_attribute("unit") = unit;
    node.text().set(text);
}

void putMaterial(pugi::xml_node layer, const std::string& name) {
    pugi::xml_node material = layer.append_child("Material");
    put(material, "Name", name);
    put(material, "Manufacturer", "hshfit");
    put(material, "DeviceType", "Other");
    putWithUnit(material, "Thickness", "meter", "0");
}

void putBasis(pugi::xml_node definition, const AngleBasis& basis) {
    pugi::xml_node node = definition.append_child("AngleBasis");
    put(node, "AngleBasisName", basis.name);
    for (const AngleBasis::Ring& ring : basis.rings()) {
        const bool pole = ring.lower == 0 && ring.azimuths == 1;
        pugi::xml_node block = node.append_child("AngleBasisBlock");
        put(block, "Theta", fmt::format("{:g}", pole ? 0 : (ring.lower + ring.upper) / 2));
        put(block, "nPhis", fmt::format("{}", ring.azimuths));
        pugi::xml_node bounds = block.append_child("ThetaBounds");
        put(bounds, "LowerTheta", fmt::format("{:g}", ring.lower));
        put(bounds, "UpperTheta", fmt::format("{:g}", ring.upper));
    }
}

void putData(pugi::xml_node layer, const BsdfXmlContent& content) {
    pugi::xml_node data = layer.append_child("WavelengthData");
    put(data, "LayerNumber", "System");
    putWithUnit(data, "Wavelength", "Integral", "Visible");
    put(data, "SourceSpectrum", "CIE Illuminant D65 1nm.ssp");
    put(data, "DetectorSpectrum", "ASTM E308 1931 Y.dsp");
    for (const auto& [side, numbers] : content.blocks) {
        pugi::xml_node block = data.append_child("WavelengthDataBlock");
        put(block, "WavelengthDataDirection", std::string(blockName(side)));
        if (content.basis) {
            put(block, "ColumnAngleBasis", content.basis->name);
            put(block, "RowAngleBasis", content.basis->name);
        } else {
            put(block, "AngleBasis", "LBNL/Shirley-Chiu");
        }
        put(block, "ScatteringDataType", isTransmission(side) ? "BTDF" : "BRDF");
        put(block, "ScatteringData", numbers);
    }
}

/// Every block of the file that a BRDF of this name was opened from.
std::vector<BsdfPart> allPartsOf(const std::string& name) {
    const std::string path(pathIn(name));
    const auto none = [&] {
        return UsageError(
            fmt::format("{}: side=all writes the blocks of a BSDF XML file, and this is none; "
                        "expected front, back, transmission-front or transmission-back",
                        name));
    };
    if (path.empty()) throw none();
    const MappedFile file(path);
    const std::string_view text(reinterpret_cast<const char*>(file.bytes().data()),
                                file.bytes().size());
    if (text.substr(0, 4096).find("<WindowElement") == std::string_view::npos) throw none();
    constexpr std::string_view key = "wavelength=";
    const std::size_t at = name.find(key, path.size());
    const std::string wavelength = at == std::string::npos ? "" : name.substr(at + key.size());
    const BsdfDocument document(file.bytes(), path);
    std::vector<BsdfPart> parts;
    for (const BsdfSide side : {BsdfSide::transmissionFront, BsdfSide::transmissionBack,
                                BsdfSide::front, BsdfSide::back}) {
        const bool there = std::ranges::any_of(document.blocks(), [&](const BsdfBlock& block) {
            return sameWord(block.direction, blockName(side));
        });
        if (there) parts.push_back({side, openBsdfXml(file.bytes(), path, side, wavelength)});
    }
    file.checkIntact();
    return parts;
}

struct FileWriter : pugi::xml_writer {
    explicit FileWriter(AtomicFile& to) : file(to) {}
    void write(const void* data, std::size_t size) override {
        file.write(std::string_view(static_cast<const char*>(data), size));
    }
    AtomicFile& file;
};

}  // namespace

void writeBsdfXml(const BsdfXmlContent& content, const std::string& path,
                  const WriteOptions& options) {
    constexpr const char* structures[] = {"Columns", "Rows", "TensorTree3", "TensorTree4"};
    pugi::xml_document xml;
    pugi::xml_node declaration = xml.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "UTF-8";
    pugi::xml_node root = xml.append_child("WindowElement");
    root.append_attribute("xmlns") = "http://windows.lbl.gov";
    root.append_attribute("xmlns:xsi") = "http://www.w3.org/2001/XMLSchema-instance";
    root.append_attribute("xsi:schemaLocation") = "http://windows.lbl.gov/BSDF-v1.4.xsd";
    put(root, "WindowElementType", "System");
    put(root, "FileType", "BSDF");
    pugi::xml_node layer = root.append_child("Optical").append_child("Layer");
    putMaterial(layer, content.material);
    pugi::xml_node definition = layer.append_child("DataDefinition");
    put(definition, "IncidentDataStructure", structures[static_cast<int>(content.structure)]);
    if (content.basis) putBasis(definition, *content.basis);
    putData(layer, content);
    AtomicFile file(path,
                    options.force ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse);
    FileWriter writer(file);
    xml.save(writer, "\t", pugi::format_indent, pugi::encoding_utf8);
    file.commit();
}

std::vector<Parameter> commonWriterParameters() {
    return {
        {.name = "side",
         .help = "of the file, Radiance calls the back front; auto: front, of a transmission its "
                 "own; all: every block of a BSDF XML file",
         .kind = Parameter::Kind::choice,
         .fallback = {},
         .choices = {"auto", "front", "back", "transmission-front", "transmission-back", "all"}},
        {.name = "tolerance",
         .help = "of averages over a cell, relative",
         .fallback = 1e-3,
         .min = 1e-6,
         .max = 0.1},
        {.name = "evaluations",
         .help = "of f, after which averages are taken as they are",
         .fallback = 2e7,
         .min = 0,
         .max = 1e12}};
}

std::vector<BsdfPart> partsOf(const Brdf& brdf, const Parameters& parameters) {
    const std::string name = brdf.name(), word = parameters.choice("side");
    if (word == "all") return allPartsOf(name);
    const std::string_view own = transmissionSide(name);
    const BsdfSide side =
        sideNamed(word == "auto" ? (own.empty() ? "front" : own) : std::string_view(word)).value();
    if (isTransmission(side) == own.empty())
        throw UsageError(
            fmt::format("{}: is a {}, which side={} is not; expected side={}", name,
                        own.empty() ? "reflection" : "transmission", word,
                        own.empty() ? "front or back" : "transmission-front or transmission-back"));
    return {{side, std::shared_ptr<const Brdf>(std::shared_ptr<const Brdf>(), &brdf)}};
}

std::vector<std::string> writeParts(
    BsdfXmlContent content, const std::vector<BsdfPart>& parts,
    const std::function<std::string(const BsdfPart&, std::vector<std::string>&)>& dataOf,
    const std::string& path, const WriteOptions& options) {
    std::vector<std::string> alterations;
    for (const BsdfPart& part : parts) {
        std::vector<std::string> own;
        content.blocks.emplace_back(part.side, dataOf(part, own));
        for (const std::string& sentence : own)
            alterations.push_back(parts.size() == 1
                                      ? sentence
                                      : fmt::format("{}: {}", blockName(part.side), sentence));
    }
    writeBsdfXml(content, path, options);
    return alterations;
}

void reportUncertain(const CellAverages& averages, std::vector<std::string>& alterations) {
    if (averages.uncertain == 0) return;
    alterations.push_back(fmt::format(
        "{} of {} averages did not settle within the tolerance: their last rounds "
        "changed the worst by {:.2g} and the sum of all by at most {:.2g}, relative; "
        "more evaluations= come closer",
        averages.uncertain, averages.values.size(), averages.worstChange, averages.typicalChange));
}

}  // namespace hshfit::brdfs
