#include <hshfit/coefficients/coefficients.h>

namespace hshfit::inline coefficients {

std::string quantityName(Quantity quantity) {
    return quantity == Quantity::brdf ? "brdf" : "brdf_cosine";
}

}  // namespace hshfit::inline coefficients
