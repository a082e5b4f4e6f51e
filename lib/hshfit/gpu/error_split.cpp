#include <hshfit/gpu/error_split.h>

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/projection/one_basis.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::gpu {
namespace {

/// Directions of a golden-angle spiral: equal solid angles, no two at one elevation or azimuth.
std::vector<Direction> spiral(std::size_t count) {
    std::vector<Direction> directions;
    const double turn = pi * (3 - std::sqrt(5.0));
    for (std::size_t k = 0; k < count; ++k) {
        const double z = 1 - (static_cast<double>(k) + 0.5) / static_cast<double>(count);
        directions.push_back(directionFromAngles(std::acos(z), turn * static_cast<double>(k)));
    }
    return directions;
}

OutgoingSet measuredAt(const OutgoingSet& stored, std::size_t count) {
    if (stored.map == OutgoingSet::Map::direction) return stored;
    OutgoingSet set;
    set.directions = spiral(count);
    set.solidAngles.assign(count, 2 * pi / static_cast<double>(count));
    return set;
}

/// Coefficients without interpolation between outgoing directions: each direction of the set
/// has its own, and other directions must not be evaluated.
class AtDirections : public Brdf {
public:
    explicit AtDirections(const Coefficients& c) : channels_(c.channels) {
        const std::size_t size = c.channels.count() * c.slots();
        for (std::size_t k = 0; k < c.outgoing.size(); ++k) {
            Coefficients one = c;
            one.outgoing =
                OutgoingSet{.directions = {c.outgoing.directions[k]}, .solidAngles = {1}};
            one.values.assign(c.at(k, 0), c.at(k, 0) + size);
            each_.emplace_back(std::move(one));
        }
    }

    std::string name() const override { return "projection at its own directions"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        const auto closest =
            std::max_element(each_.begin(), each_.end(), [&](const auto& a, const auto& b) {
                return dot(directionOf(a), wo) < dot(directionOf(b), wo);
            });
        closest->eval(wo, wi, out);
    }

private:
    static const Direction& directionOf(const Reconstruction& r) {
        return r.coefficients().outgoing.directions[0];
    }
    Channels channels_;
    Laws laws_;
    std::vector<Reconstruction> each_;
};

/// A BRDF of value 0: the error of another BRDF against it is the norm of that BRDF.
class Black : public Brdf {
public:
    explicit Black(Channels channels) : channels_(std::move(channels)) {}
    std::string name() const override { return "black"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& /*wo*/, DirectionBatch wi, double* out) const override {
        std::fill_n(out, wi.count * channels_.count(), 0.0);
    }

private:
    Channels channels_;
    Laws laws_;
};

double metric(const char* name, const Brdf& f, const Brdf& g, const OutgoingSet& set, int level) {
    return compare(f, g, set, selectMetrics(name), {.level = level})[0].value.value_or(
        std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

ErrorSplit splitError(const Brdf& f, const Coefficients& coefficients, const Payload& payload,
                      const ErrorSplitOptions& options) {
    const OutgoingSet set = measuredAt(coefficients.outgoing, options.outgoing);
    const auto basis = bases::make(coefficients.basis, coefficients.order,
                                   {.condonShortley = coefficients.condonShortley});
    const auto plainly = [&](const OutgoingSet& outgoing) {
        return project(f, *basis, outgoing,
                       {.quantity = coefficients.quantity,
                        .tolerance = options.tolerance,
                        .progress = options.progress})
            .coefficients;
    };
    const AtDirections projected(plainly(set));
    const Reconstruction given(coefficients), stored(unpack(payload));
    const std::optional<Reconstruction> again =
        options.plain ? std::nullopt
                      : std::optional<Reconstruction>(plainly(coefficients.outgoing));
    const Reconstruction& interpolated = again ? *again : given;
    const auto rms = [&](const Brdf& a, const Brdf& b) {
        return metric("ngan", a, b, set, options.level);
    };
    const double norm = rms(f, Black(f.channels()));
    if (!(norm > 0)) {
        throw NumericError(
            fmt::format("{} is 0 at the directions where the error was to be measured", f.name()));
    }
    return {.truncation = rms(f, projected) / norm,
            .interpolation = rms(projected, interpolated) / norm,
            .form = again ? rms(interpolated, given) / norm : 0,
            .quantisation = rms(given, stored) / norm,
            .total = rms(f, stored) / norm,
            .meanLog = metric("nbrdf", f, stored, set, options.level),
            .outgoing = set.size()};
}

std::optional<BasisTextureError> basisTextureError(const Payload& payload) {
    if (!payload.basisTexels) return std::nullopt;
    const Texels& texture = *payload.basisTexels;
    const auto basis = bases::make(payload.head.basis, payload.head.order,
                                   {.condonShortley = payload.head.condonShortley});
    const OutgoingSet map = OutgoingSet::parabolic(texture.width, texture.height);
    const std::vector<double> values = decode(texture);
    const std::size_t pixels = map.size();
    std::vector<double> exact(static_cast<std::size_t>(basis->slots()));
    BasisTextureError error;
    double squares = 0, count = 0;
    for (const Direction& wi : spiral(4096)) {
        basis->evaluate(wi, exact.data());
        const OutgoingLookup found = lookUp(map, wi);
        for (std::size_t j = 0; j < payload.slots.size(); ++j) {
            double looked = 0;
            for (int i = 0; i < found.count; ++i)
                looked += found.weight[i] * values[(j / 4 * pixels + found.index[i]) * 4 + j % 4];
            const double difference =
                std::abs(looked - exact[static_cast<std::size_t>(payload.slots[j])]);
            error.largest = std::max(error.largest, difference);
            if (wi.z > std::sin(radians(6)))
                error.largestAbove6 = std::max(error.largestAbove6, difference);
            squares += difference * difference;
            count += 1;
        }
    }
    error.rms = std::sqrt(squares / count);
    return error;
}

}  // namespace hshfit::gpu
