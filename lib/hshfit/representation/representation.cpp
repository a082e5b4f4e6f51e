#include <hshfit/representation/representation.h>

#include <hshfit/error.h>
#include <hshfit/representation/named_arrays.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>

namespace hshfit::inline representation {
namespace {

/// Numbers in a specification: digits that follow no letter, "ggx:alpha=0.2/.3" has two.
std::size_t countNumbers(std::string_view spec) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < spec.size(); ++i) {
        const auto isDigit = [&](std::size_t k) {
            return k < spec.size() && std::isdigit(static_cast<unsigned char>(spec[k]));
        };
        const bool begins = isDigit(i) || (spec[i] == '.' && isDigit(i + 1));
        const bool after = i == 0 || std::string_view("=/*+, -").find(spec[i - 1]) < 7;
        const bool ofExponent =
            i > 1 && spec[i - 2] == 'e' && !isDigit(i - 1) && spec[i - 1] != '.';
        count += begins && after && !ofExponent;
    }
    return count;
}

/// The count of numbers that are stored outside of the arrays.
std::size_t looseNumbers(const Representation& representation) {
    const auto* halfway = representation.as<HalfwayArray>();
    std::size_t own = halfway ? 3 * halfway->ceilings.size() + 2 : 0;
    // A lobe of two widths and a turn.
    if (halfway && !representation.head.isotropic) own += 2;
    return countNumbers(representation.added) + own;
}

/// Slots in which any row is not 0.
std::vector<int> usedSlots(const Coefficients& c) {
    std::vector<int> slots;
    const std::size_t rows = c.values.size() / c.slots();
    for (std::size_t slot = 0; slot < c.slots(); ++slot) {
        bool used = false;
        for (std::size_t row = 0; row < rows; ++row) used |= c.values[row * c.slots() + slot] != 0;
        if (used) slots.push_back(static_cast<int>(slot));
    }
    return slots;
}

/// left [rows][rank] times right [rank][columns].
std::vector<double> product(const StoredArray& left, const StoredArray& right) {
    const std::size_t rank = left.columns(), columns = right.columns(), rows = left.rows();
    std::vector<double> out(rows * columns, 0.0);
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t r = 0; r < rank; ++r) {
            const double factor = left.values[row * rank + r];
            for (std::size_t k = 0; k < columns; ++k) {
                out[row * columns + k] += factor * right.values[r * columns + k];
            }
        }
    }
    return out;
}

}  // namespace

Representation::Kind Representation::kind() const {
    if (as<HalfwayArray>()) return Kind::halfway;
    return as<MatrixArray>() || as<MatrixFactors>() ? Kind::basis : Kind::outgoing;
}

std::size_t Representation::bytes() const {
    std::size_t sum = 4 * looseNumbers(*this);
    for (const auto& each : namedArrays(*this)) sum += storedBytes(*each.array);
    return sum;
}

std::size_t Representation::entropyBytes() const {
    std::size_t sum = 4 * looseNumbers(*this);
    for (const auto& each : namedArrays(*this)) sum += hshfit::entropyBytes(*each.array);
    return sum;
}

std::size_t Representation::numbers() const {
    std::size_t sum = looseNumbers(*this);
    for (const auto& each : namedArrays(*this)) {
        const std::vector<bool>& kept = each.array->kept;
        sum += kept.empty() ? each.array->values.size()
                            : static_cast<std::size_t>(std::ranges::count(kept, true));
    }
    return sum;
}

std::string_view kindName(Representation::Kind kind) {
    switch (kind) {
        case Representation::Kind::outgoing:
            return "outgoing";
        case Representation::Kind::basis:
            return "basis";
        case Representation::Kind::halfway:
            break;
    }
    return "halfway";
}

Representation fromCoefficients(const Coefficients& c) {
    Representation result;
    result.head = c;
    result.slots = usedSlots(c);
    StoredArray array{.shape = {c.outgoing.size(), c.channels.count(), result.slots.size()},
                      .values = {}};
    for (std::size_t row = 0; row < c.values.size() / c.slots(); ++row) {
        for (int slot : result.slots) array.values.push_back(c.values[row * c.slots() + slot]);
    }
    result.content = CoefficientArray{std::move(array)};
    return result;
}

Coefficients decoded(const Representation& representation) {
    if (representation.kind() != Representation::Kind::outgoing) {
        throw UsageError(
            fmt::format("{}: the form '{}' keeps no coefficients per outgoing "
                        "direction; project it anew",
                        representation.head.source, kindName(representation.kind())));
    }
    Coefficients result{representation.head};
    const auto* factors = representation.as<CoefficientFactors>();
    const std::vector<double> values =
        factors ? product(factors->left, factors->right)
                : std::get<CoefficientArray>(representation.content).coefficients.values;
    const std::size_t stored = representation.slots.size(), slots = result.slots();
    result.values.assign(result.outgoing.size() * result.channels.count() * slots, 0.0);
    for (std::size_t row = 0; row < values.size() / std::max<std::size_t>(stored, 1); ++row) {
        for (std::size_t k = 0; k < stored; ++k) {
            result.values[row * slots + representation.slots[k]] = values[row * stored + k];
        }
    }
    return result;
}

}  // namespace hshfit::inline representation
