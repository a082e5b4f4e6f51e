#include <hshfit/gpu/viewer_light.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/light/latlong_projection.h>
#include <hshfit/light/light_nodes.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/light/picture_light.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <span>
#include <variant>

namespace hshfit::gpu {
namespace {

/// Radiance times solid angle by pixel.
class Raster {
public:
    explicit Raster(int height)
        : picture_{PictureLayout::latlong, 2 * static_cast<std::size_t>(height),
                   static_cast<std::size_t>(height)},
          flux_(3 * picture_.width * picture_.height, 0.0) {}

    std::size_t width() const { return picture_.width; }
    std::size_t height() const { return picture_.height; }

    std::size_t pixelOf(const Direction& d) const {
        const auto [column, row] = picture_.position(d);
        return std::min(static_cast<std::size_t>(row), height() - 1) * width() +
               std::min(static_cast<std::size_t>(column), width() - 1);
    }
    void add(std::size_t pixel, const Rgb& flux) {
        for (std::size_t c = 0; c < 3; ++c) flux_[3 * pixel + c] += flux[c];
    }
    void add(const Raster& other, double factor) {
        for (std::size_t k = 0; k < flux_.size(); ++k) flux_[k] += factor * other.flux_[k];
    }
    double total() const {
        double sum = 0;
        for (const double value : flux_) sum += value;
        return sum;
    }
    double solidAngle(std::size_t row) const { return picture_.solidAngle(0, row); }

    /// Means of the radiance over parts of each pixel of equal solid angle.
    void addMeans(const Light& light, int parts) {
        for (std::size_t row = 0; row < height(); ++row) {
            const double top =
                std::cos(pi * static_cast<double>(row) / static_cast<double>(height()));
            const double low =
                std::cos(pi * static_cast<double>(row + 1) / static_cast<double>(height()));
            for (std::size_t column = 0; column < width(); ++column) {
                Rgb sum{};
                for (int i = 0; i < parts * parts; ++i) {
                    const double z = top + (low - top) * (i / parts + 0.5) / parts;
                    const double x = static_cast<double>(column) + (i % parts + 0.5) / parts;
                    const double phi = pi - 2 * pi * x / static_cast<double>(width());
                    const double s = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
                    const Rgb one = radianceFrom(std::span(&light, 1),
                                                 {s * std::cos(phi), s * std::sin(phi), z});
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += one[c];
                }
                for (double& value : sum) value *= solidAngle(row) / (parts * parts);
                add(row * width() + column, sum);
            }
        }
    }

    std::vector<float> radiance() const {
        std::vector<float> values;
        values.reserve(flux_.size());
        for (std::size_t k = 0; k < flux_.size(); ++k)
            values.push_back(static_cast<float>(flux_[k] / solidAngle(k / (3 * width()))));
        return values;
    }

private:
    PictureGeometry picture_;
    std::vector<double> flux_;
};

struct Draw {
    Raster& raster;

    void operator()(const SkyLight& light) const { raster.addMeans(light, 4); }
    void operator()(const CoefficientLight& light) const { raster.addMeans(light, 4); }
    void operator()(const DirectionalLight& light) const {
        raster.add(raster.pixelOf(light.towards), light.irradiance);
    }
    void operator()(const DiscLight& light) const { addBounded(light); }
    void operator()(const PanelLight& light) const { addBounded(light); }

    /// Means over pixels, with the flux of the light; its nodes where it is too small for that.
    void addBounded(const Light& light) const {
        const LightNodes nodes = nodesOf(light, {}, 32, 2);
        double flux = 0;
        for (const auto& channel : nodes.flux)
            for (const double value : channel) flux += value;
        Raster means(static_cast<int>(raster.height()));
        means.addMeans(light, 6);
        const double ratio = means.total() > 0 ? flux / means.total() : 0;
        if (ratio > 0.95 && ratio < 1.05) return raster.add(means, ratio);
        for (std::size_t k = 0; k < nodes.count(); ++k) {
            raster.add(raster.pixelOf({nodes.x[k], nodes.y[k], nodes.z[k]}),
                       {nodes.flux[0][k], nodes.flux[1][k], nodes.flux[2][k]});
        }
    }

    /// The flux of pixels, or of parts of them where they are not much smaller than the pixels
    /// here;
    /// the solid angles of the parts divide it, so that pixels that do not fit leave no pattern.
    void operator()(const PictureLight& light) const {
        const PictureGeometry from = geometryOf(light);
        const double pixel = pi / static_cast<double>(raster.height());
        const int parts =
            static_cast<int>(std::clamp(std::ceil(8 * from.pixelAngle() / pixel), 1.0, 64.0));
        std::vector<double> angles(raster.width() * raster.height(), 0.0);
        std::vector<Rgb> flux(angles.size(), Rgb{});
        for (std::size_t row = 0; row < from.height; ++row) {
            for (std::size_t column = 0; column < from.width; ++column) {
                const double angle = from.solidAngle(column, row) / (parts * parts);
                if (!(angle > 0)) continue;
                const float* rgb = light.rgb.data() + 3 * (row * from.width + column);
                for (int i = 0; i < parts * parts; ++i) {
                    const std::size_t at = raster.pixelOf(
                        directionOf(light, static_cast<double>(column) + (i % parts + 0.5) / parts,
                                    static_cast<double>(row) + (i / parts + 0.5) / parts));
                    angles[at] += angle;
                    for (std::size_t c = 0; c < 3; ++c)
                        flux[at][c] += angle * static_cast<double>(rgb[c]);
                }
            }
        }
        for (std::size_t k = 0; k < angles.size(); ++k) {
            if (!(angles[k] > 0)) continue;
            const double share = raster.solidAngle(k / raster.width()) / angles[k];
            raster.add(k, {share * flux[k][0], share * flux[k][1], share * flux[k][2]});
        }
    }
};

std::vector<std::uint8_t> encodeRgbe(const std::vector<float>& radiance) {
    std::vector<std::uint8_t> rgbe;
    rgbe.reserve(radiance.size() / 3 * 4);
    for (std::size_t k = 0; k < radiance.size(); k += 3) {
        const float most = std::max({radiance[k], radiance[k + 1], radiance[k + 2]});
        int exponent = 0;
        if (most > 0) std::frexp(most, &exponent);
        if (!(most > 0) || exponent < -126) {
            rgbe.insert(rgbe.end(), 4, 0);
            continue;
        }
        if (std::lround(std::ldexp(most, 8 - exponent)) > 255) ++exponent;
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = std::max(radiance[k + c], 0.0F);
            rgbe.push_back(static_cast<std::uint8_t>(std::lround(std::ldexp(value, 8 - exponent))));
        }
        rgbe.push_back(static_cast<std::uint8_t>(exponent + 128));
    }
    return rgbe;
}

double distance(const LightCoefficients& light, const std::vector<double>& other) {
    double wrong = 0, all = 0;
    for (std::size_t k = 0; k < other.size(); ++k) {
        wrong += std::pow(other[k] - light.values[k], 2);
        all += std::pow(light.values[k], 2);
    }
    return all > 0 ? std::sqrt(wrong / all) : 0;
}

/// The place of the first ":key=" of a specification, or its end.
std::size_t parametersAt(const std::string& text) {
    for (std::size_t at = text.find(':'); at != text.npos; at = text.find(':', at + 1)) {
        std::size_t end = at + 1;
        while (end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) != 0 ||
                                     text[end] == '_' || text[end] == '-'))
            ++end;
        if (end > at + 1 && end < text.size() && text[end] == '=') return at;
    }
    return text.size();
}

}  // namespace

std::string shownName(const std::string& specification) {
    std::string path = specification.substr(0, parametersAt(specification));
    const std::size_t slash = path.find_last_of("/\\");
    const std::size_t dot = path.rfind('.');
    const bool extension =
        dot != path.npos && dot > 0 && dot + 1 < path.size() &&
        std::all_of(path.begin() + static_cast<std::ptrdiff_t>(dot) + 1, path.end(),
                    [](unsigned char c) { return std::isalnum(c) != 0; }) &&
        std::isalpha(static_cast<unsigned char>(path[dot + 1])) != 0;
    if (slash == path.npos && !extension) return specification;
    if (extension && (slash == path.npos || dot > slash + 1)) path.resize(dot);
    const std::string name = slash == path.npos ? path : path.substr(slash + 1);
    return name.empty() ? specification : name;
}

std::vector<float> decodeRgbe(const std::vector<std::uint8_t>& rgbe) {
    std::vector<float> radiance;
    radiance.reserve(rgbe.size() / 4 * 3);
    for (std::size_t k = 0; k < rgbe.size(); k += 4) {
        for (std::size_t c = 0; c < 3; ++c) {
            radiance.push_back(
                std::ldexp(static_cast<float>(rgbe[k + c]), static_cast<int>(rgbe[k + 3]) - 136));
        }
    }
    return radiance;
}

ViewerLight viewerLight(const LightSpecification& light, int order, int height) {
    ViewerLight result;
    for (const std::string& term : light.terms) {
        if (!result.name.empty()) result.name += '+';
        result.name += shownName(term);
    }
    const auto basis = bases::make("sh", order);
    result.coefficients = projectLight(light.lights, *basis, {.tolerance = 1e-6});
    result.captured = std::numeric_limits<double>::quiet_NaN();
    for (const LightCurve& curve : result.coefficients.curves)
        if (!curve.points.empty()) result.captured = curve.points.back().accuracy;

    Raster raster(height);
    for (const Light& one : light.lights) std::visit(Draw{raster}, one);
    result.width = static_cast<int>(raster.width());
    result.height = height;
    result.rgbe = encodeRgbe(raster.radiance());
    LatlongProjection projection(order, raster.width(), raster.height());
    projection.addRows(decodeRgbe(result.rgbe).data(), raster.height());
    std::vector<double> own(result.coefficients.values.size());
    projection.coefficients(0, own.data());
    result.pictureError = distance(result.coefficients, own);
    return result;
}

}  // namespace hshfit::gpu
