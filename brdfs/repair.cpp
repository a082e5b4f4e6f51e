#include <brdfs/measured/measured_brdf.h>
#include <brdfs/repair.h>
#include <brdfs/rows/spec.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/brdf/steps.h>
#include <hshfit/brdf/transmission.h>
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

std::string reciprocityReason(const Brdf& brdf, const Health& health) {
    if (transmits(brdf) || health.reciprocityDefect <= reciprocityLimit) return {};
    return fmt::format("exchanged directions differ by {:.2g} of f", health.reciprocityDefect);
}

std::string energyReason(const Brdf& brdf, const Health& health) {
    if (!health.createsEnergy()) return {};
    const double largest = health.largestReflectance();
    const char* const share = transmits(brdf) ? "transmittance" : "reflectance";
    return largest < 1e4 ? fmt::format("the largest {} is {:.4f}", share, largest)
                         : fmt::format("the largest {} is {:.4g}", share, largest);
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

/// The factor that keeps reflectances at or below 1: 1 / max(1, reflectance), by direction and
/// channel.
class EnergyScale {
public:
    EnergyScale() = default;

    EnergyScale(const Brdf& brdf, const HasSteps* steps,
                const std::function<void(std::size_t, std::size_t)>& progress)
        : channels_(brdf.channels().count()) {
        const std::size_t cells = steps ? steps->cells() : 0;
        if (cells > 0 && cells <= mostCells) steps_ = steps;
        const bool isotropic = brdf.laws().isotropic;
        thetas_ = isotropic ? 61 : 21;
        azimuths_ = isotropic ? 1 : 24;
        const std::size_t nodes = steps_ ? cells : thetas_ * azimuths_;
        reflectance_.resize(channels_ * nodes);
        std::atomic<std::size_t> done = 0;
        eachInParallel(nodes, [&](std::size_t node) {
            const Direction wi = steps_ ? steps_->cellCentre(node) : directionOf(node);
            const AlbedoEstimate found =
                estimateReflectance(brdf, wi, {.tolerance = tolerance, .absolute = tolerance});
            if (!found.converged)
                throw NumericError(
                    fmt::format("{}: the reflectance at theta_i = {:.6g} degrees did not converge",
                                brdf.name(), degrees(polarAngle(wi))));
            for (std::size_t c = 0; c < channels_; ++c)
                reflectance_[node * channels_ + c] = found.values[c];
            if (progress) progress(++done, nodes);
        });
    }

    /// s(w), one value per channel.
    void at(const Direction& w, double* scale) const {
        if (steps_) return ofCell(steps_->cellOf(w), scale);
        const double row = polarAngle(w) / thetaStep();
        const double turns = azimuth(w) / (2 * pi);
        const double column = (turns - std::floor(turns)) * static_cast<double>(azimuths_);
        const auto r = std::min(static_cast<std::size_t>(row), thetas_ - 2);
        const auto p = static_cast<std::size_t>(column) % azimuths_, q = (p + 1) % azimuths_;
        const double t = std::min(row - static_cast<double>(r), 1.0);
        const double u = column - std::floor(column);
        for (std::size_t c = 0; c < channels_; ++c) {
            const auto node = [&](std::size_t i, std::size_t j) {
                return reflectance_[(i * azimuths_ + j) * channels_ + c];
            };
            const double reflectance = (1 - t) * ((1 - u) * node(r, p) + u * node(r, q)) +
                                       t * ((1 - u) * node(r + 1, p) + u * node(r + 1, q));
            scale[c] = 1 / std::max(1.0, reflectance);
        }
    }

private:
    static constexpr double tolerance = 1e-4;
    /// A tensor tree of seven levels has as many; finer ones are interpolated.
    static constexpr std::size_t mostCells = 16384;

    /// f is 0 by definition at 90 degrees, so that the reflectance there is taken at 89.9 degrees.
    Direction directionOf(std::size_t node) const {
        const double theta = thetaStep() * static_cast<double>(node / azimuths_);
        const double phi =
            2 * pi * static_cast<double>(node % azimuths_) / static_cast<double>(azimuths_);
        return directionFromAngles(std::min(theta, radians(89.9)), phi);
    }
    void ofCell(std::size_t cell, double* scale) const {
        const bool known = (cell + 1) * channels_ <= reflectance_.size() && cell + 1 > 0;
        for (std::size_t c = 0; c < channels_; ++c)
            scale[c] = known ? 1 / std::max(1.0, reflectance_[cell * channels_ + c]) : 1;
    }
    double thetaStep() const { return pi / 2 / static_cast<double>(thetas_ - 1); }

    const HasSteps* steps_ = nullptr;  ///< of a table whose cells are known
    std::size_t channels_ = 0, thetas_ = 0, azimuths_ = 0;
    std::vector<double> reflectance_;
};

/// Evaluates single pairs, or several of the same wo, with the channels of a pair side by side.
class Repaired : public RepairedBrdf, public HasKinkCurves, public HasSteps {
public:
    Repaired(std::unique_ptr<Brdf> brdf, Chosen chosen,
             const std::function<void(std::size_t, std::size_t)>& progress)
        : brdf_(std::move(brdf)), chosen_(chosen), laws_(brdf_->laws()) {
        laws_.nonNegative |= chosen[negative];
        laws_.reciprocal |= chosen[reciprocity];
        if (chosen[holes]) filler_.emplace(*brdf_, progress);
        if (!chosen[energy]) return;
        chosen_[energy] = false;  // the table holds reflectances after the other repairs
        scale_ = EnergyScale(*this, dynamic_cast<const HasSteps*>(brdf_.get()), progress);
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
    std::vector<double> kinks(const Direction& wo) const override {
        return both(brdf_->kinks(wo), outgoingKinksOf(*brdf_, wo));
    }
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return both(kinkCurvesOf(*brdf_, wo), outgoingKinkCurvesOf(*brdf_, wo));
    }
    std::vector<double> outgoingKinks(const Direction& wi) const override {
        return both(outgoingKinksOf(*brdf_, wi), brdf_->kinks(wi));
    }
    std::vector<KinkCurve> outgoingKinkCurves(const Direction& wi) const override {
        return both(outgoingKinkCurvesOf(*brdf_, wi), kinkCurvesOf(*brdf_, wi));
    }
    int squareLevels() const override { return squareLevelsOf(*brdf_); }
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

    /// The kinks of f(wi, wo), and if f is averaged with f(wo, wi), of that, unless they are equal.
    template <class Kink>
    std::vector<Kink> both(std::vector<Kink> own, const std::vector<Kink>& exchanged) const {
        const bool other = chosen_[reciprocity] && dynamic_cast<const HasSteps*>(brdf_.get());
        if (other) own.insert(own.end(), exchanged.begin(), exchanged.end());
        return own;
    }
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

/// f, or f of the nearest covered pair with the same half vector and a smaller theta_d.
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
        {"energy", "scale f down where more light is reflected than arrives", energyReason},
    }};
    return table;
}

std::unique_ptr<RepairedBrdf> repaired(
    std::unique_ptr<Brdf> brdf, std::string_view names,
    const std::function<void(std::size_t, std::size_t)>& progress) {
    Chosen chosen = parseNames(names);
    if (transmits(*brdf) && chosen[reciprocity]) {
        if (names != "all")
            throw UsageError(fmt::format(
                "{}: is a transmission, whose directions are not exchanged; expected repairs other "
                "than reciprocity",
                brdf->name()));
        chosen[reciprocity] = false;
    }
    return std::make_unique<Repaired>(std::move(brdf), chosen, progress);
}

}  // namespace hshfit::brdfs
