#include <hshfit/representation/split.h>

#include <hshfit/error.h>
#include <hshfit/linear_algebra/descend.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline representation {
namespace {

constexpr double lowestRing = 89 * (pi / 180);  // as far down as outgoing directions are kept

/// Smallest value of one channel at covered pairs; +infinity where not covered.
class Infimum {
public:
    Infimum(const Brdf& brdf, std::size_t channel) : brdf_(brdf), channel_(channel) {}

    /// x: theta_o, theta_i, phi_i - phi_o, phi_o.
    double at(const std::vector<double>& x) const {
        const Direction wo = directionFromAngles(x[0], x[3]);
        const Direction wi = directionFromAngles(x[1], x[2] + x[3]);
        const DirectionBatch one{&wi.x, &wi.y, &wi.z, 1};
        unsigned char covered = 0;
        brdf_.coverage(wo, one, &covered);
        if (!covered) return std::numeric_limits<double>::infinity();
        return evaluate(brdf_, wi, wo)[channel_];
    }

    double search() const {
        const Laws& laws = brdf_.laws();
        const bool even = laws.isotropic && laws.mirrorSymmetric;
        const int polar = 13, azimuths = even ? 13 : 24, turns = laws.isotropic ? 1 : 12;
        const double step = even ? pi / (azimuths - 1) : 2 * pi / azimuths;
        const double polarStep = lowestRing / (polar - 1);
        struct Node {
            double value;
            std::vector<double> x;
        };
        std::vector<Node> nodes;
        for (int o = 0; o < polar; ++o) {
            for (int i = laws.reciprocal && even ? o : 0; i < polar; ++i) {
                for (int j = 0; j < azimuths; ++j) {
                    for (int t = 0; t < turns; ++t) {
                        std::vector<double> x{o * polarStep, i * polarStep, j * step,
                                              t * 2 * pi / turns};
                        const double value = at(x);
                        if (std::isfinite(value)) nodes.push_back({value, std::move(x)});
                    }
                }
            }
        }
        if (nodes.empty()) return 0;
        const auto first = nodes.begin();
        const auto last =
            first + static_cast<std::ptrdiff_t>(std::min<std::size_t>(16, nodes.size()));
        std::partial_sort(first, last, nodes.end(),
                          [](const Node& a, const Node& b) { return a.value < b.value; });
        constexpr double all = std::numeric_limits<double>::infinity();
        const std::vector<SearchAxis> axes{{polarStep, 0, lowestRing},
                                           {polarStep, 0, lowestRing},
                                           {step, -all, all},
                                           {laws.isotropic ? 0 : 2 * pi / turns, -all, all}};
        double smallest = first->value;
        const auto value = [&](const std::vector<double>& x) { return at(x); };
        for (auto node = first; node != last && smallest > 0; ++node) {
            smallest = std::min(smallest, descend(value, node->x, axes));
        }
        return smallest;
    }

private:
    const Brdf& brdf_;
    std::size_t channel_;
};

/// In single precision, as files keep it, and not above `value`.
double roundedDown(double value) {
    auto rounded = static_cast<float>(value);
    if (rounded > value) rounded = std::nextafter(rounded, 0.0F);
    return rounded;
}

std::string lambertSpec(const std::vector<double>& albedo) {
    std::string values;
    for (double each : albedo) {
        values += fmt::format("{}{}", values.empty() ? "" : "/", static_cast<float>(each));
    }
    return "lambert:kd=" + values;
}

Laws lawsOfRemainder(const Brdf& whole, const Brdf* added, bool nonNegative) {
    Laws laws = whole.laws();
    if (!added) return laws;
    const Laws& other = added->laws();
    laws.nonNegative = nonNegative;
    laws.reciprocal &= other.reciprocal;
    laws.isotropic &= other.isotropic;
    laws.mirrorSymmetric &= other.mirrorSymmetric;
    laws.energyConserving &= other.nonNegative;
    return laws;
}

}  // namespace

Remainder::Remainder(const Brdf& whole, std::unique_ptr<Brdf> added, bool nonNegative)
    : whole_(whole),
      added_(std::move(added)),
      laws_(lawsOfRemainder(whole, added_.get(), nonNegative)) {
    if (!added_) return;
    const Channels &ours = whole.channels(), &theirs = added_->channels();
    if (!theirs.serve(ours)) {
        throw UsageError(fmt::format(
            "{} has other channels ({}) than {} ({})", Setting{"Form::split", added_->name()},
            fmt::join(theirs.names(), " "), whole.name(), fmt::join(ours.names(), " ")));
    }
}

void Remainder::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    whole_.eval(wo, wi, out);
    if (!added_) return;
    const std::size_t theirs = added_->channels().count();
    std::vector<double> less(theirs * wi.count);
    added_->eval(wo, wi, less.data());
    for (std::size_t c = 0; c < channels().count(); ++c) {
        const double* from = less.data() + (theirs == 1 ? 0 : c) * wi.count;
        for (std::size_t k = 0; k < wi.count; ++k) out[c * wi.count + k] -= from[k];
    }
}

void Remainder::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    whole_.coverage(wo, wi, covered);
    if (!added_) return;
    std::vector<unsigned char> own(wi.count);
    added_->coverage(wo, wi, own.data());
    for (std::size_t k = 0; k < wi.count; ++k) covered[k] = covered[k] && own[k];
}

std::vector<Lobe> Remainder::lobes(const Direction& wo) const {
    std::vector<Lobe> all = whole_.lobes(wo);
    if (!added_) return all;
    for (const Lobe& lobe : added_->lobes(wo)) all.push_back(lobe);
    return all;
}

std::vector<double> Remainder::kinks(const Direction& wo) const {
    std::vector<double> all = whole_.kinks(wo);
    if (!added_) return all;
    for (double height : added_->kinks(wo)) all.push_back(height);
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

std::vector<KinkCurve> Remainder::kinkCurves(const Direction& wo) const {
    std::vector<KinkCurve> all = kinkCurvesOf(whole_, wo);
    if (!added_) return all;
    for (const KinkCurve& curve : kinkCurvesOf(*added_, wo)) all.push_back(curve);
    return all;
}

double Remainder::defaultTolerance() const {
    const double own = whole_.defaultTolerance();
    return added_ ? std::max(own, added_->defaultTolerance()) : own;
}

void Remainder::checkIntact() const {
    whole_.checkIntact();
    if (added_) added_->checkIntact();
}

const Brdf* addedTo(const Brdf& brdf) {
    const auto* remainder = dynamic_cast<const Remainder*>(&brdf);
    return remainder ? remainder->added() : nullptr;
}

std::vector<double> diffuseAlbedo(const Brdf& brdf) {
    std::vector<double> albedo;
    for (std::size_t c = 0; c < brdf.channels().count(); ++c) {
        albedo.push_back(roundedDown(std::clamp(pi * Infimum(brdf, c).search(), 0.0, 1.0)));
    }
    if (brdf.channels().kind == Channels::Kind::spectral) {
        albedo = {*std::ranges::min_element(albedo)};
    }
    return albedo;
}

Split takeOut(const Brdf& brdf, const std::string& what, const BrdfOpener& open) {
    if (what != "diffuse") {
        return {what, std::make_unique<Remainder>(brdf, open(what), false)};
    }
    const std::vector<double> albedo = diffuseAlbedo(brdf);
    if (*std::ranges::max_element(albedo) == 0) {
        return {"", std::make_unique<Remainder>(brdf, nullptr, brdf.laws().nonNegative)};
    }
    const std::string added = lambertSpec(albedo);
    return {added, std::make_unique<Remainder>(brdf, open(added), true)};
}

}  // namespace hshfit::inline representation
