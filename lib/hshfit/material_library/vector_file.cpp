#include <hshfit/material_library/internal/vector_file.h>

#include <hshfit/material_library/internal/log_samples.h>

#include <algorithm>
#include <utility>

namespace hshfit::material_library {

VectorFile::VectorFile(const LogSpace& space, const MaterialStore& store)
    : terms_(space.samples().lower.rows()), file_(store.folder()) {
    const Eigen::MatrixXd& lower = space.samples().lower;
    first_.push_back(0);
    for (std::size_t m = 0; m < store.size(); ++m) {
        const Measured material = store.measured(m);
        for (std::size_t c = 0; c < material.channels(); ++c) {
            const Eigen::VectorXd vector =
                lower.transpose() *
                Eigen::Map<const Eigen::VectorXf>(
                    material.exponents.data() + c * static_cast<std::size_t>(terms_), terms_)
                    .cast<double>();
            file_.append(std::as_bytes(std::span(vector.data(), static_cast<std::size_t>(terms_))));
        }
        first_.push_back(first_.back() + material.channels());
    }
}

void VectorFile::read(std::size_t material, Eigen::MatrixXd& to, Eigen::Index column) const {
    const auto terms = static_cast<std::size_t>(terms_);
    file_.read(
        first_[material] * terms * sizeof(double),
        std::as_writable_bytes(std::span(to.col(column).data(), channels(material) * terms)));
}

VectorSet::VectorSet(const VectorFile& file, std::vector<std::size_t> materials)
    : file_(file), materials_(std::move(materials)) {
    for (const std::size_t material : materials_)
        count_ += static_cast<Eigen::Index>(file.channels(material));
}

void VectorSet::eachBlock(const std::function<void(const VectorBlock&)>& use) const {
    VectorBlock block;
    for (std::size_t first = 0; first < materials(); first += materialsInBlock) {
        const std::size_t last = std::min(first + materialsInBlock, materials());
        block.material.clear();
        for (std::size_t m = first; m < last; ++m)
            block.material.insert(block.material.end(), channels(m), m);
        block.columns.resize(terms(), static_cast<Eigen::Index>(block.material.size()));
        Eigen::Index column = 0;
        for (std::size_t m = first; m < last; ++m) {
            file_.read(materials_[m], block.columns, column);
            column += static_cast<Eigen::Index>(channels(m));
        }
        use(block);
    }
}

}  // namespace hshfit::material_library
