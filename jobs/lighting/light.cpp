#include "light.h"

#include <jobs/common/json_output.h>
#include <jobs/common/nine_numbers.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/standard_streams.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_energy.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/light_wavelets.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/percent.h>
#include <hshfit/specification/sums.h>
#include <hshfit/wavelets/slices.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hshfit::jobs {
namespace {

std::optional<int> orderReaching(const LightCurve& curve, double share) {
    for (const LightCurve::Point& point : curve.points)
        if (point.accuracy >= share) return point.order;
    return {};
}

void addWavelets(ProjectedLight& result, const std::vector<Light>& lights,
                 const LightDomain& domain, const Basis& basis) {
    // Wavelets are orthonormal over solid angle.
    Energy energy = result.light.energy;
    if (basis.inner() != Basis::Inner::solidAngle)
        energy =
            lightEnergy(lights, domain, false, std::vector<std::optional<double>>(lights.size()));
    if (!energy.finite || !(energy.value > 0)) return;
    const LightTerms terms = lightTerms(lights, domain, static_cast<std::size_t>(basis.slots()));
    result.waveletError = terms.error;
    result.wavelets = LightCurve{.basis = std::string(wavelets::sohoName), .points = {}};
    for (int order = 1; order <= basis.order(); ++order) {
        const int count = order * order;
        result.wavelets->points.push_back(
            {order, count, terms.captured[static_cast<std::size_t>(count)] / energy.value});
    }
    for (const double share : lightShares) {
        const auto order = orderReaching(*result.wavelets, share);
        result.enoughWavelets.push_back(order ? std::optional(*order * *order) : std::nullopt);
    }
}

/// The picture that is to be split.
const PictureLight& onlyPicture(const LightSpecification& specification) {
    const auto* picture = specification.lights.size() == 1
                              ? std::get_if<PictureLight>(&specification.lights.front())
                              : nullptr;
    if (!picture)
        throw UsageError(fmt::format(
            "{}: a sun is split off one picture; this is {}", specification.text,
            specification.lights.size() == 1 ? "another kind of light" : "a sum of lights"));
    return *picture;
}

/// The options of the rest: the layout where its size does not tell, and the placement that the
/// picture's own specification states.
std::string restOptions(const PictureLight& picture, const std::string& term) {
    std::vector<std::string> options;
    const PictureGeometry geometry = fileGeometryOf(picture);
    if (layoutOfSize(geometry.width, geometry.height) != geometry.layout)
        options.push_back(fmt::format("layout={}", layoutName(geometry.layout)));
    std::string_view rest(term);
    rest.remove_prefix(std::min(rest.size(), picture.file.size() + 1));
    while (!rest.empty()) {
        const std::size_t comma = std::min(rest.find(','), rest.size());
        const std::string_view option = withoutSpaces(rest.substr(0, comma));
        for (const char* key : {"mirror=", "tilt=", "axis=", "turn="})
            if (option.starts_with(key)) options.emplace_back(option);
        rest.remove_prefix(std::min(comma + 1, rest.size()));
    }
    return options.empty() ? "" : fmt::format(":{}", fmt::join(options, ","));
}

double relativeDifference(const LightCoefficients& a, const LightCoefficients& b,
                          std::size_t slots) {
    double difference = 0, whole = 0;
    for (std::size_t c = 0; c < b.channels.count(); ++c) {
        // Coefficients of grey light have one channel.
        const std::size_t of = a.channels.count() == b.channels.count() ? c : 0;
        for (std::size_t k = 0; k < slots; ++k) {
            const double x = a.values[of * a.slots() + k], y = b.values[c * b.slots() + k];
            difference += (x - y) * (x - y);
            whole += y * y;
        }
    }
    return whole > 0 ? std::sqrt(difference / whole) : 0;
}

/// Writes the rest into the set, reads it again, and compares its sum with the sun to the picture.
SplitLight split(const PictureLight& picture, const std::string& term, const std::string& output,
                 const ProjectedLight& whole, const Basis& basis, const LightOptions& options,
                 FileSet& files) {
    namespace fs = std::filesystem;
    SplitLight result;
    result.split = splitSun(picture);
    const fs::path stem = fs::path(output).replace_extension();
    result.rest = stem.string() + "_rest.exr";
    result.sun = sunSpecification(result.split);
    const std::string suffix = restOptions(picture, term);
    result.specification = fmt::format("{}{} + {}", result.rest, suffix, result.sun);
    AtomicFile& file = files.add(fs::path(result.rest).filename().string());
    writeRest(picture, result.split, file);
    file.finish();
    std::vector<Light> lights = lightsOf({file.temporaryPath() + suffix, result.sun});
    const LightCoefficients sum = projectLight(
        lights, basis, {.domain = {.normal = options.normal}, .tolerance = options.tolerance});
    result.error = relativeDifference(sum, whole.light, whole.light.slots());
    result.meanError = relativeDifference(sum, whole.light, 1);
    return result;
}

/// One line about coefficients that are off by more than a hundredth and than the tolerance; else
/// empty. A smaller tolerance would not help: the nodes ended before it was reached.
std::string poorRemark(const LightCoefficients& light, const LightOptions& options) {
    constexpr double poor = 1e-2;
    if (!(light.error > std::max(options.tolerance, poor))) return {};
    const bool solves = !bases::find(light.basis).orthonormal;
    return fmt::format(
        "poor: the coefficients are off by about {}; better: {}", percent(light.error, 2),
        solves ? fmt::format("{}, or fewer bands", Setting{"LightOptions::basis", "hsh"})
               : "fewer bands");
}

}  // namespace

nlohmann::ordered_json splitJson(const SplitLight& split) {
    const Direction& towards = split.split.sun.towards;
    return {{"sun", split.sun},
            {"rest", split.rest},
            {"specification", split.specification},
            {"elevation", 90 - degrees(polarAngle(towards))},
            {"azimuth", degrees(azimuth(towards))},
            {"angle", degrees(2 * split.split.sun.radius)},
            {"radiance", split.split.sun.radiance},
            {"irradiance", split.split.irradiance},
            {"pixels", split.split.rest.size()},
            {"peak", split.split.peak},
            {"surroundings", split.split.surroundings},
            {"error", split.error},
            {"mean_error", split.meanError}};
}

ProjectedLight light(const std::vector<std::string>& specs, const std::string& output,
                     const LightOptions& options) {
    requireJsonName(output, "coefficients of light");
    const auto basis =
        bases::make(options.basis, options.order, {.condonShortley = options.condonShortley});
    const LightSpecification specification{.text = fmt::format("{}", fmt::join(specs, " + ")),
                                           .lights = lightsOf(specs)};
    const PictureLight* picture = options.splitSun ? &onlyPicture(specification) : nullptr;
    if (picture && isStandardOutput(output))
        throw UsageError("a sun and the rest need the name of a file to be written beside");
    ProjectedLight result;
    result.light =
        projectLight(specification.lights, *basis,
                     {.domain = {.normal = options.normal}, .tolerance = options.tolerance});
    result.light.source = specification.text;
    result.remarks = remarksOf(specification.lights);
    if (const std::string poor = poorRemark(result.light, options); !poor.empty())
        result.remarks.push_back(poor);
    result.bands = bandEnergies(result.light);
    for (const double share : lightShares)
        result.enough.push_back(orderReaching(result.light.curves.front(), share));
    if (options.wavelets)
        addWavelets(result, specification.lights, {.normal = options.normal}, *basis);
    if (!picture) {
        if (!output.empty()) writeLight(result.light, output);
        return result;
    }
    const std::filesystem::path path(output);
    FileSet files(path.parent_path().empty() ? "." : path.parent_path(), true,
                  FileSet::Above::require);
    writeLight(result.light, files.add(path.filename().string()));
    result.split = split(*picture, specs.front(), output, result, *basis, options, files);
    files.commit();
    return result;
}

}  // namespace hshfit::jobs
