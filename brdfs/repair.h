#pragma once

#include <brdfs/hole_filler.h>
#include <hshfit/accuracy/health.h>
#include <hshfit/brdf/brdf.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// One row of the table of repairs, in the order in which they are applied.
struct Repair {
    std::string_view name;
    std::string_view help;
    /// The reason why the BRDF needs the repair; "" if it does not.
    std::string (*reason)(const Brdf& brdf, const Health& health);
};

/// All repairs, in the order in which they are applied.
std::span<const Repair> repairs();

/// The effect of a repair during evaluation (a channel of a direction pair is a value).
struct RepairCount {
    std::string_view name;
    std::uint64_t changed = 0;  ///< values
    std::uint64_t left = 0;     ///< values that it could not repair
    /// For `holes`: the check against covered pairs, and the values that were filled by 10 degrees
    /// of the larger of both polar angles.
    std::optional<FillCheck> check = {};
    std::array<std::uint64_t, 9> byAngle = {};
};

/// A BRDF with repairs, each of which corrects one defect:
///
/// missing      where nothing was measured, f is as at the pair with the same half vector, phi_d
///              and the largest theta_d below (by whole degrees) that is covered; left as it is if
///              none is
/// holes        where nothing was measured, f continues f at covered pairs with the same half
///              vector smoothly from all sides (hole_filler.h); left as it is if none is near
/// negative     values below 0 become 0
/// reciprocity  (f(wi, wo) + f(wo, wi)) / 2; where only one of the two is covered, that one
/// energy       f min(s(wi), s(wo)) with s(w) = 1 / max(1, R(w)) in each channel, so that
///              reciprocity is kept; R(w) is the share of the light from w that is reflected
///              (estimateReflectance). It is tabulated every 1.5 degrees of theta (anisotropic:
///              every 4.5 and, in phi, 15 degrees) and interpolated linearly: where it bends
///              downwards, up to about 0.004 above 1 is left. Tables with cells (HasSteps) have one
///              R for each.
class RepairedBrdf : public Brdf {
public:
    virtual std::uint64_t evaluated() const = 0;  ///< values
    virtual std::vector<RepairCount> counts() const = 0;
};

/// `names`: "missing,energy" and the like, or "all". Throws UsageError for an unknown name and
/// NumericError if a reflectance that `energy` needs does not converge. `progress` is for its
/// table.
std::unique_ptr<RepairedBrdf> repaired(
    std::unique_ptr<Brdf> brdf, std::string_view names,
    const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace hshfit::brdfs
