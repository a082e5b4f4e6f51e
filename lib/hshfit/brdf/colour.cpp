#include <hshfit/brdf/channel_view.h>
#include <hshfit/brdf/cie_1931.h>
#include <hshfit/brdf/colour.h>
#include <hshfit/brdf/kink_curve.h>
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

/// X, Y, Z as sums over the given wavelengths.
Eigen::Matrix3Xd xyzWeights(std::span<const double> nanometres) {
    Eigen::Matrix3Xd weights =
        Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(nanometres.size()));
    double white = 0;
    for (std::size_t row = 0; row < cie1931.size(); ++row) {
        const CieRow& cie = cie1931[row];
        const Eigen::Vector3d xyz = cie.d65 * Eigen::Vector3d(cie.x, cie.y, cie.z);
        white += xyz[1];
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
    return weights / white;
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

class RgbView : public Brdf, public HasKinkCurves, public ChannelView {
public:
    explicit RgbView(std::unique_ptr<Brdf> spectral)
        : spectral_(std::move(spectral)),
          weights_(rgbWeights(spectral_->channels().wavelengths)),
          laws_(spectral_->laws()) {
        // Weights of both signs: neither law follows from those of the wavelengths.
        laws_.nonNegative = laws_.energyConserving = false;
    }

    std::string name() const override { return "rgb:" + spectral_->name(); }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override {
        spectral_->coverage(wo, wi, covered);
    }
    std::vector<Lobe> lobes(const Direction& wo) const override { return spectral_->lobes(wo); }
    std::vector<double> kinks(const Direction& wo) const override { return spectral_->kinks(wo); }
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return kinkCurvesOf(*spectral_, wo);
    }
    double defaultTolerance() const override { return spectral_->defaultTolerance(); }
    void checkIntact() const override { spectral_->checkIntact(); }

    std::vector<Fact> facts() const override {
        std::vector<Fact> facts = spectral_->facts();
        facts.emplace_back("rgb_from", fmt::format("{} wavelengths, CIE 1931 2 degrees, D65",
                                                   spectral_->channels().count()));
        facts.emplace_back("luminance_beyond_wavelengths", weights_.continued);
        return facts;
    }

    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        const std::size_t wavelengths = spectral_->channels().count();
        std::vector<double> values(wavelengths * wi.count);
        spectral_->eval(wo, wi, values.data());
        std::fill_n(out, 3 * wi.count, 0.0);
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < wavelengths; ++i) {
                const double weight = weights_.weights[c][i];
                const double* from = values.data() + i * wi.count;
                double* to = out + c * wi.count;
                for (std::size_t k = 0; k < wi.count; ++k) to[k] += weight * from[k];
            }
        }
    }

    const Brdf& seen() const override { return *spectral_; }
    void convert(std::span<const double> from, std::span<double> to) const override {
        for (std::size_t c = 0; c < 3; ++c) {
            to[c] = 0;
            for (std::size_t i = 0; i < from.size(); ++i) to[c] += weights_.weights[c][i] * from[i];
        }
    }

private:
    std::unique_ptr<Brdf> spectral_;
    RgbWeights weights_;
    Channels channels_ = Channels::rgb();
    Laws laws_;
};

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

std::unique_ptr<Brdf> asRgb(std::unique_ptr<Brdf> spectral) {
    if (spectral->channels().kind != Channels::Kind::spectral) {
        throw UsageError(fmt::format("{}: is not spectral; {} is for spectral BRDFs",
                                     spectral->name(), Call{.function = "asRgb"}));
    }
    return std::make_unique<RgbView>(std::move(spectral));
}

}  // namespace hshfit::inline brdf
