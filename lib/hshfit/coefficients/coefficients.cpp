#include <hshfit/coefficients/coefficients.h>

namespace hshfit::inline coefficients {

std::string quantityName(Quantity quantity) {
    return quantity == Quantity::brdf ? "brdf" : "brdf_cosine";
}

Coefficients truncated(const Coefficients& c, int order) {
    if (order == c.order) return c;
    Coefficients result = c;
    result.order = order;
    result.values.clear();
    for (std::size_t row = 0; row < c.values.size(); row += c.slots()) {
        const auto first = c.values.begin() + static_cast<std::ptrdiff_t>(row);
        result.values.insert(result.values.end(), first,
                             first + static_cast<std::ptrdiff_t>(result.slots()));
    }
    return result;
}

}  // namespace hshfit::inline coefficients
