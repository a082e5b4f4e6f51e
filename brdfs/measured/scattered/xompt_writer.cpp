#include <brdfs/measured/scattered/xompt_writer.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <iterator>
#include <vector>

namespace hshfit::brdfs {
namespace {

/// An angle as the file states it.
double sixDecimals(double angle) {
    return std::round(angle * 1e6) / 1e6;
}

/// An identifier of the form that the schema asks for, by the checksum of a name: version 8,
/// variant 1 of RFC 9562, free content.
std::string identifierOf(std::string_view name) {
    const std::string digits = sha256(name);
    return fmt::format("{}-{}-8{}-a{}-{}", digits.substr(0, 8), digits.substr(8, 4),
                       digits.substr(13, 3), digits.substr(17, 3), digits.substr(20, 12));
}

std::string metadataOf(const Brdf& brdf, const Parameters& parameters) {
    const auto stated = [&](std::string_view key) {
        const std::string word = parameters.choice(key);
        return word.empty() ? std::string("unknown") : word;
    };
    const std::string name = shortened(printable(brdf.name()), 200);
    nlohmann::ordered_json metadata;
    metadata["name"] = name;
    metadata["uuid"] = identifierOf(name);
    metadata["materialVersion"] = "1.0.0";
    metadata["openMaterial3dVersion"] = "1.0.0";
    metadata["copyrights"] = {stated("author")};
    metadata["license"] = stated("license");
    metadata["authors"] = {stated("author")};
    metadata["sources"] = fmt::format("hshfit {}, from {}", version, name);
    return jsonText(metadata);
}

void checkWritable(const Brdf& brdf) {
    if (brdf.channels().kind == Channels::Kind::rgb)
        throw UsageError(
            fmt::format("{}: is RGB; a look-up table is by wavelength: convert "
                        "grey:SPEC or a spectral BRDF",
                        brdf.name()));
    if (!brdf.laws().isotropic)
        throw UsageError(fmt::format(
            "{}: is not isotropic; a look-up table has the azimuth between the directions alone",
            brdf.name()));
}

std::vector<std::string> writeXompt(const Brdf& brdf, const std::string& path,
                                    const Parameters& parameters, const WriteOptions& options) {
    requireReflection(brdf, "xompt");
    checkWritable(brdf);
    const auto polar = static_cast<std::size_t>(parameters.number("theta"));
    const auto around = static_cast<std::size_t>(parameters.number("phi"));
    const double last = radians(parameters.number("last"));
    std::vector<double> wavelengths = brdf.channels().wavelengths;
    if (wavelengths.empty()) wavelengths = {parameters.number("wavelength")};
    std::vector<std::string> metres;
    for (const double nm : wavelengths) metres.push_back(fmt::format("{}e-9", nm));
    const auto theta = [&](std::size_t k) {
        return sixDecimals(last * static_cast<double>(k) / static_cast<double>(polar - 1));
    };
    AtomicFile file(path,
                    options.force ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse);
    fmt::memory_buffer text;
    fmt::format_to(std::back_inserter(text),
                   "{{\"metadata\": {},\n\"brdf\": {{\"wavelengths\": [{}],\n\"lookupTable\": [",
                   metadataOf(brdf, parameters), fmt::join(metres, ", "));
    std::vector<double> values(wavelengths.size());
    std::size_t rows = 0;
    for (std::size_t c = 0; c < wavelengths.size(); ++c) {
        for (std::size_t i = 0; i < polar; ++i)
            for (std::size_t o = 0; o < polar; ++o)
                for (std::size_t p = 0; p < (o == 0 ? 1 : around); ++p) {
                    const double phi =
                        sixDecimals(2 * pi * static_cast<double>(p) / static_cast<double>(around));
                    const Direction wi = directionFromAngles(theta(i), 0);
                    const Direction wo = directionFromAngles(theta(o), phi);
                    brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, values.data());
                    if (!std::isfinite(values[c]))
                        throw NumericError(fmt::format(
                            "{}: f is {} at theta_i {}, theta_o {} radians; a table holds finite "
                            "values",
                            brdf.name(), values[c], theta(i), theta(o)));
                    fmt::format_to(std::back_inserter(text), "{}\n[{}, {}, {}, {}, {}]",
                                   rows++ == 0 ? "" : ",", metres[c], theta(i), theta(o), phi,
                                   values[c]);
                    if (text.size() < std::size_t{1} << 20) continue;
                    file.write(std::string_view(text.data(), text.size()));
                    text.clear();
                }
        file.write(std::string_view(text.data(), text.size()));
        text.clear();
        if (options.progress) options.progress(c + 1, wavelengths.size());
    }
    file.write("\n]}}\n");
    brdf.checkIntact();
    file.commit();
    return {fmt::format("{} rows: {} polar angles from 0 to {} degrees, {} azimuths", rows, polar,
                        parameters.number("last"), around)};
}

}  // namespace

const Writer& xomptWriter() {
    static const Writer writer{
        .name = "xompt",
        .help = "Look-up tables of ASAM OpenMATERIAL: an isotropic BRDF, grey or spectral",
        .extension = ".xompt",
        .parameters = {{.name = "theta",
                        .help = "number of polar angles of each direction",
                        .fallback = 18,
                        .min = 2,
                        .max = 1000},
                       {.name = "phi",
                        .help = "number of azimuths around the circle",
                        .fallback = 24,
                        .min = 2,
                        .max = 1000},
                       {.name = "last",
                        .help = "largest polar angle in degrees",
                        .fallback = 85,
                        .min = 1,
                        .max = 89.999},
                       {.name = "wavelength",
                        .help = "nm, of a grey BRDF",
                        .fallback = 550,
                        .min = 1,
                        .max = 1e6},
                       {.name = "license",
                        .help = "licence of the material, for the metadata",
                        .kind = Parameter::Kind::text,
                        .choices = {"CC-BY-4.0"}},
                       {.name = "author",
                        .help = "author and holder of the copyright, for the metadata",
                        .kind = Parameter::Kind::text,
                        .choices = {"ACME"}}},
        .write = writeXompt,
    };
    return writer;
}

}  // namespace hshfit::brdfs
