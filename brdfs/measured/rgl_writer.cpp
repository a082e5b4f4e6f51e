#include <brdfs/measured/rgl_pbrt.h>
#include <brdfs/measured/rgl_writer.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/files/tensor_file_writer.h>

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace hshfit::brdfs {
namespace {

std::vector<float> floats(const std::vector<double>& values) {
    return {values.begin(), values.end()};
}

/// From [slice][row][column][channel] to [slice][channel][row][column].
std::vector<float> byChannel(const Spectra& spectra) {
    std::vector<float> values(spectra.values.size());
    const std::size_t square = spectra.rows * spectra.columns, n = spectra.channels;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t slice = i / (square * n), vertex = i / n % square;
        values[(slice * n + i % n) * square + vertex] = spectra.values[i];
    }
    return values;
}

/// The luminance that renderers sample by: f cos(theta_o) per area of the square, not negative.
/// No slice is all 0, since it could not be normalised.
std::vector<float> luminances(const RglTables& tables) {
    const Spectra& spectra = tables.spectra;
    const std::size_t n = spectra.channels, square = spectra.rows * spectra.columns;
    std::vector<float> values(spectra.values.size() / n, 0.0F);
    tbb::parallel_for(std::size_t{0}, values.size() / square, [&](std::size_t slice) {
        float* to = values.data() + slice * square;
        std::vector<double> colour(n);
        for (std::size_t i = 0; i < square; ++i) {
            const float* from = spectra.values.data() + (slice * square + i) * n;
            std::copy_n(from, n, colour.begin());
            const auto node = tables.node(slice, i / spectra.columns, i % spectra.columns);
            const double density = tables.normals->density(node.u, node.v, slice);
            if (!(node.wo.z > 0) || !(density > 0)) continue;
            // d omega_o = 4 (wi . h) d omega_h, and wi . h = sqrt((1 + wi . wo) / 2).
            const double across = 4 * std::sqrt(std::max(1 + dot(node.wi, node.wo), 0.0) / 2);
            to[i] = static_cast<float>(std::max(brightness(tables.channels, colour.data()), 0.0) *
                                       node.factor * across * normalsJacobian(node.u) / density);
        }
        if (std::all_of(to, to + square, [](float v) { return v == 0; })) {
            std::fill_n(to, square, 1.0F);
        }
    });
    return values;
}

void keepChannels(RglTables& tables, const std::vector<std::size_t>& kept) {
    Spectra& spectra = tables.spectra;
    const std::size_t n = spectra.channels;
    std::vector<float> values;
    values.reserve(spectra.values.size() / n * kept.size());
    for (std::size_t i = 0; i < spectra.values.size(); i += n) {
        for (const std::size_t k : kept) values.push_back(spectra.values[i + k]);
    }
    std::vector<double> wavelengths;
    for (const std::size_t k : kept) wavelengths.push_back(tables.channels.wavelengths[k]);
    tables.channels = Channels::spectral(wavelengths);
    spectra.values = std::move(values);
    spectra.channels = kept.size();
}

RglTables copyOf(const RglTables& tables) {
    RglTables copy;
    copy.description = tables.description;
    copy.incident = tables.incident;
    copy.reduction = tables.reduction;
    copy.isotropic = tables.isotropic;
    copy.jacobian = tables.jacobian;
    copy.ndf = tables.ndf;
    copy.sigma = tables.sigma;
    copy.normals = std::make_unique<VisibleNormals>(*tables.normals);
    copy.spectra = tables.spectra;
    copy.channels = tables.channels;
    return copy;
}

/// The wavelengths that `first_nm`, `last_nm` and `every` select.
std::vector<std::size_t> keptChannels(const Brdf& brdf, const Parameters& parameters) {
    const double first = parameters.number("first_nm"), last = parameters.number("last_nm");
    const auto every = static_cast<std::size_t>(parameters.number("every"));
    const std::vector<double>& wavelengths = brdf.channels().wavelengths;
    std::vector<std::size_t> kept;
    std::size_t among = 0;
    for (std::size_t i = 0; i < wavelengths.size(); ++i) {
        if (wavelengths[i] < first || wavelengths[i] > last) continue;
        if (among++ % every == 0) kept.push_back(i);
    }
    if (kept.empty() && !wavelengths.empty()) {
        throw UsageError(
            fmt::format("{}: none of its wavelengths ({} to {} nm) is between {} and "
                        "{} nm",
                        brdf.name(), wavelengths.front(), wavelengths.back(), first, last));
    }
    return kept;
}

bool isSet(const Parameters& parameters, std::string_view name) {
    return parameters.number(name) > 0;
}

std::size_t chosen(const Parameters& parameters, std::string_view name, std::size_t otherwise) {
    const double value = parameters.number(name);
    if (!(value > 0)) return otherwise;
    if (value != std::floor(value)) {
        throw UsageError(fmt::format("rgl: {} is {}, expected a whole number", name, value));
    }
    return static_cast<std::size_t>(value);
}

bool isForPbrt(const Parameters& parameters) {
    return parameters.choice("for") == "pbrt";
}

RglResolution resolutionOf(const Brdf& brdf, const Parameters& parameters) {
    RglResolution resolution;
    if (!brdf.laws().isotropic) {
        resolution.theta = 16;
        resolution.slice = 32;
        resolution.normals = 64;
    }
    resolution.theta = chosen(parameters, "theta", resolution.theta);
    resolution.phi = chosen(parameters, "phi", resolution.phi);
    resolution.slice = chosen(parameters, "slice", resolution.slice);
    resolution.normals = chosen(parameters, "normals", resolution.normals);
    if (isSet(parameters, "floor")) resolution.floor = parameters.number("floor");
    if (isSet(parameters, "share")) resolution.share = parameters.number("share");
    const std::string from = parameters.choice("from");
    if (from == "retro-reflection") resolution.from = NormalsFrom::retroReflection;
    if (from == "average") resolution.from = NormalsFrom::average;
    if (from == "uniform") resolution.from = NormalsFrom::uniform;
    resolution.wholeCircle = isForPbrt(parameters);
    return resolution;
}

/// An RGL source keeps its tables unless an option changes them.
RglTables tablesOf(const Brdf& brdf, const Parameters& parameters, const WriteOptions& options,
                   std::vector<std::string>& alterations) {
    const auto* source = dynamic_cast<const RglBrdf*>(&brdf);
    const std::array sampling = {"theta", "phi", "slice", "normals", "floor", "share"};
    const bool kept =
        parameters.choice("from") == "auto" &&
        std::ranges::none_of(sampling, [&](const char* name) { return isSet(parameters, name); });
    const bool whole = source == nullptr || source->tables().reduction < 2;
    if (source != nullptr && kept && (whole || !isForPbrt(parameters)))
        return copyOf(source->tables());
    return sampleRgl(brdf, resolutionOf(brdf, parameters), options, alterations);
}

std::vector<std::string> writeRgl(const Brdf& brdf, const std::string& path,
                                  const Parameters& parameters, const WriteOptions& options) {
    requireReflection(brdf, "rgl");
    std::vector<std::string> alterations;
    const Channels& channels = brdf.channels();
    if (channels.kind == Channels::Kind::grey) {
        alterations.emplace_back("grey is stored as three equal channels");
    }
    const std::vector<std::size_t> kept = keptChannels(brdf, parameters);
    RglTables tables = tablesOf(brdf, parameters, options, alterations);
    if (kept.size() < channels.wavelengths.size()) {
        alterations.push_back(
            fmt::format("{} of {} wavelengths are kept", kept.size(), channels.wavelengths.size()));
        keepChannels(tables, kept);
    }
    if (brdf.laws().reciprocal) {
        alterations.emplace_back(
            "reciprocity is kept within the error of interpolation only: the format holds both "
            "sides");
    }
    if (isForPbrt(parameters)) makeFitForPbrt(tables, alterations);
    writeRglTables(tables, path, options);
    return alterations;
}

Parameter count(std::string_view name, std::string_view help, double min, double max) {
    return {.name = name, .help = help, .fallback = 0, .min = min, .max = max, .choices = {}};
}

}  // namespace

void writeRglTables(const RglTables& tables, const std::string& path, const WriteOptions& options) {
    const Spectra& spectra = tables.spectra;
    const std::uint64_t azimuths = tables.incident.phi.size();
    const std::uint64_t elevations = tables.incident.theta.size();
    const std::array<std::uint32_t, 2> version = {1, 0};
    const std::vector<float> phi = floats(tables.incident.phi);
    const std::vector<float> theta = floats(tables.incident.theta);
    const std::vector<float> wavelengths = floats(tables.channels.wavelengths);
    const std::vector<float> densities = tables.normals->densities();
    const std::vector<float> luminance = luminances(tables), colours = byChannel(spectra);
    const std::string jacobian(1, tables.jacobian ? '\1' : '\0');
    const bool spectral = tables.channels.kind == Channels::Kind::spectral;

    TensorFileWriter writer;
    writer.add("version", {2}, version);
    writer.add("description", tables.description);
    writer.add("phi_i", {azimuths}, phi);
    writer.add("theta_i", {elevations}, theta);
    if (spectral) writer.add("wavelengths", {wavelengths.size()}, wavelengths);
    writer.add("sigma", {tables.sigma.rows, tables.sigma.columns}, tables.sigma.values);
    writer.add("ndf", {tables.ndf.rows, tables.ndf.columns}, tables.ndf.values);
    writer.add("vndf", {azimuths, elevations, tables.normals->rows(), tables.normals->columns()},
               densities);
    writer.add("luminance", {azimuths, elevations, spectra.rows, spectra.columns}, luminance);
    writer.add(spectral ? "spectra" : "rgb",
               {azimuths, elevations, spectra.channels, spectra.rows, spectra.columns}, colours);
    writer.add("jacobian", jacobian);
    writer.write(path,
                 options.force ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse);
}

const Writer& rglWriter() {
    static const Writer writer{
        .name = "rgl",
        .help = "RGL adaptive parameterisation, isotropic or not, RGB or spectral",
        .extension = ".bsdf",
        .parameters =
            {count("theta", "incident elevations (else 32, 16 if anisotropic)", 2, 512),
             count("phi", "incident azimuths of a quarter circle (else 9)", 2, 256),
             count("slice", "colours per side of a slice (else 96, 32 if anisotropic)", 2, 1024),
             count("normals", "normals per side of their grid (else 128, 64 if anisotropic)", 2,
                   1024),
             count("floor", "share of a Lambertian distribution of normals (else 0.05)", 1e-6, 1),
             count("share", "evenly spread share of the normals seen (else 0.5)", 1e-9, 1),
             {.name = "from",
              .help = "what the distribution of normals is estimated from",
              .kind = Parameter::Kind::choice,
              .fallback = {},
              .choices = {"auto", "retro-reflection", "average", "uniform"}},
             {.name = "for",
              .help = "pbrt: pbrt-v4, which takes spectra and whole circles alone",
              .kind = Parameter::Kind::choice,
              .fallback = {},
              .choices = {"any", "pbrt"}},
             {.name = "first_nm",
              .help = "shortest wavelength kept",
              .fallback = 1,
              .min = 1,
              .max = 1e6,
              .choices = {}},
             {.name = "last_nm",
              .help = "longest wavelength kept",
              .fallback = 1e6,
              .min = 1,
              .max = 1e6,
              .choices = {}},
             {.name = "every",
              .help = "of these, every how many is kept",
              .fallback = 1,
              .min = 1,
              .max = 1e4,
              .choices = {}}},
        .write = writeRgl,
    };
    return writer;
}

}  // namespace hshfit::brdfs
