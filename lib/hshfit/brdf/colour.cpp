#include <hshfit/brdf/channel_view.h>
#include <hshfit/brdf/colour.h>
#include <hshfit/brdf/internal/cie_1931.h>
#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <Eigen/Dense>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::inline brdf {
namespace {

constexpr double largestContinuation = 0.05;
constexpr std::size_t fewestWavelengths = 3;

double wavelength(std::size_t row) {
    return cieFirst + cieStep * static_cast<double>(row);
}

/// X, Y, Z as sums over the given wavelengths, of light whose power is `power` of each row.
template <typename Power>
Eigen::Matrix3Xd xyzSums(std::span<const double> nanometres, const Power& power) {
    Eigen::Matrix3Xd weights =
        Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(nanometres.size()));
    for (std::size_t row = 0; row < cie1931.size(); ++row) {
        const CieRow& cie = cie1931[row];
        const Eigen::Vector3d xyz = power(cie) * Eigen::Vector3d(cie.x, cie.y, cie.z);
        const double at = wavelength(row);
        const auto above = std::ranges::lower_bound(nanometres, at);
        const auto i = above - nanometres.begin();
        if (above == nanometres.begin()) {
            weights.col(0) += xyz;
        } else if (above == nanometres.end()) {
            weights.col(i - 1) += xyz;
        } else {
            const double low = *(above - 1), t = (at - low) / (*above - low);
            weights.col(i - 1) += (1 - t) * xyz;
            weights.col(i) += t * xyz;
        }
    }
    return weights;
}

/// The sums of a reflecting surface under D65.
Eigen::Matrix3Xd xyzWeights(std::span<const double> nanometres) {
    double white = 0;
    for (const CieRow& cie : cie1931) white += cie.d65 * cie.y;
    return xyzSums(nanometres, [](const CieRow& cie) { return cie.d65; }) / white;
}

/// Rec. ITU-R BT.709: the chromaticities of the primaries, with `white` as R = G = B = 1.
Eigen::Matrix3d rgbFromXyz(const Eigen::Vector3d& white) {
    const auto primary = [](double x, double y) {
        return Eigen::Vector3d(x / y, 1, (1 - x - y) / y);
    };
    Eigen::Matrix3d primaries;
    primaries << primary(0.64, 0.33), primary(0.30, 0.60), primary(0.15, 0.06);
    const Eigen::Vector3d amounts = primaries.inverse() * white;
    return (primaries * amounts.asDiagonal()).inverse();
}

double luminanceBeyond(std::span<const double> nanometres) {
    double beyond = 0, all = 0;
    for (std::size_t row = 0; row < cie1931.size(); ++row) {
        const double y = cie1931[row].d65 * cie1931[row].y, at = wavelength(row);
        all += y;
        if (at < nanometres.front() || at > nanometres.back()) beyond += y;
    }
    return beyond / all;
}

}  // namespace

RgbWeights rgbWeights(std::span<const double> nanometres) {
    if (nanometres.size() < fewestWavelengths) {
        throw UsageError(
            fmt::format("{} wavelengths are too few to make a colour of; {} are needed",
                        nanometres.size(), fewestWavelengths));
    }
    RgbWeights result{.weights = {}, .continued = luminanceBeyond(nanometres)};
    if (result.continued > largestContinuation) {
        throw UsageError(
            fmt::format("wavelengths from {:g} to {:g} nm leave out {:.0f} % of the luminance; at "
                        "most {:.0f} % "
                        "can be continued",
                        nanometres.front(), nanometres.back(), 100 * result.continued,
                        100 * largestContinuation));
    }
    const Eigen::Matrix3Xd xyz = xyzWeights(nanometres);
    const Eigen::Matrix3Xd rgb = rgbFromXyz(xyz.rowwise().sum()) * xyz;
    for (int c = 0; c < 3; ++c) {
        for (Eigen::Index i = 0; i < rgb.cols(); ++i) {
            result.weights[static_cast<std::size_t>(c)].push_back(rgb(c, i));
        }
    }
    return result;
}

std::array<double, 3> rec709FromXyz(const std::array<double, 3>& xyz) {
    static const Eigen::Matrix3d matrix =
        rgbFromXyz({0.3127 / 0.3290, 1, (1 - 0.3127 - 0.3290) / 0.3290});
    const Eigen::Vector3d rgb = matrix * Eigen::Vector3d(xyz[0], xyz[1], xyz[2]);
    return {rgb[0], rgb[1], rgb[2]};
}

std::array<double, 3> tristimulus(std::span<const double> nanometres, std::span<const double> f) {
    const Eigen::Map<const Eigen::VectorXd> values(f.data(), static_cast<Eigen::Index>(f.size()));
    const Eigen::Vector3d xyz = xyzWeights(nanometres) * values;
    return {xyz[0], xyz[1], xyz[2]};
}

std::array<double, 3> tristimulusOfRadiance(std::span<const double> nanometres,
                                            std::span<const double> radiance) {
    const Eigen::Map<const Eigen::VectorXd> values(radiance.data(),
                                                   static_cast<Eigen::Index>(radiance.size()));
    const Eigen::Vector3d xyz = xyzSums(nanometres, [](const CieRow&) { return cieStep; }) * values;
    return {xyz[0], xyz[1], xyz[2]};
}

std::unique_ptr<Brdf> asRgb(std::unique_ptr<Brdf> spectral) {
    if (spectral->channels().kind != Channels::Kind::spectral) {
        throw UsageError(fmt::format("{}: is not spectral; {} is for spectral BRDFs",
                                     spectral->name(), Call{.function = "asRgb"}));
    }
    const RgbWeights rgb = rgbWeights(spectral->channels().wavelengths);
    ChannelView::Look look{.name = "rgb:" + spectral->name(),
                           .channels = Channels::rgb(),
                           .laws = spectral->laws(),
                           .weights = {rgb.weights.begin(), rgb.weights.end()}};
    // Weights have both signs: neither law follows from the same law for the wavelengths.
    look.laws.nonNegative = look.laws.energyConserving = false;
    look.facts.emplace_back("rgb_from", fmt::format("{} wavelengths, CIE 1931 2 degrees, D65",
                                                    spectral->channels().count()));
    look.facts.emplace_back("luminance_beyond_wavelengths", rgb.continued);
    return std::make_unique<ChannelView>(std::move(spectral), std::move(look));
}

}  // namespace hshfit::inline brdf
