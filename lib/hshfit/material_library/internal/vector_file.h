#pragma once

#include <hshfit/files/scratch_file.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/material_library/log_space.h>
#include <hshfit/material_library/material_store.h>

#include <cstddef>
#include <functional>
#include <vector>

namespace hshfit::material_library {

/// Materials of a block of vectors: sums over vectors are sums over blocks, so that their digits
/// depend on the order of the materials and on nothing else.
inline constexpr std::size_t materialsInBlock = 2560;

/// The channels of all materials as vectors d = L^T c of LogSamples, on a disk.
class VectorFile {
public:
    VectorFile(const LogSpace& space, const MaterialStore& store);

    std::size_t materials() const { return first_.size() - 1; }
    Eigen::Index terms() const { return terms_; }
    std::size_t channels(std::size_t material) const {
        return first_[material + 1] - first_[material];
    }
    /// The vectors of a material into the columns of `to` from `column` on.
    void read(std::size_t material, Eigen::MatrixXd& to, Eigen::Index column) const;

private:
    Eigen::Index terms_;
    std::vector<std::size_t> first_;  ///< vector of each material; the number of vectors
    ScratchFile file_;
};

/// Vectors as columns, and the material of each, by its number in VectorSet.
struct VectorBlock {
    Eigen::MatrixXd columns;
    std::vector<std::size_t> material;

    Eigen::Index count() const { return columns.cols(); }
};

/// Some of the materials of a file, numbered in their order.
class VectorSet {
public:
    VectorSet(const VectorFile& file, std::vector<std::size_t> materials);

    std::size_t materials() const { return materials_.size(); }
    /// The number of a material in the file.
    std::size_t material(std::size_t number) const { return materials_[number]; }
    std::size_t channels(std::size_t number) const { return file_.channels(materials_[number]); }
    Eigen::Index count() const { return count_; }  ///< of vectors
    Eigen::Index terms() const { return file_.terms(); }

    /// Calls `use` for one block after another.
    void eachBlock(const std::function<void(const VectorBlock&)>& use) const;

private:
    const VectorFile& file_;
    std::vector<std::size_t> materials_;
    Eigen::Index count_ = 0;
};

}  // namespace hshfit::material_library
