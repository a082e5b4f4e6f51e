#include <brdfs/measured/scattered/angle_tables.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/table_interpolant.h>
#include <hshfit/brdf/channel_view.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::brdfs {
namespace {

bool oneAzimuth(const std::vector<Direction>& directions) {
    const Direction* first = nullptr;
    for (const Direction& d : directions) {
        if (std::hypot(d.x, d.y) < 1e-4) continue;
        if (!first) first = &d;
        // Both sides of the normal are one plane.
        const double across = d.x * first->y - d.y * first->x;
        if (std::fabs(across) > 1e-5 * std::hypot(d.x, d.y) * std::hypot(first->x, first->y)) {
            return false;
        }
    }
    return true;
}

Chart chartOf(const Samples& samples, const ScatteredOptions& options) {
    if (samples.chart != Chart::anisotropic) return samples.chart;
    const bool implied = oneAzimuth(samples.wi) || oneAzimuth(samples.wo);
    const bool isotropic = options.isotropic.value_or(samples.isotropic || implied);
    return isotropic ? Chart::isotropic : Chart::anisotropic;
}

/// Whether all samples lie on one side of the plane of incidence, by the third Hopf coordinate.
bool oneSided(const Samples& samples) {
    bool left = false, right = false;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double side = chartPoint(Chart::isotropic, samples.wi[k], samples.wo[k])[2];
        left = left || side > 1e-3;
        right = right || side < -1e-3;
    }
    return !(left && right);
}

/// Whether wi, wo and the normal of every pair lie in one plane.
bool inPlaneAlone(const Samples& samples) {
    if (samples.chart != Chart::anisotropic) return false;
    for (std::size_t k = 0; k < samples.size(); ++k)
        if (std::fabs(chartPoint(Chart::isotropic, samples.wi[k], samples.wo[k])[2]) > 1e-3)
            return false;
    return true;
}

Laws lawsOf(Chart chart, const Folding& folding) {
    Laws laws;
    laws.nonNegative = true;
    switch (chart) {
        case Chart::isotropic:
        case Chart::anisotropic:
            laws.reciprocal = folding.exchange;
            laws.mirrorSymmetric = folding.mirror;
            laws.isotropic = chart == Chart::isotropic;
            break;
        case Chart::halfVector:
        case Chart::halfVectorDistance:
            laws.reciprocal = true;
            break;
        case Chart::backVector:
            break;
        default:  // functions of angles between the directions and the normal alone
            laws.reciprocal = laws.isotropic = laws.mirrorSymmetric = true;
            break;
    }
    return laws;
}

std::optional<bool> answer(const std::string& word) {
    return word == "auto" ? std::nullopt : std::optional(word == "yes");
}

Axis angleAxis(const std::string& name, std::vector<double> angles) {
    std::ranges::sort(angles);
    Axis axis{.name = name, .unit = "degrees", .count = 0, .first = 0, .last = 0, .largestGap = 0};
    double last = 0;
    for (const double angle : angles) {
        const double value = degrees(angle);
        if (axis.count > 0 && value - last < 1e-2) continue;
        if (axis.count > 0) axis.largestGap = std::max(axis.largestGap, value - last);
        if (axis.count == 0) axis.first = value;
        axis.last = last = value;
        ++axis.count;
    }
    return axis;
}

}  // namespace

std::vector<Parameter> scatteredParameters(std::vector<Parameter> more) {
    std::vector<Parameter> parameters{
        {.name = "isotropic",
         .help = "take the samples as isotropic; auto: if the file says or implies it",
         .kind = Parameter::Kind::choice,
         .choices = {"auto", "yes", "no"}},
        {.name = "mirror",
         .help = "mirror the samples at the plane of incidence (anisotropic: at both axes); auto: "
                 "if they are isotropic and on one side",
         .kind = Parameter::Kind::choice,
         .choices = {"auto", "yes", "no"}},
        {.name = "exchange",
         .help = "a sample stands for the pair with wi and wo exchanged, too",
         .kind = Parameter::Kind::choice,
         .choices = {"yes", "no"}},
        {.name = "reach",
         .help = "degrees from a sample within which f rests on it",
         .kind = Parameter::Kind::number,
         .fallback = 10,
         .min = 0.01,
         .max = 180},
        {.name = "scale",
         .help = "factor on the values of the file",
         .kind = Parameter::Kind::number,
         .fallback = 1,
         .min = 0,
         .max = 1e9},
        {.name = "quantity",
         .help =
             "the values of the file: brdf, f in 1/sr; radiance-factor, pi f, which is 1 for an "
             "ideal Lambert surface",
         .kind = Parameter::Kind::choice,
         .choices = {"brdf", "radiance-factor"}},
    };
    parameters.insert(parameters.end(), more.begin(), more.end());
    return parameters;
}

ScatteredOptions scatteredOptions(const Parameters& parameters) {
    return {.isotropic = answer(parameters.choice("isotropic")),
            .mirror = answer(parameters.choice("mirror")),
            .exchange = parameters.choice("exchange") == "yes",
            .reach = radians(parameters.number("reach")),
            .scale = scaleOf(parameters)};
}

double scaleOf(const Parameters& parameters) {
    const bool factor = parameters.choice("quantity") == "radiance-factor";
    return parameters.number("scale") * (factor ? 1 / pi : 1);
}

Parameter zerosParameter() {
    return {.name = "zeros",
            .help = "meaning of values of exactly 0 above the horizon",
            .kind = Parameter::Kind::choice,
            .choices = {"unmeasured", "values"}};
}

bool zerosAreMeasured(const Parameters& parameters) {
    return parameters.choice("zeros") == "values";
}

std::string zerosLeftOut(std::size_t count) {
    return fmt::format("{} values of 0 above the horizon (option zeros)", count);
}

Scattered::Scattered(Samples samples, const ScatteredOptions& options, std::string name)
    : samples_(std::move(samples)), options_(options), name_(std::move(name)) {
    if (samples_.size() == 0) {
        const bool parts = !samples_.leftOut.empty();
        throw InputError(
            fmt::format("{}: no sample is above the horizon ({} are below it{}{})", name_,
                        samples_.census.belowHorizon / samples_.channels.count(),
                        parts ? "; not read: " : "", fmt::join(samples_.leftOut, "; ")));
    }
    if (options_.scale != 1) samples_.scale(options_.scale);
    const MuellerElements& elements = samples_.elements;
    const bool reflectance = elements.isReflectance(), positive = elements.arePositive();
    chart_ = chartOf(samples_, options_);
    const bool ofPairs = chart_ == Chart::isotropic || chart_ == Chart::anisotropic;
    folding_.exchange = options_.exchange && ofPairs && reflectance;
    folding_.mirror = ofPairs && positive &&
                      options_.mirror.value_or(chart_ == Chart::isotropic && oneSided(samples_));
    laws_ = lawsOf(chart_, folding_);
    laws_.nonNegative = positive;
    images_ = images(chart_, folding_);
    std::vector<Point> points;
    std::vector<double> values;
    const std::size_t channels = samples_.channels.count();
    const std::vector<Point> same = images(chart_, {.exchange = false, .mirror = folding_.mirror});
    ScatterInterpolant::Exchanged exchanged;
    for (const Point& signs : images_)
        exchanged.push_back(std::ranges::find(same, signs) == same.end());
    points.reserve(samples_.size() * images_.size());
    values.reserve(samples_.values.size() * images_.size());
    for (std::size_t k = 0; k < samples_.size(); ++k) {
        const Point at = chartPoint(chart_, samples_.wi[k], samples_.wo[k]);
        for (const Point& signs : images_) {
            Point image;
            for (std::size_t c = 0; c < image.size(); ++c) image[c] = at[c] * signs[c];
            points.push_back(image);
            for (std::size_t c = 0; c < channels; ++c) {
                const double value = samples_.values[k * channels + c];
                const bool clamped = elements.isPositive(c * elements.size() / channels);
                values.push_back(clamped ? std::max(0.0, value) : value);
            }
        }
    }
    interpolant_ = std::make_unique<ScatterInterpolant>(dimensions(chart_), std::move(points),
                                                        values, channels, exchanged);
    if (std::ranges::any_of(interpolant_->bothOrders(),
                            &ScatterInterpolant::BothOrders::contradict)) {
        images_ = same;
        laws_.reciprocal = false;
    }
    if (options_.tables != ScatteredOptions::Tables::none) interpolateOnTables();
    if (ofPairs) lobes_ = sampleLobes(samples_);
}

Scattered::~Scattered() = default;

void Scattered::interpolateOnTables() {
    const bool isotropic = chart_ == Chart::isotropic;
    // The tables of an anisotropic sample are not folded at its axes.
    if (!isotropic && (chart_ != Chart::anisotropic || folding_.mirror)) return;
    const bool aboutMirror = options_.tables == ScatteredOptions::Tables::aboutMirror;
    const std::vector<AngleTable> tables = tablesOf(samples_, aboutMirror, isotropic);
    if (!TableInterpolant::suits(tables, isotropic)) return;
    std::vector<double> values = samples_.values;
    const std::size_t channels = samples_.channels.count();
    const MuellerElements& elements = samples_.elements;
    for (std::size_t k = 0; k < values.size(); ++k)
        if (elements.isPositive(k % channels * elements.size() / channels))
            values[k] = std::max(0.0, values[k]);
    const TableInterpolant::Options options{
        .isotropic = isotropic, .mirror = folding_.mirror, .reach = options_.reach};
    onTables_ = std::make_unique<TableInterpolant>(tables, values, channels, options);
    laws_.reciprocal = false;
}

void Scattered::evalScattered(const Point& at, double* out, std::size_t stride,
                              ScatterInterpolant::Trail& trail) const {
    const double limit = 1.5 * options_.reach;
    const double away = interpolant_->evaluate(at, limit, out, stride, &trail);
    if (away <= options_.reach || away > limit) return;
    const double t = (limit - away) / (limit - options_.reach);
    const double fade = t * t * (3 - 2 * t);
    for (std::size_t c = 0; c < samples_.channels.count(); ++c) out[c * stride] *= fade;
}

void Scattered::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = samples_.channels.count();
    ScatterInterpolant::Trail trail;
    std::vector<double> onTables(onTables_ ? channels : 0);
    for (std::size_t k = 0; k < wi.count; ++k) {
        const Direction in{wi.x[k], wi.y[k], wi.z[k]};
        if (!(in.z > 0) || !(wo.z > 0)) {
            for (std::size_t c = 0; c < channels; ++c) out[c * wi.count + k] = 0;
            continue;
        }
        const double weight = onTables_ ? onTables_->evaluate(in, wo, onTables.data(), 1) : 0;
        if (weight < 1)
            evalScattered(folded(chartPoint(chart_, in, wo), images_), out + k, wi.count, trail);
        for (std::size_t c = 0; c < onTables.size(); ++c) {
            double& f = out[c * wi.count + k];
            f = weight < 1 ? f + weight * (onTables[c] - f) : onTables[c];
        }
    }
}

void Scattered::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    std::vector<double> onTables(samples_.channels.count());
    for (std::size_t k = 0; k < wi.count; ++k) {
        covered[k] = 0;
        const Direction in{wi.x[k], wi.y[k], wi.z[k]};
        if (!(in.z > 0) || !(wo.z > 0)) continue;
        if (onTables_ && onTables_->evaluate(in, wo, onTables.data(), 1) >= 1) {
            covered[k] = 1;
            continue;
        }
        const Point at = folded(chartPoint(chart_, in, wo), images_);
        covered[k] = interpolant_->nearest(at) <= options_.reach;
    }
}

std::vector<Lobe> Scattered::lobes(const Direction& wo) const {
    std::vector<Lobe> lobes;
    if (lobes_.mirror > 0)
        lobes.push_back({.about = Lobe::About::halfway, .width = lobes_.mirror, .axis = {}});
    if (lobes_.back > 0)
        lobes.push_back({.about = Lobe::About::axis, .width = lobes_.back, .axis = wo});
    return lobes;
}

std::optional<BothOrders> Scattered::bothOrders() const {
    BothOrders both;
    double difference = 0, sum = 0, largest = 0;
    const std::size_t channels = samples_.channels.count();
    for (const auto& place : interpolant_->bothOrders()) {
        // Each pair comes by either of its samples.
        if (place.sample > place.exchangedSample) continue;
        const Direction &wi = samples_.wi[place.sample], &wo = samples_.wo[place.sample];
        ++both.pairs;
        for (std::size_t c = 0; c < channels; ++c) {
            const double value = place.value[c], exchanged = place.exchanged[c];
            const double apart = wi.z * wo.z * std::fabs(value - exchanged);
            difference += apart;
            sum += wi.z * wo.z * (value + exchanged);
            const auto [less, more] = std::minmax(value, exchanged);
            if (less > 0) both.largestRatio = std::max(both.largestRatio, more / less);
            if (apart <= largest) continue;
            largest = apart;
            both.worst = Health::Exchange{wi, wo, c, value, exchanged};
        }
    }
    if (both.pairs == 0) return std::nullopt;
    if (sum > 0) both.defect = difference / sum;
    return both;
}

std::unique_ptr<Brdf> Scattered::scaled(double factor, std::string name) const {
    ScatteredOptions options = options_;
    options.scale = factor;  // the samples have the one of the file
    return std::make_unique<Scattered>(samples_, options, std::move(name));
}

DirectionSamples MeasuredPairs::directionSamples() const {
    if (samples.chart != Chart::anisotropic) {
        throw UsageError(fmt::format("{}: holds a function of {}, not of pairs of directions", name,
                                     chartName(samples.chart)));
    }
    return {.wi = samples.wi,
            .wo = samples.wo,
            .values = samples.values,
            .channels = samples.channels,
            .symmetry = laws,
            .name = name};
}

std::optional<MeasuredPairs> measuredPairs(const Brdf& brdf) {
    if (const auto* measured = dynamic_cast<const HasMeasuredPairs*>(&brdf))
        return MeasuredPairs{measured->samples(), brdf.laws(), brdf.name()};
    const auto* view = dynamic_cast<const ChannelView*>(&brdf);
    if (!view) return std::nullopt;
    auto pairs = measuredPairs(view->seen());
    if (!pairs) return std::nullopt;
    const std::size_t from = pairs->samples.channels.count(), to = view->channels().count();
    std::vector<double> values(pairs->samples.size() * to);
    for (std::size_t k = 0; k < pairs->samples.size(); ++k)
        view->convert(std::span(pairs->samples.values).subspan(k * from, from),
                      std::span(values).subspan(k * to, to));
    pairs->samples.values = std::move(values);
    pairs->samples.channels = view->channels();
    pairs->samples.sigmas.clear();  // of the channels that are seen
    pairs->samples.rows.clear();
    pairs->laws = view->laws();
    pairs->name = view->name();
    return pairs;
}

std::vector<Fact> Scattered::facts() const {
    std::vector<Fact> facts = samples_.facts;
    facts.emplace_back("samples", static_cast<std::int64_t>(samples_.size()));
    facts.emplace_back("interpolated_over",
                       onTables_ ? "the tables of the file" : std::string(chartName(chart_)));
    facts.emplace_back("nodes", static_cast<std::int64_t>(interpolant_->nodes()));
    facts.emplace_back("exchanged", folding_.exchange);
    facts.emplace_back("mirrored", folding_.mirror);
    facts.emplace_back("reach_degrees", degrees(options_.reach));
    if (inPlaneAlone(samples_))
        facts.emplace_back("in_plane",
                           "all samples; f out of the plane of incidence takes a fitted model");
    if (!samples_.leftOut.empty()) {
        facts.emplace_back("not_read", fmt::format("{}", fmt::join(samples_.leftOut, "; ")));
    }
    return facts;
}

std::vector<Axis> Scattered::axes() const {
    std::vector<Axis> axes;
    const auto add = [&](const std::string& name, const std::vector<Direction>& directions,
                         double (*angle)(const Direction&)) {
        std::vector<double> angles;
        for (const Direction& d : directions) angles.push_back(angle(d));
        axes.push_back(angleAxis(name, std::move(angles)));
    };
    add("theta_i", samples_.wi, polarAngle);
    add("phi_i", samples_.wi, azimuth);
    add("theta_o", samples_.wo, polarAngle);
    add("phi_o", samples_.wo, azimuth);
    return axes;
}

}  // namespace hshfit::brdfs
