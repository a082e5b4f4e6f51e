#include <brdfs/measured/gridded/slice.h>
#include <brdfs/measured/gridded/slice_writer.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/exr_picture.h>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace hshfit::brdfs {
namespace {

constexpr std::size_t mostWritten = std::size_t{1} << 26;
constexpr double largestHalf = 65504;

/// 90 degrees first, then the others in ascending order around the circle.
std::vector<double> azimuths(std::size_t count, double period) {
    std::vector<double> phi;
    for (std::size_t i = 0; i < count; ++i) {
        phi.push_back(
            std::fmod(90 + period * static_cast<double>(i) / static_cast<double>(count), period));
    }
    return phi;
}

std::vector<std::string> colourNames(const Channels& channels) {
    if (channels.kind == Channels::Kind::grey) return {"Y"};
    std::vector<std::string> names = channels.names();
    for (std::string& name : names) std::ranges::replace(name, '.', ',');
    return names;
}

class Sampler {
public:
    Sampler(const Brdf& brdf, const SliceOptions& options)
        : brdf_(brdf),
          options_(options),
          period_(brdf.laws().reciprocal ? 180 : 360),
          phi_(azimuths(options.slices, period_)),
          layout_{.halfCount = options.size,
                  .differenceCount = options.size,
                  .rootHalf = options.rootHalf,
                  .phi = phi_,
                  .period = period_},
          colours_(brdf.channels().count()) {
        picture_ = {.width = options.size, .height = options.size};
        const std::vector<std::string> names = colourNames(brdf.channels());
        if (options.size * options.size > mostWritten / (phi_.size() * names.size())) {
            throw UsageError(fmt::format(
                "{}: {} x {} pixels of {} channels are too many; a "
                "picture has at most {} values",
                brdf.name(), options.size, options.size, phi_.size() * names.size(), mostWritten));
        }
        for (std::size_t i = 0; i < phi_.size(); ++i) {
            for (const std::string& name : names) {
                picture_.channels.push_back(i == 0 ? name : sliceLayerName(phi_[i]) + "." + name);
            }
        }
        picture_.attributes = {
            {"hshfit:slices", "1"},
            {"hshfit:brdf", brdf.name()},
            {"hshfit:quantity", "f in 1/sr"},
            {"hshfit:theta_half", options.rootHalf ? "root" : "linear"},
            {"hshfit:columns", options.rootHalf ? "theta_half = 90 x^2 degrees, x 0 to 1"
                                                : "theta_half 0 to 90 degrees"},
            {"hshfit:rows", "theta_difference 90 to 0 degrees"},
            {"hshfit:phi_period", fmt::format("{}", period_)},
            {"hshfit:phi_difference", fmt::format("{}", fmt::join(phi_, " "))}};
        if (!brdf.laws().isotropic) {
            picture_.attributes["hshfit:phi_half"] = fmt::format("{}", options.phiHalf);
        }
        picture_.values.resize(options.size * options.size * picture_.channels.size());
    }

    void sample(const WriteOptions& options) {
        std::atomic<std::size_t> done = 0;
        tbb::parallel_for(std::size_t{0}, picture_.height, [&](std::size_t row) {
            sampleRow(row);
            const std::size_t rows = ++done;
            if (options.progress) options.progress(rows, picture_.height);
        });
    }

    const ExrPicture& picture() const { return picture_; }

    std::vector<std::string> leftOut() const {
        std::vector<std::string> notes;
        notes.push_back(phi_.size() == 1
                            ? "only phi_d = 90 degrees is written"
                            : fmt::format("only {} values of phi_d are written", phi_.size()));
        if (!brdf_.laws().isotropic) {
            notes.push_back(fmt::format("only half vectors at azimuth {} degrees are written",
                                        options_.phiHalf));
        }
        if (below_ > 0) {
            notes.push_back(
                fmt::format("{} pixels with a direction below the horizon hold 0", below_.load()));
        }
        notes.push_back(options_.halfPixels ? "values are rounded to 11 significant bits"
                                            : "values are rounded to 24 significant bits");
        return notes;
    }

private:
    void sampleRow(std::size_t row) {
        std::vector<double> f(colours_);
        const double thetaDifference =
            layout_.thetaDifference(static_cast<double>(picture_.height - 1 - row));
        for (std::size_t column = 0; column < picture_.width; ++column) {
            const double thetaHalf = layout_.thetaHalf(static_cast<double>(column));
            for (std::size_t i = 0; i < phi_.size(); ++i) {
                const DirectionPair pair = fromHalfDifference(thetaHalf, radians(options_.phiHalf),
                                                              thetaDifference, radians(phi_[i]));
                if (std::min(pair.wi.z, pair.wo.z) < 1e-12) {
                    ++below_;
                    continue;
                }
                brdf_.eval(pair.wo, {&pair.wi.x, &pair.wi.y, &pair.wi.z, 1}, f.data());
                for (std::size_t c = 0; c < colours_; ++c) {
                    check(f[c], thetaHalf, thetaDifference, phi_[i]);
                    picture_.at(row, column, i * colours_ + c) = static_cast<float>(f[c]);
                }
            }
        }
    }

    void check(double f, double thetaHalf, double thetaDifference, double phi) const {
        const double most = options_.halfPixels
                                ? largestHalf
                                : static_cast<double>(std::numeric_limits<float>::max());
        if (f >= 0 && f <= most) return;
        throw NumericError(
            fmt::format("{}: f is {} at theta_h {:.4g}, theta_d {:.4g}, phi_d {} degrees; a pixel "
                        "holds values from 0 to {:.6g}{}",
                        brdf_.name(), f, degrees(thetaHalf), degrees(thetaDifference), phi, most,
                        options_.halfPixels && f > most ? " (pixels=float holds more)" : ""));
    }

    const Brdf& brdf_;
    const SliceOptions& options_;
    double period_;
    std::vector<double> phi_;
    SliceLayout layout_;
    std::size_t colours_;
    ExrPicture picture_;
    std::atomic<std::size_t> below_ = 0;
};

std::vector<std::string> writeRow(const Brdf& brdf, const std::string& path,
                                  const Parameters& parameters, const WriteOptions& options) {
    requireReflection(brdf, "slices");
    const auto count = [&](std::string_view name) {
        const double value = parameters.number(name);
        if (value != std::floor(value)) {
            throw UsageError(fmt::format("slices: {}={} has to be a whole number", name, value));
        }
        return static_cast<std::size_t>(value);
    };
    return writeSlices(brdf, path,
                       {.size = count("size"),
                        .rootHalf = parameters.choice("theta_h") == "root",
                        .halfPixels = parameters.choice("pixels") == "half",
                        .slices = count("slices"),
                        .phiHalf = parameters.number("phi_h")},
                       options);
}

}  // namespace

std::vector<std::string> writeSlices(const Brdf& brdf, const std::string& path,
                                     const SliceOptions& slices, const WriteOptions& options) {
    AtomicFile file(path,
                    options.force ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse);
    Sampler sampler(brdf, slices);
    sampler.sample(options);
    brdf.checkIntact();
    writeExrPicture(sampler.picture(), slices.halfPixels ? ExrPixels::half : ExrPixels::single,
                    file);
    file.commit();
    return sampler.leftOut();
}

const Writer& slicesWriter() {
    static const Writer writer{
        .name = "slices",
        .help = "OpenEXR picture over theta_h and theta_d, at one phi_d or several",
        .extension = ".exr",
        .parameters = {{.name = "size",
                        .help = "pixels a side",
                        .kind = Parameter::Kind::number,
                        .fallback = 512,
                        .min = 1,
                        .max = 8192},
                       {.name = "theta_h",
                        .help = "columns: linear in theta_h, or in its square root",
                        .kind = Parameter::Kind::choice,
                        .fallback = {},
                        .choices = {"linear", "root"}},
                       {.name = "pixels",
                        .help = "32-bit or 16-bit floating-point numbers",
                        .kind = Parameter::Kind::choice,
                        .fallback = {},
                        .choices = {"float", "half"}},
                       {.name = "slices",
                        .help = "how many phi_d, 90 degrees being the first",
                        .kind = Parameter::Kind::number,
                        .fallback = 1,
                        .min = 1,
                        .max = 360},
                       {.name = "phi_h",
                        .help = "azimuth of the half vectors in degrees, if anisotropic",
                        .kind = Parameter::Kind::number,
                        .fallback = 0,
                        .min = -360,
                        .max = 360}},
        .write = writeRow,
    };
    return writer;
}

}  // namespace hshfit::brdfs
