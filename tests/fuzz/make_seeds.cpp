// make_seeds FOLDER: FOLDER/fuzz_NAME with small synthetic inputs for each target to start from.

#include "seed_files.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/light/catalog.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/named_arrays.h>

#include <brdfs/bsdf_xml_text.h>
#include <brdfs/tensor_writer.h>
#include <gpu/containers/container_samples.h>
#include <lib/coefficient_files/coefficient_samples.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>

namespace {

using hshfit::test::pbsdfFields;
using hshfit::test::put;
using hshfit::test::RglShape;
using hshfit::test::tensorFile;

RglShape small(std::vector<float> phi, std::uint64_t channels, bool jacobian) {
    return {.phi = std::move(phi),
            .theta = {0.0F, 1.5F},
            .normalRows = 2,
            .normalColumns = 3,
            .colourRows = 2,
            .colourColumns = 2,
            .channels = channels,
            .jacobian = jacobian};
}

std::string merlScript(std::int32_t azimuths, std::uint8_t length, std::uint8_t mode, double bad) {
    std::string bytes;
    for (const std::int32_t size : {90, 90, azimuths}) put(bytes, size);
    put(bytes, length);
    put(bytes, mode);
    for (const std::uint32_t cell : {0u, 500000u, 1457999u, 2000000u, 4373999u}) {
        put(bytes, cell);
        put(bytes, cell % 1000 == 0 ? bad : 1.5);
    }
    return bytes;
}

std::string mitFile(std::int32_t half, float value) {
    std::string bytes;
    for (const std::int32_t field : {2, 3, 4, 2, 0, 0, 1, 0, 0, half, 3, 0, 0, 0, 0, 0}) {
        put(bytes, field);
    }
    for (int i = 0; i < 3 * 2 * 3 * 4 * 2; ++i) put(bytes, i % 7 == 6 ? value : 0.1F);
    return bytes;
}

std::string utiaScript(std::uint8_t choice, double value) {
    std::string bytes;
    put(bytes, choice);
    put(bytes, 0.25);
    for (const std::uint32_t index : {0u, 100u, 82943u, 160000u, 248831u}) {
        put(bytes, index);
        put(bytes, value);
    }
    return bytes;
}

/// Slices with the attributes of ours, and pictures without them.
void pictures(const std::filesystem::path& folder) {
    using namespace hshfit;
    std::filesystem::create_directories(folder);
    int number = 0;
    const std::vector<std::vector<std::string>> channels = {
        {"R", "G", "B"}, {"Y"}, {"450nm", "550,5nm"}, {"Y", "phi000.Y"}};
    for (const auto& names : channels) {
        for (const ExrPixels pixels : {ExrPixels::half, ExrPixels::single}) {
            ExrPicture picture{.width = 3, .height = 4, .channels = names};
            picture.values.assign(12 * names.size(), 0.25F);
            if (number % 2 == 1) {
                picture.attributes = {{"hshfit:slices", "1"},
                                      {"hshfit:theta_half", number % 4 == 1 ? "root" : "linear"},
                                      {"hshfit:phi_period", "180"},
                                      {"hshfit:phi_difference", names.size() == 2 ? "90 0" : "90"}};
            }
            AtomicFile file(folder / (std::to_string(number++) + ".exr"));
            writeExrPicture(picture, pixels, file);
            file.commit();
        }
    }
}

void utiaPicture(const std::filesystem::path& folder) {
    using namespace hshfit;
    ExrPicture picture{.width = 288, .height = 288, .channels = {"R", "G", "B"}};
    picture.values.assign(288 * 288 * 3, 0.25F);
    AtomicFile file(folder / "picture.exr");
    writeExrPicture(picture, ExrPixels::half, file);
    file.commit();
}

/// Pictures of light behind a byte that chooses layout and curve (fuzz_pictures.cpp).
void lightPictures(const std::filesystem::path& folder) {
    using namespace hshfit;
    struct Shape {
        std::size_t width, height;
        char layout;
    };
    int number = 0;
    for (const Shape& shape : {Shape{8, 4, 0},
                               {5, 5, 1},
                               {5, 5, 2},
                               {8, 6, 3},
                               {6, 8, 3},
                               {12, 2, 4},
                               {2, 12, 4},
                               {8, 4, 7}}) {
        ExrPicture picture{
            .width = shape.width, .height = shape.height, .channels = {"B", "G", "R"}};
        picture.values.assign(3 * shape.width * shape.height, 0.5F);
        const std::filesystem::path exr = folder / "seed.exr";
        std::filesystem::create_directories(folder);
        AtomicFile file(exr);
        writeExrPicture(picture, ExrPixels::half, file);
        file.commit();
        std::ifstream in(exr, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(in), {}};
        const char choice = static_cast<char>(shape.layout + 8 * 7);
        writeSeed(folder / std::to_string(number++), choice + bytes);
        std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " +
                          std::to_string(shape.height) + " +X " + std::to_string(shape.width) +
                          "\n";
        std::string pfm =
            "PF\n" + std::to_string(shape.width) + " " + std::to_string(shape.height) + "\n-1.0\n";
        std::string ppm =
            "P6\n" + std::to_string(shape.width) + " " + std::to_string(shape.height) + "\n255\n";
        for (std::size_t k = 0; k < shape.width * shape.height; ++k) {
            hdr += "\x40\x80\x20\x81";
            ppm += "\x10\x20\x30";
            for (const float v : {1.F, 0.5F, 2.F}) put(pfm, v);
        }
        writeSeed(folder / std::to_string(number++), choice + hdr);
        writeSeed(folder / std::to_string(number++), choice + pfm);
        writeSeed(folder / std::to_string(number++), static_cast<char>(shape.layout + 8) + ppm);
        std::filesystem::remove(exr);
    }
}

void lightSpecifications(const std::filesystem::path& folder) {
    int number = 0;
    for (const hshfit::LightKind& kind : hshfit::lightKinds())
        writeSeed(folder / std::to_string(number++), std::string(kind.example));
    for (const char* text :
         {"sky:type=12,elevation=40+sun:elevation=40,irradiance=1e+3,turn=-90",
          "uniform: + panel:roll=30,scale=2", "none.hdr:layout=angular,curve=srgb"})
        writeSeed(folder / std::to_string(number++), text);
}

void weatherFile(const std::filesystem::path& folder) {
    writeSeed(
        folder / "two",
        "LOCATION,A,-,B,C,1,52.3,4.77,1,-2\nDESIGN CONDITIONS,0\nDATA PERIODS,1,1,Data,Sunday,"
        "1/ 1,12/31\n1995,1,1,1,60,?9,5,1,79,99900,0,1415,288,0,0,0,0\n"
        "1996,6,21,13,60,?9,5,1,79,99900,1200,1325,288,800,700,150,0\n");
}

/// Tables of the Hosek-Wilkie sky with the same made-up numbers everywhere.
void skyTables(const std::filesystem::path& folder) {
    for (const std::string space : {"RGB", "XYZ"}) {
        std::string text = "// Made up.\n";
        for (const char channel : {'1', '2', '3'}) {
            text += "double dataset" + space + channel + "[] = {\n";
            for (int row = 0; row < 120; ++row) text += "-1,-2e-1,1,2,-2,.5,.1,1,.7,\n";
            text += "};\ndouble dataset" + space + "Rad" + channel + "[] = {\n";
            for (int row = 0; row < 20; ++row) text += "1,2,3,4,5,6,\n";
            text += "};\n";
        }
        writeSeed(folder / space, text);
    }
}

void coefficientFiles(const std::filesystem::path& folder) {
    using namespace hshfit;
    std::filesystem::create_directories(folder);
    int number = 0;
    for (const OutgoingSet& outgoing :
         {OutgoingSet::direction(1, 2), OutgoingSet::elevations(3), OutgoingSet::parabolic(4, 5)}) {
        for (const Channels& channels : samples::allChannels()) {
            const auto c = samples::make(outgoing, channels, Quantity::brdf, 2, 1);
            writeCoefficients(c, folder / (std::to_string(number) + ".json"));
            writeCoefficients(c, folder / (std::to_string(number++) + ".exr"));
        }
    }
}

void lightFiles(const std::filesystem::path& folder) {
    using namespace hshfit;
    std::filesystem::create_directories(folder);
    LightCoefficients light;
    light.basis = "sh";
    light.order = 2;
    light.values = samples::randomValues(3 * light.slots(), 1);
    light.energy.value = 1;
    light.curves = {{"sh", {{1, 1, 0.5}}}};
    writeLight(light, folder / "sphere.json");
    light.domain = LightCoefficients::Domain::hemisphere;
    light.basis = "hsh";
    light.channels = Channels::grey();
    light.values.resize(light.slots());
    writeLight(light, folder / "hemisphere.json");
}

/// Coefficient files in forms other than plain coefficients.
void formFiles(const std::filesystem::path& folder) {
    using namespace hshfit;
    const auto c = samples::make(OutgoingSet::elevations(3), Channels::rgb(), Quantity::brdf, 2, 1);
    Representation both;
    both.head = c;
    both.head.outgoing = {};
    both.head.isotropic = both.head.reciprocal = true;
    const auto terms = productTermCount(*bases::make("hsh", 2), symmetryOf(both));
    StoredArray matrix{.shape = {3, terms}, .values = {}};
    for (std::size_t i = 0; i < 3 * terms; ++i) matrix.values.push_back(c.values[i]);
    both.content = MatrixArray{std::move(matrix)};
    int number = 0;
    for (const Representation& form : {fromCoefficients(c), both}) {
        for (Precision precision : {Precision::float32, Precision::unorm16, Precision::unorm8}) {
            for (bool masked : {false, true}) {
                Representation r = form;
                for (const auto& each : namedArrays(r)) {
                    if (masked) keepLargest(*each.array, 5);
                    quantise(*each.array, precision);
                }
                r.steps.push_back({"rounded", 0.5});
                writeRepresentation(r, folder / ("form" + std::to_string(number++) + ".json"));
            }
        }
    }
}

/// Every container of two payloads, and their sidecars.
void gpuFiles(const std::filesystem::path& folder) {
    using namespace hshfit;
    const OutgoingSet maps[] = {OutgoingSet::parabolic(8, 8), OutgoingSet::elevations(3)};
    for (const OutgoingSet& map : maps) {
        const Coefficients c = samples::asymmetric("hsh", 2, map, Channels::rgb(), 1);
        const std::string name = map.spec();
        test::exportTo(folder, gpu::pack(c, {}), {}, {}, name);
        test::exportTo(folder, gpu::pack(c, {}), {"ktx2"}, {.zstd = true}, name + "z");
        test::exportTo(folder, gpu::pack(c, {.number = gpu::Number::unorm8}), {}, {}, name + "u");
    }
}

void bsdfXmlFiles(const std::filesystem::path& folder) {
    using namespace hshfit::test;
    const std::vector<KlemsRing> two{{0, 45, 1}, {45, 90, 2}};
    const std::string nine = "1 2 3\n4, 5, 6\n7 8 9", square = "LBNL/Shirley-Chiu";
    std::vector<std::string> files;
    for (const char* structure : {"Columns", "Rows"}) {
        files.push_back(bsdfXml(structure, basisXml("Two", two),
                                blockXml("Reflection Front", nine, "Two") +
                                    blockXml("Reflection Back", nine, "Two", "Solar") +
                                    blockXml("Reflection Front", nine, "Two", "CIE-X") +
                                    blockXml("Reflection Front", nine, "Two", "CIE-Z")));
    }
    const char* trees[] = {"{{1}{2}{3}{4}{5}{6}{7}{1 2 3 4 5 6 7 8}}",
                           "{1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16}"};
    for (const int rank : {3, 4}) {
        files.push_back(bsdfXml("TensorTree" + std::to_string(rank), "",
                                blockXml("Reflection Front", trees[rank - 3], square) +
                                    blockXml("Reflection Front", "{ 0.2 }", square, "CIE-u") +
                                    blockXml("Reflection Front", "{ 0.5 }", square, "CIE-v")));
    }
    int number = 0;
    for (const std::string& file : files) {
        for (const char first : {'\0', '\3'}) {
            writeSeed(folder / std::to_string(number++), std::string(1, first) + file);
        }
    }
}

/// Small files of the formats of scattered samples.
void scatteredFiles(const std::filesystem::path& folder) {
    const std::string mueller = ",0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
    writeSeed(folder / "fuzz_alta" / "text",
              "#DIM 4 1\n#VS 2\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n0.1 0 0.2 0 1 0.9 1.1\n");
    writeSeed(folder / "fuzz_alta" / "stream",
              "#DIM 2 1\n#PARAM_IN STARK_2D\n#FORMAT binary\n#SAMPLE_COUNT 1\n#ENDIAN little\n"
              "#BEGIN_STREAM\n" +
                  std::string(24, '\0') + "\n#END_STREAM\n");
    writeSeed(folder / "fuzz_alta" / "function",
              "#ALTA FUNC HEADER\n#DIM 6 1\n#FUNC nonlinear_function_diffuse\nkd 0.25\n"
              "#FUNC nonlinear_function_blinn\nKs 2\nN 3\n");
    writeSeed(folder / "fuzz_alta" / "rational",
              "#ALTA FUNC HEADER\n#CMD --sg-type half\n#DIM 2 1\n#PARAM_IN RUSIN_TH_TD\n"
              "#FUNC rational_function\n#MIN 0 0\n#MAX 1.5 1.5\n#BASIS LEGENDRE\n#NP 2\n#NQ 2\n"
              "0 0 1\n1 0 -.5\n0 0 1\n0 2 .5\n"
              "#FUNC nonlinear_function_spherical_gaussian\nKs 1\nN 9\n"
              "#FUNC nonlinear_fresnel_schlick\nR 0.1\n"
              "#FUNC nonlinear_function_abc\n#PARAM COS_TH\na 1\nb 2\nc 3\n");
    writeSeed(folder / "fuzz_astm" / "spectral",
              "NUM_POINTS 1\nVARS theta_i,phi_i,theta_s,phi_s,400nm\n0.1,0,0.2,0,1\n");
    writeSeed(folder / "fuzz_cornell" / "two", "# x\n2\n400 500\n0.1 0 0.2 0.3 1 2\n");
    writeSeed(folder / "fuzz_csv" / "rows",
              "wavelength (um),theta_i (deg),phi_i,theta_o,phi_o,brf,sigma (%),scan\n"
              "0.5,30,0,40,180,1,2,1\n0.6,30,0,40,180,1,2,1\n");
    writeSeed(folder / "fuzz_csv" / "plane", "BRF\nAOI;View_angle;500nm;600nm\n10;-10;0,5;0,25\n");
    writeSeed(folder / "fuzz_nist" / "two", "lambda,thetai,phi,thetar,phir\n0.633,-30,0,45,10,0.3" +
                                                mueller + "0.532,-30,0,45,10,0.3" + mueller);
    writeSeed(folder / "fuzz_scatmech" / "three",
              "1, 1, 2, 0, 0, 0, 0, 0.5\n1, 1, 3, 1, 1, 1, 1, 0.5\n2, 2, 1, 1, -1, 1, 0, 3\n");
}

/// Small files of the formats of optical design programs.
void opticsFiles(const std::filesystem::path& folder) {
    writeSeed(folder / "fuzz_fred" / "two",
              "type bsdf_data\nformat angles=deg bsdf=value scale=1\n10 0\n0 0 0.5\n20 90 0.4\n");
    const std::string zemax =
        "# x\nSource Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\n"
        "ScatterType BRDF\nSampleRotation 1\n0\nAngleOfIncidence 1\n10\nScatterAzimuth 2\n0 180\n"
        "ScatterRadial 2\n0 90\n\nMonochrome\nDataBegin\nTIS 0.1\n0.03 0.03\n0.03 0\nDataEnd\n";
    writeSeed(folder / "fuzz_zemax" / "plane", zemax);
    writeSeed(folder / "fuzz_speos" / "spectral",
              "OPTIS - brdf surface file v8.0\n0\nown\n2\nab\n1 0\n1\n1 1\n30\n550\n20\n2 3\n"
              "0 180 360\n0 1 1 1\n90 1 1 1\nEnd of file\n");
    writeSeed(
        folder / "fuzz_speos" / "anisotropic",
        "OPTIS - Anisotropic BSDF surface file v8.0\n0\nown\n2\nab\n0 1 0\n1 0\n0\n1\n0\n1\n30\n"
        "30 0\n\n2\n400 10\n500 20\n2 2\n0 180\n0 1 1\n60 1 1\nEnd of file\n");
    writeSeed(folder / "fuzz_pab_opto" / "two",
              "#sample_name \"a\"\n#incident_angle 30 180\n#format: theta phi DSF\n30 0 0.4\n"
              "150 0 0.3\n#intheta 150\n#inphi 0\n#format: theta phi BSDF\n"
              "#colorimetry: CIE-Y\n40 0 1\n");
    writeSeed(
        folder / "fuzz_bird" / "two",
        R"({"metadata": {"sample": {"name": "a"}}, "data": {"theta_i": {"unit": "deg",)"
        R"( "values": [1, 2]}, "phi_i": {"unit": "deg", "values": [0, 0]}, "theta_r":)"
        R"( {"unit": "rad", "values": [0.1, 0.1]}, "phi_r": {"unit": "deg", "values":)"
        R"( [0, 90]}, "wavelength_i": {"unit": "nm", "values": [500, 500]}, "polarization_i":)"
        R"( {"notation": "sp", "values": ["u", "u"]}, "uBRDF": {"unit": "%", "values":)"
        R"( [1, 1]}, "BRDF": {"unit": "1/sr", "values": [0.3, 0.2]}}})");
    writeSeed(folder / "fuzz_xompt" / "two",
              R"({"metadata": {"name": "a"}, "brdf": {"wavelengths": [5e-7],)"
              R"( "lookupTable": [[5e-7, 0, 0, 0, 0.3], [5e-7, 0.1, 0, 0, null]]}})");
}

/// Presets, a collection of them, and mixtures of Gaussians of either kind.
void presetFiles(const std::filesystem::path& folder) {
    const std::string head = R"({"format": "hshfit-preset", "version": 1, )";
    writeSeed(folder / "fuzz_presets" / "parameters",
              head +
                  R"("model": "ward", "parameters": {"kd": [0.1, 0.2, 0.3], "ax": 0.2, "ay": 0.5,)"
                  R"( "variant": "duer"}, "source": "none"})");
    writeSeed(folder / "fuzz_presets" / "sum",
              head + R"("spec": "lambert:kd=.5 + 0.5 * ggx:alpha=.2,F0=.1,ks=.5"})");
    writeSeed(folder / "fuzz_presets" / "collection",
              R"({"format": "hshfit-presets", "version": 1, "model": "ggx", "help": "h",)"
              R"( "parameters": {"fresnel": "schlick"}, "source": "none", "materials":)"
              R"( {"a": {"alpha": 0.2, "F0": [0.1, 0.2, 0.3]}, "b": {"alpha": 1}}})");
    for (const bool across : {false, true}) {
        const std::string lobe = std::string(R"({"tilt": 1, "sharpness": 20, )") +
                                 (across ? R"("across": 30, )" : "") +
                                 R"("amplitude": [0.5, 0.25, 0.1]})";
        std::string elevations;
        for (const char* theta : {"0", "45"})
            elevations += std::string(elevations.empty() ? "" : ", ") + R"({"theta": )" + theta +
                          R"(, "lobes": [)" + lobe + ", " + lobe +
                          R"(], "error": 0.1, "albedo": 0.5, "fitted_albedo": 0.5,)"
                          R"( "converged": true})";
        writeSeed(folder / "fuzz_gaussians" / (across ? "asg" : "sg"),
                  std::string(R"({"format": "hshfit-gaussians", "version": 1, "brdf": "ggx",)") +
                      R"( "kind": ")" + (across ? "asg" : "sg") +
                      R"(", "channels": "rgb", "elevations": [)" + elevations + "]}");
    }
}

/// Two materials in a basis and one with terms of its own.
void materialLibraries(const std::filesystem::path& folder) {
    using namespace hshfit::material_library;
    const std::size_t terms = logTerms().size();
    Library library;
    library.basis = {.mean = std::vector<double>(terms, 0.01),
                     .components = std::vector<double>(2 * terms, 0.125),
                     .widths = {4, 6},
                     .step = 0.5};
    for (const char* name : {"a", "b"})
        library.materials.push_back(
            {.name = name, .source = name, .channels = 1, .codes = {90, 1, 2}, .bytes = 3});
    library.materials.push_back({.name = "c",
                                 .source = "c",
                                 .kind = Kind::polynomial,
                                 .channels = 1,
                                 .polynomial = {std::vector<double>(terms, 0.25), {1}},
                                 .bytes = 2 * terms + 4});
    std::filesystem::create_directories(folder);
    hshfit::AtomicFile file((folder / "0").string());
    writeLibrary(library, file);
    file.commit();
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: make_seeds FOLDER\n");
        return 2;
    }
    const std::filesystem::path folder = arguments[1];
    coefficientFiles(folder / "fuzz_coefficients");
    formFiles(folder / "fuzz_coefficients");
    lightFiles(folder / "fuzz_light");
    gpuFiles(folder / "fuzz_gpu_containers");
    scatteredFiles(folder);
    opticsFiles(folder);
    presetFiles(folder);
    bsdfXmlFiles(folder / "fuzz_bsdf_xml");
    lightPictures(folder / "fuzz_pictures");
    lightSpecifications(folder / "fuzz_lights");
    weatherFile(folder / "fuzz_weather");
    skyTables(folder / "fuzz_sky_tables");
    meshSeeds(folder / "fuzz_meshes");
    materialLibraries(folder / "fuzz_material_library");
    int number = 0;
    for (const std::vector<float>& phi :
         {std::vector<float>{0}, {0, 1}, {-3.1415927F, -1.5707964F, 0}, {0, 0.5F, 1.5707964F}}) {
        for (const std::uint64_t channels : {3, 2}) {
            for (const bool jacobian : {true, false}) {
                writeSeed(folder / "fuzz_rgl" / std::to_string(number++),
                          tensorFile(rglFields(small(phi, channels, jacobian))));
            }
        }
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double value : {-1.0, nan, 1e308}) {
        const auto single = static_cast<float>(std::min(value, 1e38));
        for (std::uint8_t choice = 0; choice < 6; ++choice) {
            writeSeed(folder / "fuzz_utia" / std::to_string(number++), utiaScript(choice, value));
        }
        writeSeed(folder / "fuzz_mit" / std::to_string(number++), mitFile(0, single));
        writeSeed(folder / "fuzz_mit" / std::to_string(number++), mitFile(1, single));
        std::string values;
        for (const float v : {0.5F, 0.25F, single}) put(values, v);
        writeSeed(folder / "fuzz_merl_slice" / std::to_string(number++), values);
    }
    utiaPicture(folder / "fuzz_utia");
    pictures(folder / "fuzz_merl_slice");
    for (const bool withAngles : {true, false}) {
        writeSeed(folder / "fuzz_pbsdf" / std::to_string(number++),
                  tensorFile(hshfit::test::pbsdfFields(
                      {.azimuths = 3,
                       .differences = 2,
                       .halves = 2,
                       .wavelengths = {450, 650},
                       .withAngles = withAngles},
                      [](double p, double, double, std::size_t) { return p; })));
    }
    for (std::uint8_t mode = 0; mode < 4; ++mode) {
        writeSeed(folder / "fuzz_merl" / std::to_string(number++), merlScript(180, 0, mode, -1));
        writeSeed(folder / "fuzz_merl" / std::to_string(number++), merlScript(360, 1, mode, nan));
        writeSeed(folder / "fuzz_merl" / std::to_string(number++), merlScript(180, 230, mode, 2));
    }
}
