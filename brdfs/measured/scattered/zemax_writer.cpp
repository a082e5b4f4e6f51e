#include <brdfs/measured/scattered/zemax.h>
#include <brdfs/measured/scattered/zemax_writer.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/printable.h>
#include <hshfit/projection/albedo.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <iterator>
#include <vector>

namespace hshfit::brdfs {
namespace {

struct ZemaxGrid {
    std::vector<double> rotations, incidences, azimuths, radials;
    bool mirrored = false;
};

ZemaxGrid gridFor(const Brdf& brdf, const Parameters& parameters) {
    const auto spread = [](std::size_t count, double last, double power) {
        std::vector<double> angles;
        for (std::size_t k = 0; k < count; ++k)
            angles.push_back(
                last * std::pow(static_cast<double>(k) / static_cast<double>(count - 1), power));
        return angles;
    };
    const auto number = [&](std::string_view name) {
        return static_cast<std::size_t>(parameters.number(name));
    };
    ZemaxGrid grid;
    grid.mirrored = brdf.laws().isotropic && brdf.laws().mirrorSymmetric;
    grid.incidences = spread(number("incidences"), parameters.number("last"), 1);
    grid.radials = spread(number("radials"), 90 + parameters.number("last"), 2);
    const std::size_t around = number("azimuths");
    grid.azimuths =
        spread(grid.mirrored ? around / 2 + 1 : around + 1, grid.mirrored ? 180 : 360, 1);
    const std::size_t turns = brdf.laws().isotropic ? 1 : number("rotations");
    for (std::size_t k = 0; k < turns; ++k)
        grid.rotations.push_back(360 * static_cast<double>(k) / static_cast<double>(turns));
    return grid;
}

void writeHead(const Brdf& brdf, const ZemaxGrid& grid, fmt::memory_buffer& text) {
    const auto list = [&](std::string_view name, const std::vector<double>& angles) {
        fmt::format_to(std::back_inserter(text), "{}\t{}\n{}\n", name, angles.size(),
                       fmt::join(angles, "\t"));
    };
    fmt::format_to(std::back_inserter(text),
                   "# {}\nSource\tMeasured\nSymmetry\t{}\nSpectralContent\tMonochrome\n"
                   "ScatterType\t{}\n",
                   shortened(printable(brdf.name()), 200),
                   grid.mirrored               ? "PlaneSymmetrical"
                   : grid.rotations.size() > 1 ? "ASymmetrical4D"
                                               : "ASymmetrical",
                   transmits(brdf) ? "BTDF" : "BRDF");
    list("SampleRotation", grid.rotations);
    list("AngleOfIncidence", grid.incidences);
    list("ScatterAzimuth", grid.azimuths);
    list("ScatterRadial", grid.radials);
    fmt::format_to(std::back_inserter(text), "\nMonochrome\nDataBegin\n");
}

void writeTable(const Brdf& brdf, const ZemaxGrid& grid, double rotation, double incidence,
                fmt::memory_buffer& text) {
    auto to = std::back_inserter(text);
    const Direction wi = zemaxPair(rotation, incidence, 0, 0).wi;
    fmt::format_to(to, "TIS\t{:.6g}\n", directionalReflectance(brdf, wi, 1e-3)[0]);
    for (const double azimuth : grid.azimuths) {
        for (std::size_t r = 0; r < grid.radials.size(); ++r) {
            const Direction wo = zemaxPair(rotation, incidence, azimuth, grid.radials[r]).wo;
            double f = 0;
            if (wo.z > 0) brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, &f);
            if (!std::isfinite(f))
                throw NumericError(fmt::format(
                    "{}: f is {} at theta_i {:.4g}, theta_o {:.4g} degrees; a table holds finite "
                    "values",
                    brdf.name(), f, incidence, degrees(polarAngle(wo))));
            fmt::format_to(to, "{}{}", r == 0 ? "" : "\t", f);
        }
        text.push_back('\n');
    }
}

std::vector<std::string> writeZemax(const Brdf& brdf, const std::string& path,
                                    const Parameters& parameters, const WriteOptions& options) {
    if (brdf.channels().count() != 1)
        throw UsageError(
            fmt::format("{}: has {} channels; a Zemax table has one value: convert "
                        "grey:SPEC",
                        brdf.name(), brdf.channels().count()));
    const ZemaxGrid grid = gridFor(brdf, parameters);
    AtomicFile file(path,
                    options.force ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse);
    fmt::memory_buffer text;
    writeHead(brdf, grid, text);
    std::size_t done = 0;
    for (const double rotation : grid.rotations)
        for (const double incidence : grid.incidences) {
            writeTable(brdf, grid, rotation, incidence, text);
            file.write(std::string_view(text.data(), text.size()));
            text.clear();
            if (options.progress)
                options.progress(++done, grid.rotations.size() * grid.incidences.size());
        }
    file.write("DataEnd\n");
    brdf.checkIntact();
    file.commit();
    return {
        fmt::format("{} incidences to {:.4g} degrees, {} azimuths and {} radial angles about "
                    "the mirror direction, {} rotations; values of 0 are read as not measured",
                    grid.incidences.size(), grid.incidences.back(), grid.azimuths.size(),
                    grid.radials.size(), grid.rotations.size())};
}

}  // namespace

const Writer& zemaxWriter() {
    static const Writer writer{
        .name = "zemax",
        .help = "Tabular BSDF data of Zemax: a grey BRDF or BTDF about its specular directions",
        .extension = ".bsdf",
        .parameters = {{.name = "incidences",
                        .help = "number of angles of incidence",
                        .fallback = 10,
                        .min = 2,
                        .max = 1000},
                       {.name = "last",
                        .help = "largest angle of incidence in degrees",
                        .fallback = 85,
                        .min = 1,
                        .max = 89.999},
                       {.name = "azimuths",
                        .help = "number of azimuths around the circle, even",
                        .fallback = 36,
                        .min = 2,
                        .max = 1000},
                       {.name = "radials",
                        .help = "number of angles from the mirror direction",
                        .fallback = 46,
                        .min = 2,
                        .max = 1000},
                       {.name = "rotations",
                        .help = "number of rotations of an anisotropic sample",
                        .fallback = 12,
                        .min = 1,
                        .max = 360}},
        .write = writeZemax,
    };
    return writer;
}

}  // namespace hshfit::brdfs
