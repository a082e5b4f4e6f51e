#pragma once

#include <brdfs/measured/bsdf_xml/selection.h>
#include <brdfs/measured/measured_brdf.h>
#include <brdfs/rows/format.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Opens the reflection or the transmission of one side (selectBlocks) from a BSDF XML file:
/// matrices of patch pairs (klems_brdf.h) or tensor trees (tree_brdf.h). Values are f in 1/sr. The
/// bytes are not needed after opening. Throws InputError with the line for invalid content.
std::unique_ptr<MeasuredBrdf> openBsdfXml(std::span<const unsigned char> bytes, std::string name,
                                          std::optional<BsdfSide> side = BsdfSide::front,
                                          std::string_view wavelength = "visible");

/// The row of the table of formats.
const Format& bsdfXmlFormat();

}  // namespace hshfit::brdfs
