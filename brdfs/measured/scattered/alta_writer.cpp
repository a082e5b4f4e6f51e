#include <brdfs/measured/scattered/alta_writer.h>
#include <brdfs/measured/scattered/scattered.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <vector>

namespace hshfit::brdfs {
namespace {

struct Grid {
    std::size_t theta = 0, phi = 0;
    double last = 0;  ///< radians
};

/// The rows of a file and the header for them.
class Rows {
public:
    Rows(const Brdf& brdf, AtomicFile& file) : brdf_(brdf), file_(file) {
        const bool isotropic = brdf.laws().isotropic;
        const std::size_t values = brdf.channels().count();
        fmt::format_to(std::back_inserter(text_),
                       "#DIM {} {}\n#PARAM_IN {}\n#PARAM_OUT {}\n#VS 0\n", isotropic ? 3 : 4,
                       values, isotropic ? "ISOTROPIC_TL_TV_PROJ_DPHI" : "SPHERICAL_TL_PL_TV_PV",
                       values == 3 ? "RGB_COLOR" : "INV_STERADIAN");
    }

    void add(const Direction& wi, const Direction& wo, const double* values) {
        const double light = polarAngle(wi), view = polarAngle(wo);
        auto to = std::back_inserter(text_);
        if (brdf_.laws().isotropic) {
            const double turn = azimuth(wo) - azimuth(wi);
            fmt::format_to(to, "{} {} {}", light, view * std::cos(turn), view * std::sin(turn));
        } else {
            fmt::format_to(to, "{} {} {} {}", light, azimuth(wi), view, azimuth(wo));
        }
        for (std::size_t c = 0; c < brdf_.channels().count(); ++c) {
            if (!std::isfinite(values[c])) {
                throw NumericError(fmt::format(
                    "{}: f is {} at theta_i {:.4g}, theta_o {:.4g} degrees; ALTA text holds finite "
                    "values",
                    brdf_.name(), values[c], degrees(light), degrees(view)));
            }
            fmt::format_to(to, " {}", values[c]);
        }
        text_.push_back('\n');
        ++count_;
        if (text_.size() > (1 << 20)) flush();
    }

    void flush() {
        file_.write(std::string_view(text_.data(), text_.size()));
        text_.clear();
    }

    std::size_t count() const { return count_; }

private:
    const Brdf& brdf_;
    AtomicFile& file_;
    fmt::memory_buffer text_;
    std::size_t count_ = 0;
};

void writeGrid(const Brdf& brdf, const Grid& grid, Rows& rows,
               const std::function<void(std::size_t, std::size_t)>& progress) {
    const bool isotropic = brdf.laws().isotropic;
    const bool half = isotropic && brdf.laws().mirrorSymmetric;
    const auto at = [&](std::size_t k) {
        return grid.last * static_cast<double>(k) / static_cast<double>(grid.theta - 1);
    };
    // Half a circle includes both of its ends.
    const std::size_t azimuths = half ? grid.phi / 2 + 1 : grid.phi;
    const auto around = [&](std::size_t k) {
        return 2 * pi * static_cast<double>(k) / static_cast<double>(grid.phi);
    };
    const std::size_t lights = isotropic ? 1 : grid.phi;
    std::vector<double> values(brdf.channels().count());
    for (std::size_t i = 0; i < grid.theta; ++i) {
        // At the normal one azimuth is enough for an isotropic BRDF only.
        for (std::size_t pi_ = 0; pi_ < lights; ++pi_) {
            const Direction wi = directionFromAngles(at(i), around(pi_));
            for (std::size_t o = 0; o < grid.theta; ++o) {
                for (std::size_t po = 0; po < (o == 0 ? 1 : azimuths); ++po) {
                    const Direction wo = directionFromAngles(at(o), around(po));
                    brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, values.data());
                    rows.add(wi, wo, values.data());
                }
            }
        }
        if (progress) progress(i + 1, grid.theta);
    }
}

std::vector<std::string> writeAlta(const Brdf& brdf, const std::string& path,
                                   const Parameters& parameters, const WriteOptions& options) {
    requireReflection(brdf, "alta");
    if (brdf.channels().kind == Channels::Kind::spectral) {
        throw UsageError(fmt::format(
            "{}: is spectral ({} wavelengths); ALTA text has one value or three, and no "
            "wavelengths; convert with --rgb",
            brdf.name(), brdf.channels().count()));
    }
    const std::optional<MeasuredPairs> measured = measuredPairs(brdf);
    const bool samplesOfPairs = measured && measured->samples.chart == Chart::anisotropic;
    const std::string wanted = parameters.choice("grid");
    if (wanted == "samples" && !samplesOfPairs) {
        throw UsageError(
            fmt::format("{}: has no scattered samples of pairs of directions to keep; "
                        "leave out grid=samples",
                        brdf.name()));
    }
    AtomicFile file(path,
                    options.force ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse);
    Rows rows(brdf, file);
    std::vector<std::string> notes;
    if (samplesOfPairs && wanted != "angles") {
        const Samples& samples = measured->samples;
        const std::size_t channels = samples.channels.count();
        for (std::size_t k = 0; k < samples.size(); ++k) {
            rows.add(samples.wi[k], samples.wo[k], samples.values.data() + k * channels);
        }
        notes.push_back(fmt::format("keeps the {} samples and not the interpolation between them",
                                    samples.size()));
    } else {
        const Grid grid{.theta = static_cast<std::size_t>(parameters.number("theta")),
                        .phi = static_cast<std::size_t>(parameters.number("phi")),
                        .last = radians(parameters.number("last"))};
        writeGrid(brdf, grid, rows, options.progress);
        notes.push_back(
            fmt::format("{} samples: {} polar angles from 0 to {} degrees, azimuths "
                        "every {:.4g} degrees",
                        rows.count(), grid.theta, parameters.number("last"),
                        360 / static_cast<double>(grid.phi)));
    }
    rows.flush();
    brdf.checkIntact();
    file.commit();
    return notes;
}

}  // namespace

const Writer& altaWriter() {
    static const Writer writer{
        .name = "alta",
        .help = "ALTA text: samples of pairs of directions, grey or RGB",
        .extension = ".alta",
        .parameters = {{.name = "grid",
                        .help = "where f is sampled; auto: scattered samples are kept",
                        .kind = Parameter::Kind::choice,
                        .choices = {"auto", "samples", "angles"}},
                       {.name = "theta",
                        .help = "number of polar angles of each direction",
                        .fallback = 18,
                        .min = 2,
                        .max = 1000},
                       {.name = "phi",
                        .help = "number of azimuths around the circle, even",
                        .fallback = 24,
                        .min = 2,
                        .max = 1000},
                       {.name = "last",
                        .help = "largest polar angle in degrees",
                        .fallback = 85,
                        .min = 1,
                        .max = 89.999}},
        .write = writeAlta,
    };
    return writer;
}

}  // namespace hshfit::brdfs
