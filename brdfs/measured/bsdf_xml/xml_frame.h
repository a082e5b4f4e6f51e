#pragma once

#include <brdfs/catalog.h>
#include <brdfs/measured/bsdf_xml/cell_averages.h>
#include <brdfs/measured/bsdf_xml/document.h>
#include <brdfs/measured/bsdf_xml/selection.h>

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The contents of a BSDF XML file with one block of reflection.
struct BsdfXmlContent {
    std::string material;  ///< name of the material
    BsdfSide side = BsdfSide::front;
    BsdfDocument::Structure structure = BsdfDocument::Structure::columns;
    const AngleBasis* basis = nullptr;  ///< of rows and columns; null in trees
    std::string scatteringData;
};

/// Writes the elements that Radiance and WINDOW expect, in the order of BSDF-v1.4.xsd, through an
/// AtomicFile. Throws OutputError.
void writeBsdfXml(const BsdfXmlContent& content, const std::string& path,
                  const WriteOptions& options);

/// "side", "tolerance" and "evaluations", which all writers of this format have.
std::vector<Parameter> commonWriterParameters();
BsdfSide sideOf(const Parameters& parameters);

/// Appends a sentence if some averages did not converge.
void reportUncertain(const CellAverages& averages, std::vector<std::string>& alterations);

}  // namespace hshfit::brdfs
