#include <hshfit/precomputed_transfer/internal/closed_form.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/rendering/view.h>
#include <hshfit/rotation/band_matrix.h>
#include <hshfit/rotation/basis_change.h>
#include <hshfit/transfer/convolution.h>

namespace hshfit::inline precomputed_transfer {

ClosedForm::ClosedForm(int order, int localOrder)
    : order_(order), localOrder_(localOrder), bands_(clampedCosine(order)) {
    for (double& band : bands_) band /= pi;
    if (localOrder == 0) return;
    change_ = BasisChange(*bases::make("sh", order), *bases::make("hsh", localOrder)).dense();
}

void ClosedForm::vector(const MeshVector& normal, float* out) const {
    const auto harmonics = bases::make("sh", order_);
    std::vector<double> values(static_cast<std::size_t>(harmonics->slots()));
    harmonics->evaluate(normalised(directionOf(normal)), values.data());
    for (int l = 0; l < order_; ++l) {
        for (int m = -l; m <= l; ++m) {
            const auto i = static_cast<std::size_t>(slotOf(l, m));
            out[i] = static_cast<float>(bands_[static_cast<std::size_t>(l)] * values[i]);
        }
    }
}

void ClosedForm::matrix(const MeshVector& normal, float* out) const {
    const Frame frame = rendering::frameAt(normalised(directionOf(normal)));
    const Direction &x = frame.tangent, &y = frame.bitangent, &z = frame.normal;
    // The rotation from the world into the frame.
    const Rotation turn = Rotation::fromMatrix({x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z});
    const auto slots = static_cast<std::size_t>(order_) * static_cast<std::size_t>(order_);
    const auto rows = static_cast<std::size_t>(localOrder_) * static_cast<std::size_t>(localOrder_);
    for (int l = 0; l < order_ && rows > 0; ++l) {
        const std::vector<double> band = bandMatrix(l, turn);
        const auto width = static_cast<std::size_t>(2 * l + 1);
        const auto first = static_cast<std::size_t>(l) * static_cast<std::size_t>(l);
        for (std::size_t j = 0; j < rows; ++j) {
            for (std::size_t k = 0; k < width; ++k) {
                double sum = 0;
                for (std::size_t m = 0; m < width; ++m)
                    sum += change_[j * slots + first + m] * band[m * width + k];
                out[j * slots + first + k] = static_cast<float>(sum);
            }
        }
    }
}

}  // namespace hshfit::inline precomputed_transfer
