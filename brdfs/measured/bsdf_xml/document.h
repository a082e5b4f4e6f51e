#pragma once

#include <brdfs/measured/bsdf_xml/angle_basis.h>
#include <hshfit/error.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// One WavelengthDataBlock: the scattering from one side of a surface in one part of the spectrum.
struct BsdfBlock {
    std::string wavelength;  ///< "Visible", "Solar", "CIE-X", …, or "550 nm"
    double nanometres = 0;   ///< of a block for one wavelength; 0: none
    std::string direction;   ///< "Reflection Front", "Transmission Back", …
    std::string columnBasis, rowBasis;
    std::string squareBasis;     ///< "LBNL/Shirley-Chiu" in tensor trees
    std::string_view data;       ///< the text of ScatteringData
    std::size_t dataOffset = 0;  ///< of `data` in the file
    std::size_t offset = 0;      ///< of the block in the file
};

/// The elements of a BSDF XML file (LBNL WINDOW 6 and 7, Radiance) that describe scattering:
///     WindowElement / Optical / Layer / DataDefinition / IncidentDataStructure, AngleBasis …
///     WindowElement / Optical / Layer / WavelengthData / Wavelength, WavelengthDataBlock …
/// Only the first Layer is read. A document type declaration is refused, and with it every
/// entity but the five of XML; so are more than 32 elements within each other, more than
/// 100,000 elements, and more than 1 GiB, all before the text is parsed.
class BsdfDocument {
public:
    enum class Structure { columns, rows, tree3, tree4 };

    static constexpr std::size_t maxBytes = std::size_t{1} << 30;
    static constexpr std::size_t maxDepth = 32, maxElements = 100'000;
    static constexpr std::size_t maxRings = 90, maxPatches = 2048;

    /// `where` (a path) starts every message. `bytes` are not needed afterwards. Throws InputError
    /// with the line for every missing or wrong element; ScatteringData is not read yet.
    BsdfDocument(std::span<const unsigned char> bytes, std::string where);
    ~BsdfDocument();
    BsdfDocument(const BsdfDocument&) = delete;
    BsdfDocument& operator=(const BsdfDocument&) = delete;

    Structure structure() const { return structure_; }
    bool isTree() const { return structure_ == Structure::tree3 || structure_ == Structure::tree4; }
    /// The bases that the file itself defines.
    const std::vector<AngleBasis>& bases() const { return bases_; }
    const std::vector<BsdfBlock>& blocks() const { return blocks_; }
    std::size_t layers() const { return layers_; }
    /// Name and manufacturer of the material; empty if the file has none.
    const std::string& material() const { return material_; }
    const std::string& manufacturer() const { return manufacturer_; }
    const std::string& where() const { return where_; }

    /// "WHERE: line N: MESSAGE" for an offset in the file.
    InputError error(std::size_t offset, std::string_view message) const;

private:
    struct Parsed;
    void check(std::span<const unsigned char> bytes) const;
    void readStructure();
    void readBases();
    void readBlocks();
    double nanometresOf(std::size_t offset, std::string_view unit, std::string_view word) const;

    std::string where_;
    std::unique_ptr<Parsed> parsed_;
    std::vector<std::size_t> lineEnds_;
    Structure structure_ = Structure::columns;
    std::vector<AngleBasis> bases_;
    std::vector<BsdfBlock> blocks_;
    std::size_t layers_ = 0;
    std::string material_, manufacturer_;
};

/// Whether two words are the same but for upper and lower case (ASCII).
bool sameWord(std::string_view a, std::string_view b);

}  // namespace hshfit::brdfs
