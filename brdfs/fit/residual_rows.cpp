#include <brdfs/fit/residual_rows.h>

#include <brdfs/fit/prediction.h>
#include <hshfit/brdf/vectors.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// Places in descending order of a size; equal sizes keep the order of the values.
template <class Size>
std::vector<ValuePlace> descending(std::vector<std::size_t> values, std::size_t samples,
                                   std::size_t most, const Size& size) {
    std::ranges::stable_sort(values,
                             [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
    if (values.size() > most) values.resize(most);
    std::vector<ValuePlace> places;
    for (const std::size_t v : values) places.push_back({v / samples, v % samples});
    return places;
}

}  // namespace

std::size_t rowOf(const FitSamples& samples, const ValuePlace& place) {
    return samples.rows.empty() ? place.sample + 1
                                : samples.rows[place.channel * samples.size() + place.sample];
}

std::vector<ValuePlace> mostInfluential(const FitSamples& samples, const Uncertainty& uncertainty,
                                        std::size_t most) {
    std::vector<std::size_t> values;
    for (std::size_t v = 0; v < uncertainty.values.size(); ++v) values.push_back(v);
    return descending(std::move(values), samples.size(), most,
                      [&](std::size_t v) { return uncertainty.values[v].cook; });
}

std::vector<ValuePlace> outliersOf(const FitSamples& samples, const Uncertainty& uncertainty) {
    std::vector<std::size_t> values;
    for (std::size_t v = 0; v < uncertainty.values.size(); ++v)
        if (uncertainty.outlierBound > 0 &&
            std::abs(uncertainty.values[v].studentised) > uncertainty.outlierBound)
            values.push_back(v);
    const std::size_t all = values.size();
    return descending(std::move(values), samples.size(), all,
                      [&](std::size_t v) { return std::abs(uncertainty.values[v].studentised); });
}

std::vector<std::string> columnNames(const Channels& channels) {
    if (channels.kind == Channels::Kind::grey) return {""};
    if (channels.kind != Channels::Kind::spectral) return channels.names();
    std::vector<std::string> names;
    for (const double nanometres : channels.wavelengths)
        names.push_back(fmt::format("{}", nanometres));
    return names;
}

std::vector<double> standardisedResiduals(const FitSamples& samples,
                                          const std::vector<double>& model, Loss::Kind loss,
                                          std::size_t parameters) {
    const std::size_t count = samples.size(), channels = samples.channels.count();
    std::vector<double> residuals(count * channels);
    double squares = 0;
    for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t v = c * count + k;
            residuals[v] = std::sqrt(samples.weight(c, k)) *
                           (mapValue(loss, samples.values[v], samples.wiZ[k]).value -
                            mapValue(loss, model[v], samples.wiZ[k]).value);
            squares += residuals[v] * residuals[v];
        }
    if (!samples.sigmas.empty() || squares == 0) return residuals;
    const auto values = static_cast<double>(residuals.size());
    const double degrees = std::max(values - static_cast<double>(parameters), 1.0);
    for (double& residual : residuals) residual /= std::sqrt(squares / degrees);
    return residuals;
}

double aspecularAngle(const FitSamples& samples, std::size_t k) {
    const Direction mirror = mirrored({samples.wiX[k], samples.wiY[k], samples.wiZ[k]});
    return degrees(angleBetween(samples.wo[k], mirror));
}

void writeResidualRows(const FitSamples& samples, const FitResult& result, Loss::Kind loss,
                       const std::function<void(std::string_view)>& write) {
    // With terms of the instrument, `model` is a reading; predicted errors are of f, so that none
    // are written.
    const bool predicted = !result.instrument && !result.point.channels.empty();
    const Prediction prediction = predicted ? predict(result, samples) : Prediction{};
    write(fmt::format(
        "row,wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,channel,value,sigma,model,residual,studentised,"
        "leverage,cook,theta_i,theta_o,aspecular,standardised,standard_error{}\n",
        prediction.bootstrap ? ",bootstrap_error" : ""));
    const std::size_t count = samples.size(), channels = samples.channels.count();
    const std::vector<std::string> names = columnNames(samples.channels);
    std::vector<double> model;
    for (const ValueInfluence& own : result.uncertainty->values) model.push_back(own.model);
    const std::vector<double> standardised =
        standardisedResiduals(samples, model, loss, result.parameters.size());
    for (std::size_t k = 0; k < count; ++k) {
        const Direction wi{samples.wiX[k], samples.wiY[k], samples.wiZ[k]};
        const std::string angles =
            fmt::format("{},{},{}", degrees(polarAngle(wi)), degrees(polarAngle(samples.wo[k])),
                        aspecularAngle(samples, k));
        for (std::size_t c = 0; c < channels; ++c) {
            const std::size_t v = c * count + k;
            const ValueInfluence& own = result.uncertainty->values[v];
            const double value = samples.values[v];
            write(fmt::format(
                "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}{}\n", rowOf(samples, {c, k}),
                samples.wiX[k], samples.wiY[k], samples.wiZ[k], samples.wo[k].x, samples.wo[k].y,
                samples.wo[k].z, names[c], value,
                samples.sigmas.empty() ? "" : fmt::format("{}", samples.sigmas[v]), own.model,
                value - own.model, own.studentised, own.leverage, own.cook, angles, standardised[v],
                predicted ? fmt::format("{}", prediction.errors[v]) : "",
                prediction.bootstrap ? fmt::format(",{}", prediction.bootstrap->errors[v]) : ""));
        }
    }
}

}  // namespace hshfit::brdfs
