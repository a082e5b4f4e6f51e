#include <hshfit/gpu/payload.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::gpu {
namespace {

using Rows = std::vector<std::vector<double>>;

Rows identity(std::size_t size) {
    Rows rows(size, std::vector<double>(size, 0.0));
    for (std::size_t i = 0; i < size; ++i) rows[i][i] = 1;
    return rows;
}

/// RGB to Y, Co, Cg and back (Malvar & Sullivan 2003, without their rounding).
const Rows toChroma = {{0.25, 0.5, 0.25}, {0.5, 0, -0.5}, {-0.25, 0.5, -0.25}};
const Rows fromChroma = {{1, 1, -1}, {1, 0, 1}, {1, -1, -1}};

double largestValue(const Coefficients& c) {
    double largest = 0;
    for (double value : c.values) largest = std::max(largest, std::abs(value));
    return largest;
}

/// Whether the sine terms of elevations at phi = 0 vanish by the mirror symmetry. Their residue
/// has to be within the projection's own error.
bool sinesVanish(const Coefficients& c) {
    if (c.outgoing.map != OutgoingSet::Map::elevations || !c.isotropic || !c.bilateral)
        return false;
    const double allowed = std::max(1e-9, c.error) * largestValue(c);
    for (std::size_t i = 0; i < c.values.size(); ++i) {
        const int slot = static_cast<int>(i % c.slots());
        const int l = static_cast<int>(std::sqrt(static_cast<double>(slot)));
        if (slot < slotOf(l, 0) && std::abs(c.values[i]) > allowed) return false;
    }
    return true;
}

std::vector<int> storedSlots(const Coefficients& c, const Basis& basis) {
    const bool cosinesOnly = sinesVanish(c);
    std::vector<int> slots;
    for (int l = 0; l < c.order; ++l) {
        for (int m = cosinesOnly ? 0 : -l; m <= l; ++m) {
            if (basis.has(l, m)) slots.push_back(slotOf(l, m));
        }
    }
    return slots;
}

std::vector<StoredChannel> storedChannels(const Payload& payload, const PackOptions& options) {
    std::vector<StoredChannel> stored;
    std::size_t layer = 0;
    const std::vector<std::string> names = options.luminanceChroma
                                               ? std::vector<std::string>{"Y", "Co", "Cg"}
                                               : payload.head.channels.names();
    for (std::size_t c = 0; c < names.size(); ++c) {
        const bool cut = options.luminanceChroma && c > 0 && options.chromaOrder > 0;
        const int end = cut ? options.chromaOrder * options.chromaOrder
                            : payload.head.order * payload.head.order;
        const auto kept = std::lower_bound(payload.slots.begin(), payload.slots.end(), end) -
                          payload.slots.begin();
        stored.push_back({names[c], static_cast<std::size_t>(kept),
                          options.packing == Packing::rgb ? 0 : layer});
        layer += (static_cast<std::size_t>(kept) + 3) / 4;
    }
    return stored;
}

std::size_t layersOf(const Payload& payload) {
    if (payload.packing == Packing::rgb) return payload.slots.size();
    const StoredChannel& last = payload.stored.back();
    return last.firstLayer + (last.slots + 3) / 4;
}

void checkOptions(const Coefficients& c, const PackOptions& options) {
    if (options.luminanceChroma && c.channels.kind != Channels::Kind::rgb) {
        throw UsageError(fmt::format("luminance and chroma need RGB coefficients; project with {}",
                                     Call{.function = "asRgb"}));
    }
    if (options.chromaOrder != 0 && !options.luminanceChroma) {
        throw UsageError("an order of the chroma goes with luminance and chroma only");
    }
    if (options.chromaOrder < 0 || options.chromaOrder > c.order) {
        throw UsageError(fmt::format("chroma order {}; it has to be 1 to {}, the order",
                                     options.chromaOrder, c.order));
    }
    if (options.packing != Packing::rgb) return;
    if (c.channels.count() > 4) {
        throw UsageError(fmt::format("rgb packing of {} channels; up to 4 fit a texel, use coef4",
                                     c.channels.count()));
    }
    if (options.chromaOrder > 0 && options.chromaOrder < c.order) {
        throw UsageError("rgb packing keeps all channels to the same order; use coef4");
    }
}

void checkLayers(std::size_t layers) {
    if (layers <= maxLayers) return;
    throw UsageError(fmt::format(
        "{} texture layers; at most {} work everywhere: lower the order, store fewer chroma bands, "
        "or project an isotropic BRDF on elevations",
        layers, maxLayers));
}

/// Every stored value, laid out as texels.
std::vector<double> layOut(const Coefficients& c, const Payload& payload, const Rows& toStored,
                           std::size_t layers) {
    const std::size_t pixels = c.outgoing.size();
    std::vector<double> values(layers * pixels * 4, 0.0);
    for (std::size_t s = 0; s < payload.stored.size(); ++s) {
        for (std::size_t j = 0; j < payload.stored[s].slots; ++j) {
            const auto [layer, lane] = payload.place(s, j);
            const std::size_t slot = static_cast<std::size_t>(payload.slots[j]);
            for (std::size_t p = 0; p < pixels; ++p) {
                double sum = 0;
                for (std::size_t i = 0; i < c.channels.count(); ++i) {
                    sum += toStored[s][i] * c.at(p, i)[slot];
                }
                values[(layer * pixels + p) * 4 + lane] = sum;
            }
        }
    }
    return values;
}

std::array<std::size_t, 4> corners(int width, int height) {
    const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
    return {0, w - 1, (h - 1) * w, h * w - 1};
}

/// Centre of a texel of the basis map, radially clamped to the horizon.
Direction basisDirection(int i, int j, int size) {
    double x = (2.0 * i + 1 - size) / (size - 2), y = (2.0 * j + 1 - size) / (size - 2);
    const double r2 = x * x + y * y;
    if (r2 >= 1) return {x / std::sqrt(r2), y / std::sqrt(r2), 0};
    return {2 * x / (1 + r2), 2 * y / (1 + r2), (1 - r2) / (1 + r2)};
}

Texels packBasis(const Basis& basis, const std::vector<int>& slots, int size, Number number) {
    if (size < 8 || size > 4096) {
        throw UsageError(fmt::format("basis textures of {} texels; they can have 8 to 4096", size));
    }
    const std::size_t layers = (slots.size() + 3) / 4, side = static_cast<std::size_t>(size);
    std::vector<double> values(layers * side * side * 4, 0.0);
    std::vector<double> at(static_cast<std::size_t>(basis.slots()));
    for (std::size_t p = 0; p < side * side; ++p) {
        basis.evaluate(basisDirection(static_cast<int>(p % side), static_cast<int>(p / side), size),
                       at.data());
        for (std::size_t j = 0; j < slots.size(); ++j) {
            values[(j / 4 * side * side + p) * 4 + j % 4] = at[static_cast<std::size_t>(slots[j])];
        }
    }
    return encode(values, size, size, layers, number);
}

}  // namespace

std::string packingName(Packing packing) {
    return packing == Packing::rgb ? "rgb" : "coef4-planar";
}

bool Payload::marked() const {
    const OutgoingSet& set = head.outgoing;
    return set.map == OutgoingSet::Map::parabolic && set.width >= 8 && set.height >= 8 &&
           !isNormalised(coefficients.number);
}

Payload pack(const Coefficients& c, const PackOptions& options) {
    checkOptions(c, options);
    const auto basis = bases::make(c.basis, c.order, {.condonShortley = c.condonShortley});
    Payload payload;
    payload.head = c;
    payload.packing = options.packing;
    payload.slots = storedSlots(c, *basis);
    payload.stored = storedChannels(payload, options);
    payload.toChannels = options.luminanceChroma ? fromChroma : identity(c.channels.count());

    const std::size_t layers = layersOf(payload);
    checkLayers(layers);
    std::vector<double> values = layOut(
        c, payload, options.luminanceChroma ? toChroma : identity(c.channels.count()), layers);
    payload.coefficients.number = options.number;
    if (payload.marked()) {
        double mark = 1;
        for (std::size_t p : corners(c.outgoing.width, c.outgoing.height)) values[p * 4] = mark++;
    }
    payload.coefficients =
        encode(values, c.outgoing.width, c.outgoing.height, layers, options.number);
    if (options.basisSize != 0) {
        payload.basisTexels = packBasis(*basis, payload.slots, options.basisSize, options.number);
    }
    return payload;
}

Coefficients unpack(const Payload& payload) {
    Coefficients c{payload.head};
    std::vector<double> texels = decode(payload.coefficients);
    const std::size_t pixels = c.outgoing.size(),
                      width = static_cast<std::size_t>(c.outgoing.width);
    if (payload.marked()) {
        const auto [a, b, d, e] = corners(c.outgoing.width, c.outgoing.height);
        for (const auto& [corner, inside] :
             {std::pair{a, a + width + 1}, std::pair{b, b + width - 1}, std::pair{d, d - width + 1},
              std::pair{e, e - width - 1}}) {
            texels[corner * 4] = texels[inside * 4];
        }
    }
    c.values.assign(pixels * c.channels.count() * c.slots(), 0.0);
    for (std::size_t s = 0; s < payload.stored.size(); ++s) {
        for (std::size_t j = 0; j < payload.stored[s].slots; ++j) {
            const auto [layer, lane] = payload.place(s, j);
            for (std::size_t p = 0; p < pixels; ++p) {
                const double value = texels[(layer * pixels + p) * 4 + lane];
                for (std::size_t i = 0; i < c.channels.count(); ++i) {
                    c.at(p, i)[payload.slots[j]] += payload.toChannels[i][s] * value;
                }
            }
        }
    }
    return c;
}

}  // namespace hshfit::gpu
