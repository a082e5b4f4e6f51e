#include <brdfs/measured/bsdf_xml/document.h>
#include <brdfs/measured/text_reader.h>

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hshfit::brdfs {
namespace {

/// A quotation for messages: a piece of the text without control characters.
std::string quoted(std::string_view text) {
    constexpr std::size_t most = 40;
    std::string piece(text.substr(0, most));
    for (char& c : piece)
        if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
    return text.size() > most ? piece + "…" : piece;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\n";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string wordOf(const pugi::xml_node& parent, const char* child) {
    return quoted(trimmed(parent.child_value(child)));
}

std::size_t offsetOf(const pugi::xml_node& node) {
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0));
}

}  // namespace

bool sameWord(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    return std::ranges::equal(a, b, {}, lower, lower);
}

struct BsdfDocument::Parsed {
    pugi::xml_document xml;
    pugi::xml_node layer;
};

BsdfDocument::BsdfDocument(std::span<const unsigned char> bytes, std::string where)
    : where_(std::move(where)), parsed_(std::make_unique<Parsed>()) {
    if (bytes.size() > maxBytes) {
        throw InputError(fmt::format("{}: {} bytes are too many for a BSDF XML file (at most {})",
                                     where_, bytes.size(), maxBytes));
    }
    for (std::size_t i = 0; i < bytes.size(); ++i)
        if (bytes[i] == '\n') lineEnds_.push_back(i);
    check(bytes);
    // The bytes are taken as they are, so that offsets are offsets in the file.
    const pugi::xml_parse_result result = parsed_->xml.load_buffer(
        bytes.data(), bytes.size(), pugi::parse_cdata | pugi::parse_escapes, pugi::encoding_utf8);
    if (!result) {
        throw error(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)),
                    fmt::format("is not valid XML: {}", result.description()));
    }
    const pugi::xml_node root = parsed_->xml.child("WindowElement");
    if (!root) throw error(0, "the outermost element is not WindowElement");
    const pugi::xml_node optical = root.child("Optical");
    if (!optical) throw error(offsetOf(root), "WindowElement holds no Optical");
    parsed_->layer = optical.child("Layer");
    if (!parsed_->layer) throw error(offsetOf(optical), "Optical holds no Layer");
    for (const auto& layer : optical.children("Layer")) {
        static_cast<void>(layer);
        ++layers_;
    }
    const pugi::xml_node material = parsed_->layer.child("Material");
    material_ = wordOf(material, "Name");
    manufacturer_ = wordOf(material, "Manufacturer");
    readStructure();
    readBases();
    readBlocks();
}

BsdfDocument::~BsdfDocument() = default;

InputError BsdfDocument::error(std::size_t offset, std::string_view message) const {
    const auto line = std::ranges::lower_bound(lineEnds_, offset) - lineEnds_.begin() + 1;
    return InputError(fmt::format("{}: line {}: {}", where_, line, message));
}

// Tags are counted without recursion and before the parser allocates a node for each. Comments,
// CDATA and processing instructions are skipped; the parser checks their form.
void BsdfDocument::check(std::span<const unsigned char> bytes) const {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
        throw error(zero, fmt::format("a zero byte at offset {}; expected XML in UTF-8", zero));
    }
    std::size_t depth = 0, elements = 0;
    for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
        const std::string_view rest = text.substr(at);
        const auto skip = [&](std::string_view end) {
            const std::size_t found = text.find(end, at + 2);
            if (found == std::string_view::npos) {
                throw error(at, fmt::format("what starts with '{}' does not end with '{}'",
                                            quoted(rest.substr(0, 9)), end));
            }
            at = found + end.size();
        };
        if (rest.starts_with("<!--")) {
            skip("-->");
        } else if (rest.starts_with("<![CDATA[")) {
            skip("]]>");
        } else if (rest.starts_with("<?")) {
            skip("?>");
        } else if (rest.starts_with("<!")) {
            throw error(at,
                        "a document type declaration or another '<!' markup; these are refused, "
                        "because BSDF XML needs no entities");
        } else if (rest.starts_with("</")) {
            depth -= depth > 0 ? 1 : 0;
            skip(">");
        } else {
            if (++elements > maxElements) {
                throw error(at, fmt::format("more than {} elements", maxElements));
            }
            // A '>' in an attribute's value can make the counted depth too high, never too low.
            const std::size_t end = text.find('>', at);
            const bool empty = end != std::string_view::npos && text[end - 1] == '/';
            if (!empty && ++depth > maxDepth) {
                throw error(at, fmt::format("more than {} elements within each other", maxDepth));
            }
            at = end == std::string_view::npos ? text.size() : end + 1;
        }
    }
}

void BsdfDocument::readStructure() {
    const pugi::xml_node definition = parsed_->layer.child("DataDefinition");
    if (!definition) throw error(offsetOf(parsed_->layer), "Layer holds no DataDefinition");
    const pugi::xml_node node = definition.child("IncidentDataStructure");
    const std::string word = quoted(trimmed(node.child_value()));
    constexpr std::pair<std::string_view, Structure> known[] = {
        {"Columns", Structure::columns},
        {"Rows", Structure::rows},
        {"TensorTree3", Structure::tree3},
        {"TensorTree4", Structure::tree4},
    };
    for (const auto& [name, structure] : known) {
        if (!sameWord(name, word)) continue;
        structure_ = structure;
        return;
    }
    throw error(offsetOf(node ? node : definition),
                fmt::format("IncidentDataStructure is '{}', expected Columns, Rows, TensorTree3 or "
                            "TensorTree4",
                            word));
}

void BsdfDocument::readBases() {
    const auto number = [&](const pugi::xml_node& parent, const char* child, double most) {
        std::string_view text = trimmed(parent.child_value(child));
        const std::string word = quoted(text);
        double value = 0;
        if (!takeNumber(text, value) || !text.empty() || !(value >= 0 && value <= most)) {
            throw error(offsetOf(parent), fmt::format("{} is '{}', expected a number from 0 to {}",
                                                      child, word, most));
        }
        return value;
    };
    for (const auto& node : parsed_->layer.child("DataDefinition").children("AngleBasis")) {
        AngleBasis basis;
        basis.name = wordOf(node, "AngleBasisName");
        double reached = 0;
        for (const auto& block : node.children("AngleBasisBlock")) {
            const pugi::xml_node bounds = block.child("ThetaBounds");
            const double lower = number(bounds, "LowerTheta", 90);
            const double upper = number(bounds, "UpperTheta", 90);
            const double azimuths = number(block, "nPhis", 1024);
            if (std::abs(lower - reached) > 1e-4 || !(upper > reached)) {
                throw error(offsetOf(block),
                            fmt::format("a ring from {} to {} degrees in basis '{}', expected one "
                                        "from {} upwards",
                                        lower, upper, basis.name, reached));
            }
            if (azimuths != std::floor(azimuths) || azimuths < 1) {
                throw error(offsetOf(block), fmt::format("nPhis is {}, expected a whole number "
                                                         "from 1",
                                                         azimuths));
            }
            basis.add(upper, static_cast<std::size_t>(azimuths));
            reached = upper;
            if (basis.rings().size() > maxRings || basis.patches() > maxPatches) {
                throw error(offsetOf(block),
                            fmt::format("basis '{}' has more than {} rings or {} patches",
                                        basis.name, maxRings, maxPatches));
            }
        }
        // Without blocks the basis is known by its name alone.
        if (!basis.rings().empty()) bases_.push_back(std::move(basis));
    }
}

/// The wavelength of a block for one of them alone, in nm; 0 for a part of the spectrum. LBNL's
/// schema has the units Integral and Nanometer.
double BsdfDocument::nanometresOf(std::size_t offset, std::string_view unit,
                                  std::string_view word) const {
    const bool micrometres = sameWord(unit, "Micron") || sameWord(unit, "Micrometer");
    if (!micrometres && !sameWord(unit, "Nanometer") && !sameWord(unit, "nm")) return 0;
    std::string_view rest = word;
    double value = 0;
    if (!takeNumber(rest, value) || !rest.empty() || !(value > 0 && value <= 1e6)) {
        throw error(offset, fmt::format("Wavelength is '{}' {}, expected a number above 0",
                                        quoted(word), quoted(unit)));
    }
    return micrometres ? std::round(value * 1e6) / 1e3 : value;
}

void BsdfDocument::readBlocks() {
    for (const auto& data : parsed_->layer.children("WavelengthData")) {
        const std::string wavelength = wordOf(data, "Wavelength");
        const double nanometres = nanometresOf(
            offsetOf(data), data.child("Wavelength").attribute("unit").value(), wavelength);
        for (const auto& node : data.children("WavelengthDataBlock")) {
            BsdfBlock block;
            block.wavelength = nanometres > 0 ? fmt::format("{} nm", nanometres) : wavelength;
            block.nanometres = nanometres;
            block.direction = wordOf(node, "WavelengthDataDirection");
            block.columnBasis = wordOf(node, "ColumnAngleBasis");
            block.rowBasis = wordOf(node, "RowAngleBasis");
            block.squareBasis = wordOf(node, "AngleBasis");
            block.offset = block.dataOffset = offsetOf(node);
            const pugi::xml_node scattering = node.child("ScatteringData");
            const pugi::xml_node text = scattering.first_child();
            if (text) {
                if (text.next_sibling() || *text.value() == 0) {
                    throw error(offsetOf(scattering),
                                "ScatteringData is interrupted by another element, expected "
                                "nothing but numbers");
                }
                block.data = text.value();
                block.dataOffset = offsetOf(text);
            }
            blocks_.push_back(std::move(block));
        }
    }
    if (blocks_.empty()) {
        throw error(offsetOf(parsed_->layer), "Layer holds no WavelengthDataBlock");
    }
}

}  // namespace hshfit::brdfs
