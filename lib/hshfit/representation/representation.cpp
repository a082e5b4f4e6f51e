#include <hshfit/representation/representation.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <stdexcept>

namespace hshfit::inline representation {
namespace {

const StoredArray* find(const Representation& representation, std::string_view name) {
    for (const StoredArray& array : representation.arrays) {
        if (array.name == name) return &array;
    }
    return nullptr;
}

/// Numbers in a specification: digits that follow no letter, "ggx:alpha=0.2/.3" has two.
std::size_t countNumbers(std::string_view spec) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < spec.size(); ++i) {
        const auto isDigit = [&](std::size_t k) {
            return k < spec.size() && std::isdigit(static_cast<unsigned char>(spec[k]));
        };
        const bool begins = isDigit(i) || (spec[i] == '.' && isDigit(i + 1));
        const bool after = i == 0 || std::string_view("=/*+, -").find(spec[i - 1]) < 7;
        count += begins && after && !(i > 1 && spec[i - 1] == '-' && spec[i - 2] == 'e');
    }
    return count;
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

const StoredArray& Representation::array(std::string_view name) const {
    if (const StoredArray* found = find(*this, name)) return *found;
    throw std::out_of_range(fmt::format("no array '{}'", name));
}

bool Representation::has(std::string_view name) const {
    return find(*this, name) != nullptr;
}

std::size_t Representation::bytes() const {
    std::size_t sum = 4 * countNumbers(added);
    for (const StoredArray& each : arrays) sum += storedBytes(each);
    return sum;
}

std::size_t Representation::entropyBytes() const {
    std::size_t sum = 4 * countNumbers(added);
    for (const StoredArray& each : arrays) sum += hshfit::entropyBytes(each);
    return sum;
}

std::size_t Representation::numbers() const {
    std::size_t sum = countNumbers(added);
    for (const StoredArray& each : arrays) {
        sum += each.kept.empty()
                   ? each.values.size()
                   : static_cast<std::size_t>(std::count(each.kept.begin(), each.kept.end(), true));
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
    StoredArray array{.name = "coefficients",
                      .shape = {c.outgoing.size(), c.channels.count(), result.slots.size()},
                      .values = {}};
    for (std::size_t row = 0; row < c.values.size() / c.slots(); ++row) {
        for (int slot : result.slots) array.values.push_back(c.values[row * c.slots() + slot]);
    }
    result.arrays.push_back(std::move(array));
    return result;
}

Coefficients decoded(const Representation& representation) {
    if (representation.kind != Representation::Kind::outgoing) {
        throw UsageError(
            fmt::format("{}: the form '{}' keeps no coefficients per outgoing "
                        "direction; project it anew",
                        representation.head.source, kindName(representation.kind)));
    }
    Coefficients result{representation.head};
    const bool whole = representation.has("coefficients");
    const std::vector<double> values =
        whole ? representation.array("coefficients").values
              : product(representation.array("left"), representation.array("right"));
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
