#include <brdfs/measured/scattered/alta.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hshfit::brdfs {
namespace {

struct BlinnLobe {
    std::vector<double> weight, exponent;  ///< per channel
};

/// kd + sum of Ks cos(theta_h)^N.
class AltaFunction : public Brdf {
public:
    AltaFunction(std::vector<double> diffuse, std::vector<BlinnLobe> blinn, std::string name)
        : diffuse_(std::move(diffuse)), blinn_(std::move(blinn)), name_(std::move(name)) {
        channels_ = diffuse_.size() == 1 ? Channels::grey() : Channels::rgb();
        laws_.nonNegative = laws_.reciprocal = laws_.isotropic = laws_.mirrorSymmetric = true;
    }

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }

    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < wi.count; ++k) {
            const double x = wi.x[k] + wo.x, y = wi.y[k] + wo.y, z = wi.z[k] + wo.z;
            const double cosine = z / std::sqrt(x * x + y * y + z * z);
            const bool above = wi.z[k] > 0 && wo.z > 0;
            for (std::size_t c = 0; c < diffuse_.size(); ++c) {
                double f = diffuse_[c];
                for (const BlinnLobe& lobe : blinn_) {
                    f += lobe.weight[c] * std::pow(cosine, lobe.exponent[c]);
                }
                out[c * wi.count + k] = above ? f : 0;
            }
        }
    }

    std::vector<Lobe> lobes(const Direction&) const override {
        double sharpest = 0;
        for (const BlinnLobe& lobe : blinn_) {
            sharpest = std::max(sharpest, *std::ranges::max_element(lobe.exponent));
        }
        if (sharpest < 2) return {};
        // cos^N is nearly a Gaussian of the slope with a variance of 1/N.
        return {{.about = Lobe::About::halfway, .width = 2.5 / std::sqrt(sharpest), .axis = {}}};
    }

    std::vector<Fact> facts() const override {
        return {{"format", "alta"}, {"functions", static_cast<std::int64_t>(blinn_.size() + 1)}};
    }

private:
    std::vector<double> diffuse_;
    std::vector<BlinnLobe> blinn_;
    std::string name_;
    Channels channels_;
    Laws laws_;
};

bool nextLine(TextReader& reader) {
    while (reader.next()) {
        if (!reader.blank()) return true;
    }
    return false;
}

double readParameter(TextReader& reader, std::string_view key, double most) {
    double value = 0;
    if (!nextLine(reader)) throw reader.error(fmt::format("the file ends before {}", key));
    if (reader.takeWord() != key || !reader.takeNumber(value)) {
        throw reader.error(fmt::format("expected {} and its value", key));
    }
    if (!(value >= 0 && value <= most)) {
        throw reader.error(fmt::format("{} is {}, expected from 0 to {}", key, value, most));
    }
    return value;
}

}  // namespace

std::unique_ptr<Brdf> readAltaFunction(std::string_view text, const std::string& where) {
    TextReader reader(text, where);
    double channels = 0;
    std::vector<double> diffuse;
    std::vector<BlinnLobe> blinn;
    bool any = false;
    while (nextLine(reader)) {
        const std::string_view key = reader.takeWord();
        if (key == "#DIM") {
            double in = 0;
            if (!reader.takeNumber(in) || !reader.takeNumber(channels) ||
                (channels != 1 && channels != 3)) {
                throw reader.error("#DIM has to end in 1 (grey) or 3 (R, G, B)");
            }
            diffuse.assign(static_cast<std::size_t>(channels), 0.0);
        }
        if (key != "#FUNC") {
            if (key[0] == '#') continue;
            throw reader.error(fmt::format("'{}' belongs to no #FUNC", key.substr(0, 40)));
        }
        if (diffuse.empty()) throw reader.error("#FUNC, but no #DIM before it");
        any = true;
        const std::string_view function = reader.takeWord();
        if (function == "nonlinear_function_diffuse") {
            for (double& kd : diffuse) kd += readParameter(reader, "kd", 1e6);
        } else if (function == "nonlinear_function_blinn") {
            BlinnLobe lobe;
            for (std::size_t c = 0; c < diffuse.size(); ++c) {
                lobe.weight.push_back(readParameter(reader, "Ks", 1e6));
                lobe.exponent.push_back(readParameter(reader, "N", 1e6));
            }
            blinn.push_back(std::move(lobe));
        } else {
            throw reader.error(
                fmt::format("the function '{}' is not read; readable are "
                            "nonlinear_function_diffuse and "
                            "nonlinear_function_blinn",
                            function.substr(0, 60)));
        }
    }
    if (!any) throw reader.error("the file has no #FUNC");
    return std::make_unique<AltaFunction>(std::move(diffuse), std::move(blinn), where);
}

}  // namespace hshfit::brdfs
