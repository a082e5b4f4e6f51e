#pragma once

#include "bsdf_xml_patches.h"

#include <functional>
#include <string>
#include <vector>

// BSDF XML as text.

namespace hshfit::test {

inline std::string basisXml(const std::string& name, const std::vector<KlemsRing>& rings) {
    std::string xml = "<AngleBasis><AngleBasisName>" + name + "</AngleBasisName>\n";
    for (const KlemsRing& ring : rings) {
        xml += "<AngleBasisBlock><Theta>0</Theta><nPhis>" + std::to_string(ring.azimuths) +
               "</nPhis><ThetaBounds><LowerTheta>" + std::to_string(ring.lower) +
               "</LowerTheta><UpperTheta>" + std::to_string(ring.upper) +
               "</UpperTheta></ThetaBounds></AngleBasisBlock>\n";
    }
    return xml + "</AngleBasis>\n";
}

inline std::string blockXml(const std::string& direction, const std::string& data,
                            const std::string& basis, const std::string& wavelength = "Visible") {
    const bool tree = basis == "LBNL/Shirley-Chiu";
    return "<WavelengthData><LayerNumber>System</LayerNumber>\n<Wavelength unit=\"Integral\">" +
           wavelength + "</Wavelength>\n<WavelengthDataBlock>\n<WavelengthDataDirection>" +
           direction + "</WavelengthDataDirection>\n" +
           (tree ? "<AngleBasis>" + basis + "</AngleBasis>"
                 : "<ColumnAngleBasis>" + basis + "</ColumnAngleBasis><RowAngleBasis>" + basis +
                       "</RowAngleBasis>") +
           "\n<ScatteringDataType>BTDF</ScatteringDataType>\n<ScatteringData>\n" + data +
           "</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n";
}

inline std::string bsdfXml(const std::string& structure, const std::string& basis,
                           const std::string& blocks) {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- made by a test -->\n"
           "<WindowElement xmlns=\"http://windows.lbl.gov\">\n<Optical>\n<Layer>\n"
           "<Material><Name>a &amp; b</Name><Manufacturer>nobody</Manufacturer></Material>\n"
           "<DataDefinition>\n<IncidentDataStructure>" +
           structure + "</IncidentDataStructure>\n" + basis + "</DataDefinition>\n" + blocks +
           "</Layer>\n</Optical>\n</WindowElement>\n";
}

/// value(outgoing, incident) in Columns: each line is an outgoing direction.
inline std::string matrixText(int patches, const std::function<double(int, int)>& value,
                              bool rows = false) {
    std::string text;
    for (int a = 0; a < patches; ++a) {
        for (int b = 0; b < patches; ++b) {
            text += std::to_string(rows ? value(b, a) : value(a, b)) + (b % 2 ? ", " : "\t");
        }
        text += '\n';
    }
    return text;
}

}  // namespace hshfit::test
