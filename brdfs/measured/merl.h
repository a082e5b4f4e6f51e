#pragma once

#include <brdfs/measured/measured_brdf.h>
#include <brdfs/measured/merl_layout.h>
#include <brdfs/measured/merl_positions.h>
#include <brdfs/measured/own_samples.h>
#include <brdfs/rows/format.h>
#include <hshfit/files/mapped_file.h>

#include <atomic>
#include <cstdint>
#include <string>

namespace hshfit::brdfs {

/// The interpolation between the nodes of a MERL table.
enum class MerlInterpolation {
    linear,   ///< trilinear in the indices (h, d, p), over the valid cells among the eight
    nearest,  ///< the node whose indices are nearest
};

/// A measured isotropic BRDF in a MERL `.binary` file (see merl_layout.h), read from the mapped
/// file: only pages whose cells are evaluated are loaded.
///
/// f is constant beyond the last node (theta_h > 88.01 deg, theta_d > 89 deg), and 0 where none
/// of the cells is valid. NaN and infinite cells are taken as invalid, and checkIntact() throws
/// InputError naming one that was read. Indices are accurate to 1e-9.
class MerlBrdf : public MeasuredBrdf, public HasCells {
public:
    /// Throws InputError if the file has other dimensions or another size than MERL files have.
    explicit MerlBrdf(const std::string& path,
                      MerlInterpolation interpolation = MerlInterpolation::linear);

    std::string name() const override;
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override;

    /// One lobe about the half vector. Its width follows from the theta_h at which f, at theta_d =
    /// theta_o
    /// and phi_d = 90 deg, is midway between its value at theta_h = 0 and its least value.
    std::vector<Lobe> lobes(const Direction& wo) const override;
    /// 3e-3: the interpolation has a kink at every node, and the measurements err by more.
    double defaultTolerance() const override { return 3e-3; }
    std::vector<Fact> facts() const override;
    void checkIntact() const override;
    void checkReadable() const override { file_.checkIntact(); }

    /// Covered pairs have a cell, among those that f is interpolated from, that is valid in all
    /// channels.
    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override;
    /// The value -1 counts as invalid, other values below zero as negative. Both are left out of f.
    Census census() const override;
    std::vector<Axis> axes() const override;
    void giveCells(CellReceiver& receiver) const override;
    bool cellsAreDefault() const override { return true; }

    const MerlLayout& layout() const { return layout_; }
    /// The stored value times merlScale: f at a node in 1/sr if it is valid.
    double stored(std::size_t channel, std::size_t cell) const;

private:
    void interpolateLinear(const MerlCorners& at, std::size_t k, double* out,
                           std::size_t stride) const;
    void lookUpNearest(const MerlIndices& at, std::size_t k, double* out, std::size_t stride) const;
    bool rests(const MerlCorners& at, std::size_t k) const;
    double averageOfValid(const MerlCorners& at, std::size_t k, const double (&across)[4],
                          std::size_t channel) const;
    /// Two cells of a row, in one vector register.
    using Pair [[gnu::vector_size(16)]] = double;
    using PairBits [[gnu::vector_size(16)]] = std::int64_t;
    Pair rawPair(std::size_t channel, const MerlCorners& at, int row, std::size_t k) const;
    double raw(std::size_t channel, std::size_t cell) const;
    void remember(std::size_t channel, std::size_t cell) const;

    MappedFile file_;
    MerlInterpolation interpolation_;
    MerlLayout layout_;
    Channels channels_ = Channels::rgb();
    Laws laws_;
    mutable std::atomic<std::int64_t> corruptCell_{-1};  ///< channel * cells + cell
};

/// The row of the table of formats.
const Format& merlFormat();

}  // namespace hshfit::brdfs
