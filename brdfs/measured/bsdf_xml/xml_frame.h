#pragma once

#include <brdfs/measured/bsdf_xml/cell_averages.h>
#include <brdfs/measured/bsdf_xml/document.h>
#include <brdfs/measured/bsdf_xml/selection.h>
#include <brdfs/rows/writer.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::brdfs {

/// The contents of a BSDF XML file of visible light.
struct BsdfXmlContent {
    std::string material;  ///< name of the material
    BsdfDocument::Structure structure = BsdfDocument::Structure::columns;
    const AngleBasis* basis = nullptr;  ///< of rows and columns; null in trees
    std::vector<std::pair<BsdfSide, std::string>> blocks = {};  ///< ScatteringData of each kind
};

/// Writes the elements that Radiance and WINDOW expect, in the order of BSDF-v1.4.xsd, through an
/// AtomicFile. Throws OutputError.
void writeBsdfXml(const BsdfXmlContent& content, const std::string& path,
                  const WriteOptions& options);

/// "side", "tolerance" and "evaluations", which all writers of this format have.
std::vector<Parameter> commonWriterParameters();

/// A block to write: its kind and the BRDF that it holds.
struct BsdfPart {
    BsdfSide side;
    std::shared_ptr<const Brdf> brdf;
};
/// The blocks that `side` asks for: one of `brdf`, or with "all" every block of the file that
/// `brdf` was opened from, each opened by its own specification. `brdf` has to outlive them. Throws
/// UsageError where a reflection would be written as a transmission or the reverse, and where
/// `brdf` is of no such file.
std::vector<BsdfPart> partsOf(const Brdf& brdf, const Parameters& parameters);
/// Writes a file of `parts` with the text that `dataOf` gives for each; returns its sentences, of
/// several parts with the name of the block.
std::vector<std::string> writeParts(
    BsdfXmlContent content, const std::vector<BsdfPart>& parts,
    const std::function<std::string(const BsdfPart&, std::vector<std::string>&)>& dataOf,
    const std::string& path, const WriteOptions& options);

/// Appends a sentence if some averages did not converge.
void reportUncertain(const CellAverages& averages, std::vector<std::string>& alterations);

}  // namespace hshfit::brdfs
