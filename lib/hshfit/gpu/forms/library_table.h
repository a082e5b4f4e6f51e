#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/gpu/forms/library_shader.h>

#include <string>

namespace hshfit::gpu::inline forms {

/// |ln((g + offset) / (f + offset))| for g with a table in place of f without, over all materials,
/// channels and pairs. The pairs are spreadPairs(), up to 8192 about the mirror direction down to
/// the horizon, and pairs in the mirror direction itself and at normal incidence. Their cosines are
/// 1e-3 or more, which is 0.06 degrees above the horizon. The table is filtered as GPUs filter it.
struct TableError {
    double largest = 0, mean = 0;
};
TableError tableError(const SharedSums& exact, const SharedSums& tabled);

/// Sums with the smallest table whose largest error is at most `error`: 8 s, 9/2 s and 7/2 s
/// nodes for whole s, the proportions that serve lobes and the horizon alike. 2048 rows, which
/// every device takes, hold s = 11. Throws NumericError with the least error where no table is good
/// enough.
struct TabledLibrary {
    SharedSums sums;
    TableError error;
};
TabledLibrary tabledWithin(const SharedSums& exact, double error);

/// f of one material of sums with a table, as its shader gives it.
class TabledBrdf final : public Brdf {
public:
    TabledBrdf(const SharedSums& sums, std::size_t material);

    std::string name() const override { return "table"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;
    std::vector<Lobe> lobes(const Direction& wo) const override;
    /// The tolerance of the sums without a table.
    double defaultTolerance() const override { return 1e-2; }

private:
    const SharedSums& sums_;
    std::size_t material_;
    Channels channels_ = Channels::rgb();
    Laws laws_;
};

}  // namespace hshfit::gpu::inline forms
