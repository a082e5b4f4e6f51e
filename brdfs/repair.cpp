#include <brdfs/measured/measured_brdf.h>
#include <brdfs/repair.h>
#include <brdfs/spec.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>

namespace hshfit::brdfs {
namespace {

enum Kind : std::size_t { missing, holes, negative, reciprocity, energy, kinds };
using Chosen = std::array<bool, kinds>;

/// Reciprocal measurements differ by less than this through interpolation alone.
constexpr double reciprocityLimit = 1e-3;

std::string missingReason(const Brdf&, const Health& health) {
    if (health.coverage >= 1) return {};
    return fmt::format("{:.1f} % of the direction pairs are not measured",
                       100 * (1 - health.coverage));
}

std::string negativeReason(const Brdf&, const Health& health) {
    if (health.negative == 0) return {};
    return fmt::format("{} of {} sampled values are below 0", health.negative, health.values);
}

std::string reciprocityReason(const Brdf&, const Health& health) {
    if (health.reciprocityDefect <= reciprocityLimit) return {};
    return fmt::format("exchanged directions differ by {:.2g} of f", health.reciprocityDefect);
}

std::string energyReason(const Brdf&, const Health& health) {
    if (!health.isAboveOne()) return {};
    const double largest = health.largestAlbedo();
    return largest < 1e4 ? fmt::format("the largest albedo is {:.4f}", largest)
                         : fmt::format("the largest albedo is {:.4g}", largest);
}

Chosen parseNames(std::string_view names) {
    Chosen chosen{};
    if (names == "all") {
        chosen.fill(true);
        return chosen;
    }
    std::vector<std::string_view> known;
    for (const Repair& repair : repairs()) known.push_back(repair.name);
    for (std::size_t begin = 0; begin <= names.size();) {
        const std::size_t end = std::min(names.find(',', begin), names.size());
        const std::string_view name = names.substr(begin, end - begin);
        const auto found = std::ranges::find(known, name);
        if (found == known.end()) {
            throw UsageError(fmt::format("unknown repair '{}'{}; known: {}, all", name,
                                         suggestion(name, known), joined(known)));
        }
        chosen[static_cast<std::size_t>(found - known.begin())] = true;
        begin = end + 1;
    }
    return chosen;
}

/// The factor that keeps albedos at or below 1: 1 / max(1, albedo), by direction and channel.
class EnergyScale {
public:
    EnergyScale() = default;

    EnergyScale(const Brdf& brdf, const std::function<void(std::size_t, std::size_t)>& progress)
        : channels_(brdf.channels().count()) {
        const bool isotropic = brdf.laws().isotropic;
        thetas_ = isotropic ? 61 : 21;
        azimuths_ = isotropic ? 1 : 24;
        albedo_.resize(channels_ * thetas_ * azimuths_);
        std::atomic<std::size_t> done = 0;
        eachInParallel(thetas_ * azimuths_, [&](std::size_t node) {
            const double theta = thetaStep() * static_cast<double>(node / azimuths_);
            const double phi =
                2 * pi * static_cast<double>(node % azimuths_) / static_cast<double>(azimuths_);
            // f is 0 by definition at 90 degrees, so that the albedo there is that of 89.9 degrees.
            const auto albedo =
                directionalAlbedo(brdf, directionFromAngles(std::min(theta, radians(89.9)), phi));
            for (std::size_t c = 0; c < channels_; ++c) albedo_[node * channels_ + c] = albedo[c];
            if (progress) progress(++done, thetas_ * azimuths_);
        });
    }

    /// s(w), one value per channel.
    void at(const Direction& w, double* scale) const {
        const double row = polarAngle(w) / thetaStep();
        const double turns = azimuth(w) / (2 * pi);
        const double column = (turns - std::floor(turns)) * static_cast<double>(azimuths_);
        const auto r = std::min(static_cast<std::size_t>(row), thetas_ - 2);
        const auto p = static_cast<std::size_t>(column) % azimuths_, q = (p + 1) % azimuths_;
        const double t = std::min(row - static_cast<double>(r), 1.0);
        const double u = column - std::floor(column);
        for (std::size_t c = 0; c < channels_; ++c) {
            const auto node = [&](std::size_t i, std::size_t j) {
                return albedo_[(i * azimuths_ + j) * channels_ + c];
            };
            const double albedo = (1 - t) * ((1 - u) * node(r, p) + u * node(r, q)) +
                                  t * ((1 - u) * node(r + 1, p) + u * node(r + 1, q));
            scale[c] = 1 / std::max(1.0, albedo);
        }
    }

private:
    double thetaStep() const { return pi / 2 / static_cast<double>(thetas_ - 1); }

    std::size_t channels_ = 0, thetas_ = 0, azimuths_ = 0;
    std::vector<double> albedo_;
};

/// Evaluates single pairs, or several of the same wo, with the channels of a pair side by side.
class Repaired : public RepairedBrdf, public HasKinkCurves {
public:
    Repaired(std::unique_ptr<Brdf> brdf, Chosen chosen,
             const std::function<void(std::size_t, std::size_t)>& progress)
        : brdf_(std::move(brdf)), chosen_(chosen), laws_(brdf_->laws()) {
        laws_.nonNegative |= chosen[negative];
        laws_.reciprocal |= chosen[reciprocity];
        if (chosen[holes]) filler_.emplace(*brdf_, progress);
        if (!chosen[energy]) return;
        chosen_[energy] = false;  // the table holds albedos after the other repairs
        scale_ = EnergyScale(*this, progress);
        chosen_[energy] = true;
        laws_.energyConserving = true;
        evaluated_ = 0;
        for (auto& count : changed_) count = 0;
        for (auto& count : left_) count = 0;
        for (auto& count : byAngle_) count = 0;
    }

    std::string name() const override { return brdf_->name(); }
    const Channels& channels() const override { return brdf_->channels(); }
    const Laws& laws() const override { return laws_; }
    std::vector<Lobe> lobes(const Direction& wo) const override { return brdf_->lobes(wo); }
    std::vector<double> kinks(const Direction& wo) const override { return brdf_->kinks(wo); }
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return kinkCurvesOf(*brdf_, wo);
    }
    double defaultTolerance() const override { return brdf_->defaultTolerance(); }
    std::vector<Fact> facts() const override { return brdf_->facts(); }
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override {
        brdf_->coverage(wo, wi, covered);
    }
    void checkIntact() const override {
        const auto* measured = dynamic_cast<const MeasuredBrdf*>(brdf_.get());
        if (measured && (chosen_[missing] || chosen_[holes])) return measured->checkReadable();
        brdf_->checkIntact();
    }

    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;

    std::uint64_t evaluated() const override { return evaluated_; }
    std::vector<RepairCount> counts() const override {
        std::vector<RepairCount> result;
        for (std::size_t k = 0; k < kinds; ++k)
            if (chosen_[k]) result.push_back({repairs()[k].name, changed_[k], left_[k]});
        for (RepairCount& count : result) {
            if (count.name != repairs()[holes].name) continue;
            count.check = filler_->check();
            for (std::size_t i = 0; i < byAngle_.size(); ++i) count.byAngle[i] = byAngle_[i];
        }
        return result;
    }

private:
    struct Tally {
        std::array<std::uint64_t, kinds> changed{}, left{};
        std::array<std::uint64_t, 9> byAngle{};
    };

    bool covered(const Direction& wi, const Direction& wo) const;
    std::vector<double> continued(const Direction& wi, const Direction& wo, Tally& tally) const;
    std::vector<double> filled(const Direction& wi, const Direction& wo, bool isCovered,
                               Tally& tally) const;
    void clamp(std::vector<double>& values, Tally& tally) const;
    void exchange(const Direction& wi, const Direction& wo, bool isCovered,
                  std::vector<double>& values, Tally& tally) const;
    void limit(const Direction& wi, const double* outgoingScale, std::vector<double>& values,
               Tally& tally) const;

    std::unique_ptr<Brdf> brdf_;
    Chosen chosen_;
    Laws laws_;
    EnergyScale scale_;
    std::optional<HoleFiller> filler_;
    mutable std::atomic<std::uint64_t> evaluated_ = 0;
    mutable std::array<std::atomic<std::uint64_t>, kinds> changed_{}, left_{};
    mutable std::array<std::atomic<std::uint64_t>, 9> byAngle_{};
};

bool Repaired::covered(const Direction& wi, const Direction& wo) const {
    unsigned char result = 0;
    brdf_->coverage(wo, {&wi.x, &wi.y, &wi.z, 1}, &result);
    return result != 0;
}

/// By the filler, else as the repair `missing` where that is chosen too.
std::vector<double> Repaired::continued(const Direction& wi, const Direction& wo,
                                        Tally& tally) const {
    auto values = filler_->fill(wi, wo);
    if (!values) {
        tally.left[holes] += brdf_->channels().count();
        return {};
    }
    tally.changed[holes] += values->size();
    const double angle = std::max(polarAngle(wi), polarAngle(wo)) / radians(10);
    tally.byAngle[std::min<std::size_t>(static_cast<std::size_t>(angle), 8)] += values->size();
    return std::move(*values);
}

/// f, or that of the nearest covered pair with the same half vector and a smaller theta_d.
std::vector<double> Repaired::filled(const Direction& wi, const Direction& wo, bool isCovered,
                                     Tally& tally) const {
    if (!isCovered && chosen_[holes])
        if (auto values = continued(wi, wo, tally); !values.empty()) return values;
    if (isCovered || !chosen_[missing]) return evaluate(*brdf_, wi, wo);
    const Direction sum{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
    const Direction difference{wi.x - wo.x, wi.y - wo.y, wi.z - wo.z};
    const double across = std::sqrt(dot(sum, sum)), along = std::sqrt(dot(difference, difference));
    const double thetaDifference = std::atan2(along, across);
    for (double theta = thetaDifference - radians(1); theta > -radians(1); theta -= radians(1)) {
        const double t = std::max(theta, 0.0);
        const double s = along > 0 ? std::sin(t) / along : 0, c = std::cos(t) / across;
        const Direction i{c * sum.x + s * difference.x, c * sum.y + s * difference.y,
                          c * sum.z + s * difference.z};
        const Direction o{c * sum.x - s * difference.x, c * sum.y - s * difference.y,
                          c * sum.z - s * difference.z};
        if (i.z <= 0 || o.z <= 0 || !covered(i, o)) continue;
        const auto values = evaluate(*brdf_, i, o);
        tally.changed[missing] += values.size();
        return values;
    }
    const auto values = evaluate(*brdf_, wi, wo);
    tally.left[missing] += values.size();
    return values;
}

void Repaired::clamp(std::vector<double>& values, Tally& tally) const {
    if (!chosen_[negative]) return;
    for (double& value : values) {
        if (!(value < 0)) continue;
        value = 0;
        ++tally.changed[negative];
    }
}

void Repaired::exchange(const Direction& wi, const Direction& wo, bool isCovered,
                        std::vector<double>& values, Tally& tally) const {
    if (!chosen_[reciprocity]) return;
    const bool exchangedCovered = covered(wo, wi);
    Tally ignored;
    std::vector<double> exchanged = filled(wo, wi, exchangedCovered, ignored);
    clamp(exchanged, ignored);
    const double weight = isCovered == exchangedCovered ? 0.5 : exchangedCovered ? 1 : 0;
    for (std::size_t c = 0; c < values.size(); ++c) {
        const double mean = (1 - weight) * values[c] + weight * exchanged[c];
        if (mean != values[c]) ++tally.changed[reciprocity];
        values[c] = mean;
    }
}

void Repaired::limit(const Direction& wi, const double* outgoingScale, std::vector<double>& values,
                     Tally& tally) const {
    if (!chosen_[energy]) return;
    std::vector<double> scale(values.size());
    scale_.at(wi, scale.data());
    for (std::size_t c = 0; c < values.size(); ++c) {
        const double factor = std::min(scale[c], outgoingScale[c]);
        if (factor < 1 && values[c] != 0) ++tally.changed[energy];
        values[c] *= factor;
    }
}

void Repaired::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = brdf_->channels().count();
    std::vector<unsigned char> isCovered(wi.count);
    brdf_->coverage(wo, wi, isCovered.data());
    std::vector<double> outgoingScale(channels, 1.0);
    if (chosen_[energy] && wo.z > 0) scale_.at(wo, outgoingScale.data());
    Tally tally;
    std::uint64_t evaluated = 0;
    for (std::size_t k = 0; k < wi.count; ++k) {
        const Direction i{wi.x[k], wi.y[k], wi.z[k]};
        std::vector<double> values(channels, 0.0);
        if (wo.z > 0 && i.z > 0) {
            values = filled(i, wo, isCovered[k] != 0, tally);
            clamp(values, tally);
            exchange(i, wo, isCovered[k] != 0, values, tally);
            limit(i, outgoingScale.data(), values, tally);
            evaluated += channels;
        }
        for (std::size_t c = 0; c < channels; ++c) out[c * wi.count + k] = values[c];
    }
    evaluated_ += evaluated;
    for (std::size_t r = 0; r < kinds; ++r) {
        changed_[r] += tally.changed[r];
        left_[r] += tally.left[r];
    }
    for (std::size_t i = 0; i < byAngle_.size(); ++i) byAngle_[i] += tally.byAngle[i];
}

}  // namespace

std::span<const Repair> repairs() {
    static constexpr std::array<Repair, kinds> table{{
        {"missing", "continue f along theta_d to where nothing was measured", missingReason},
        {"holes", "fill where nothing was measured smoothly from all sides, and check the fills",
         missingReason},
        {"negative", "raise values below 0 to 0", negativeReason},
        {"reciprocity", "average f over exchanged directions", reciprocityReason},
        {"energy", "scale f down where an albedo is above 1", energyReason},
    }};
    return table;
}

std::unique_ptr<RepairedBrdf> repaired(
    std::unique_ptr<Brdf> brdf, std::string_view names,
    const std::function<void(std::size_t, std::size_t)>& progress) {
    const Chosen chosen = parseNames(names);
    return std::make_unique<Repaired>(std::move(brdf), chosen, progress);
}

}  // namespace hshfit::brdfs
