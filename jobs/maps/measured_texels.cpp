#include "measured_texels.h"

#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/projection/least_squares.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hshfit::jobs {
namespace {

constexpr std::size_t mostTexelSamples = 4096;  // the matrix of least squares has as many columns
constexpr std::size_t mostMeasured = 2048;      // texels of the stated error

}  // namespace

class MeasuredTexels::Band final : public TexelBand {
public:
    explicit Band(const MeasuredTexels& of) : of_(of) {}
    void texels(std::size_t row, std::size_t column, std::size_t count, float* out) const override {
        for (std::size_t k = 0; k < count; ++k)
            of_.texel(column + k, row, out + k * of_.layout_.floats());
    }

private:
    const MeasuredTexels& of_;
};

MeasuredTexels::MeasuredTexels(const std::string& file, const Basis& basis, const Options& options,
                               const Listener& listener)
    : file_(file), mapped_(file), tensor_(mapped_.bytes(), file) {
    incoming_ = directions("incoming");
    outgoing_ = directions("outgoing");
    const TensorFile::Field& field = tensor_.field("reflectance");
    if (field.type != TensorFile::Type::f32 || field.shape.size() != 5)
        tensor_.fail(field,
                     fmt::format("is {} of {}; f32 of height x width x outgoing x incoming x "
                                 "channels is needed",
                                 typeName(field.type), shapeText(field.shape)));
    if (field.shape[2] != outgoing_.size() || field.shape[3] != incoming_.size())
        tensor_.fail(field,
                     fmt::format("is {}; the file has {} outgoing and {} incoming directions",
                                 shapeText(field.shape), outgoing_.size(), incoming_.size()));
    if (field.shape[4] != 1 && field.shape[4] != 3)
        tensor_.fail(field, fmt::format("has {} channels; 1 or 3 are possible", field.shape[4]));
    if (field.count == 0) tensor_.fail(field, "has no texel");
    height_ = field.shape[0];
    width_ = field.shape[1];
    channels_ = field.shape[4];
    samples_ = outgoing_.size() * incoming_.size();
    if (samples_ > mostTexelSamples)
        tensor_.fail(field, fmt::format("has {} samples of a texel; at most {} are possible",
                                        samples_, mostTexelSamples));
    reflectance_ = tensor_.raw(field).data();
    laws_.nonNegative = true;
    laws_.isotropic = laws_.mirrorSymmetric = options.isotropic;
    const OutgoingSet outgoing = !options.outgoing.empty() ? OutgoingSet::parse(options.outgoing)
                                 : options.isotropic       ? OutgoingSet::elevations(8)
                                                           : OutgoingSet::parabolic(8, 8);
    layout_ = texelLayout(basis, outgoing, channels_, options.isotropic);
    checkSamples(listener);
    findOperator(basis, options.quantity);
}

std::vector<Direction> MeasuredTexels::directions(const char* name) const {
    const TensorFile::Field& field = tensor_.field(name);
    const std::vector<float> values = tensor_.floats(field, 2);
    if (field.shape[1] != 3)
        tensor_.fail(field, fmt::format("is {}; three numbers a direction are needed",
                                        shapeText(field.shape)));
    std::vector<Direction> result;
    for (std::size_t k = 0; k < values.size(); k += 3) {
        const Direction d{static_cast<double>(values[k]), static_cast<double>(values[k + 1]),
                          static_cast<double>(values[k + 2])};
        const double length = std::sqrt(dot(d, d));
        if (std::abs(length - 1) > 1e-3 || !(d.z > 0))
            tensor_.fail(field, fmt::format("direction {} is ({:.4g}, {:.4g}, {:.4g}); a unit "
                                            "vector above the horizon is needed",
                                            k / 3, d.x, d.y, d.z));
        result.push_back({d.x / length, d.y / length, d.z / length});
    }
    return result;
}

void MeasuredTexels::checkSamples(const Listener& listener) const {
    const auto progress = listener.part(fmt::format("checking {}", file_));
    const std::size_t texel = samples_ * channels_, row = width_ * texel;
    for (std::size_t y = 0; y < height_; ++y) {
        for (std::size_t k = 0; k < row; ++k) {
            float value = 0;
            std::memcpy(&value, reflectance_ + (y * row + k) * sizeof value, sizeof value);
            if (std::isfinite(value) && value >= 0) continue;
            const std::size_t sample = k % texel / channels_;
            throw InputError(fmt::format(
                "{}: texel ({}, {}): reflectance of outgoing direction {}, incoming direction {} "
                "is {}; a finite number of at least 0 is needed",
                file_, k / texel, y, sample / incoming_.size(), sample % incoming_.size(), value));
        }
        if (progress) progress(y + 1, height_);
    }
}

/// The coefficients of unit samples, each as a channel of one projection.
void MeasuredTexels::findOperator(const Basis& basis, Quantity quantity) {
    std::vector<Direction> wi, wo;
    for (const Direction& out : outgoing_) {
        for (const Direction& in : incoming_) {
            wi.push_back(in);
            wo.push_back(out);
        }
    }
    std::vector<double> units(samples_ * samples_, 0.0), names;
    for (std::size_t k = 0; k < samples_; ++k) {
        units[k * samples_ + k] = 1;
        names.push_back(static_cast<double>(k + 1));
    }
    const DirectionSamples samples{.wi = wi,
                                   .wo = wo,
                                   .values = units,
                                   .channels = Channels::spectral(names),
                                   .symmetry = laws_,
                                   .name = file_};
    const Coefficients c =
        projectLeastSquares(samples, basis, layout_.outgoing, {.quantity = quantity}).coefficients;
    const std::size_t slots = layout_.slots.size();
    operator_.resize(layout_.shape() * samples_);
    responses_.resize(samples_ * layout_.shape());
    for (std::size_t o = 0; o < layout_.outgoing.size(); ++o)
        for (std::size_t s = 0; s < slots; ++s)
            for (std::size_t k = 0; k < samples_; ++k)
                operator_[(o * slots + s) * samples_ + k] =
                    static_cast<float>(c.at(o, k)[layout_.slots[s]]);
    // Values at the samples: of each basis function about each outgoing direction.
    eachInParallel(samples_, [&](std::size_t k) {
        const OutgoingLookup found = lookUp(layout_.outgoing, wo[k]);
        const Direction in = found.turn == 0 ? wi[k] : rotateAboutZ(wi[k], -found.turn);
        std::vector<double> values(static_cast<std::size_t>(basis.slots()));
        basis.evaluate(in, values.data());
        const double scale = quantity == Quantity::brdfCosine ? 1 / in.z : 1;
        for (int j = 0; j < found.count; ++j) {
            const auto at = static_cast<std::size_t>(j);
            for (std::size_t s = 0; s < slots; ++s)
                responses_[k * layout_.shape() + found.index[at] * slots + s] += static_cast<float>(
                    found.weight[at] * scale * values[static_cast<std::size_t>(layout_.slots[s])]);
        }
    });
}

void MeasuredTexels::samplesOf(std::size_t column, std::size_t row, std::size_t channel,
                               float* out) const {
    const unsigned char* from =
        reflectance_ + (row * width_ + column) * samples_ * channels_ * sizeof(float);
    for (std::size_t k = 0; k < samples_; ++k)
        std::memcpy(out + k, from + (k * channels_ + channel) * sizeof(float), sizeof(float));
}

void MeasuredTexels::texel(std::size_t column, std::size_t row, float* out) const {
    const std::size_t slots = layout_.slots.size();
    std::vector<float> samples(samples_);
    std::fill_n(out, layout_.floats(), 0.0F);
    for (std::size_t c = 0; c < channels_; ++c) {
        samplesOf(column, row, c, samples.data());
        for (std::size_t j = 0; j < layout_.shape(); ++j) {
            const float* factors = operator_.data() + j * samples_;
            double sum = 0;
            for (std::size_t k = 0; k < samples_; ++k)
                sum += static_cast<double>(factors[k]) * static_cast<double>(samples[k]);
            out[j / slots * layout_.stride() + c * slots + j % slots] = static_cast<float>(sum);
        }
    }
}

std::unique_ptr<TexelBand> MeasuredTexels::band(std::size_t, std::size_t) {
    return std::make_unique<Band>(*this);
}

FitErrors MeasuredTexels::fitErrors() const {
    const std::size_t all = width_ * height_, count = std::min(all, mostMeasured);
    const std::size_t slots = layout_.slots.size();
    std::vector<double> errors(count);
    const auto indexOf = [&](std::size_t k) { return (2 * k + 1) * all / (2 * count); };
    eachInParallel(count, [&](std::size_t k) {
        const std::size_t column = indexOf(k) % width_, row = indexOf(k) / width_;
        std::vector<float> coefficients(layout_.floats()), samples(samples_);
        texel(column, row, coefficients.data());
        double off = 0, whole = 0;
        for (std::size_t c = 0; c < channels_; ++c) {
            samplesOf(column, row, c, samples.data());
            for (std::size_t s = 0; s < samples_; ++s) {
                double sum = 0;
                for (std::size_t j = 0; j < layout_.shape(); ++j)
                    sum += static_cast<double>(responses_[s * layout_.shape() + j]) *
                           static_cast<double>(
                               coefficients[j / slots * layout_.stride() + c * slots + j % slots]);
                const auto value = static_cast<double>(samples[s]);
                off += (sum - value) * (sum - value);
                whole += value * value;
            }
        }
        errors[k] = whole > 0 ? std::sqrt(off / whole) : 0;
    });
    FitErrors result{.texels = count};
    for (std::size_t k = 0; k < count; ++k) {
        result.mean += errors[k] / static_cast<double>(count);
        if (k > 0 && errors[k] <= result.maximum) continue;
        result.maximum = errors[k];
        result.column = indexOf(k) % width_;
        result.row = indexOf(k) / width_;
    }
    return result;
}

}  // namespace hshfit::jobs
