#include "model_lobes.h"

#include <jobs/source/quality.h>

#include <hshfit/error.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>

namespace hshfit::jobs {
namespace {

constexpr std::size_t trials = 6;  // settings of the other parameters
constexpr std::size_t pairs = 24;  // of directions for each

/// Numbers from 0 to 1, the same on every machine.
class Draws {
public:
    double operator()() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }

private:
    std::mt19937_64 generator_{1};
};

Direction drawnDirection(Draws& draw) {
    const double z = 0.05 + 0.95 * draw(), phi = 2 * std::numbers::pi * draw();
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// f of a grey BRDF at the pairs; half of them are near the mirror direction.
std::vector<double> valuesOf(const std::string& spec, std::uint64_t seed) {
    const auto brdf = brdfs::openModel(spec);
    Draws draw;
    for (std::uint64_t k = 0; k < seed; ++k) draw();
    std::vector<double> values;
    for (std::size_t k = 0; k < pairs; ++k) {
        const Direction wo = drawnDirection(draw);
        const double near = k % 2 == 0 ? 0.05 * (draw() - 0.5) : 1;
        const Direction drawn = drawnDirection(draw);
        Direction wi = near < 1 ? Direction{-wo.x + near, -wo.y + near / 2, wo.z} : drawn;
        const double norm = std::sqrt(wi.x * wi.x + wi.y * wi.y + wi.z * wi.z);
        wi = {wi.x / norm, wi.y / norm, wi.z / norm};
        values.push_back(evaluate(*brdf, wi, wo).front());
    }
    return values;
}

bool isAffine(const std::vector<double>& low, const std::vector<double>& middle,
              const std::vector<double>& high) {
    constexpr double tolerance = 1e-9;
    for (std::size_t k = 0; k < low.size(); ++k) {
        const double scale = std::abs(low[k]) + std::abs(middle[k]) + std::abs(high[k]);
        if (std::abs(low[k] + high[k] - 2 * middle[k]) > tolerance * scale) return false;
    }
    return true;
}

}  // namespace

ModelLobes::ModelLobes(const ParameterMaps& maps, const std::string& file)
    : common_(maps.common()) {
    std::size_t first = 0;
    for (const VaryingParameter& v : maps.varying()) {
        varying_.push_back({.name = std::string(v.row->name),
                            .first = first,
                            .channels = v.channels,
                            .low = v.low,
                            .high = v.high});
        first += v.channels;
        channels_ = std::max(channels_, v.channels);
    }
    try {
        findAffine();
        for (std::size_t k = 0; k < varying_.size(); ++k) {
            Varying& v = varying_[k];
            if (v.affine) {
                affine_.push_back(k);
                const Parameter& row = *maps.varying()[k].row;
                v.low = std::max(row.min, 0.0);
                v.high = row.max >= v.low + 1 ? v.low + 1 : row.max;
                continue;
            }
            v.axis = axes_.size();
            // Over more than a decade lobes change with the logarithm.
            axes_.push_back({v.name, v.low, v.high, v.low > 0 && v.high > 10 * v.low});
            axesByChannel_ = axesByChannel_ || v.channels > 1;
        }
        if (affine_.size() > 8) throw InputError("more than 8 of its maps are factors");
        findProducts();
    } catch (const UsageError& error) {
        throw InputError(fmt::format("{}: {}", file, error.what()));
    }
    const auto brdf = brdfs::openModel(
        specification(mapped(std::vector<double>(varying_.size(), std::numbers::inv_pi))));
    if (brdf->channels().count() != 1 && brdf->channels().kind == Channels::Kind::spectral)
        throw InputError(fmt::format("{}: {} has wavelengths", file, common_));
    laws_ = brdf->laws();
}

std::string ModelLobes::specification(const std::vector<double>& values) const {
    std::string spec = common_;
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        spec += fmt::format("{}{}={}", spec.find(':') == std::string::npos ? ':' : ',',
                            varying_[k].name, values[k]);
    }
    return spec;
}

/// Values at shares of the ranges. Parameters must not be equal by chance.
std::vector<double> ModelLobes::mapped(const std::vector<double>& shares) const {
    std::vector<double> values(shares);
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double share = std::fmod(shares[k] + 0.07 * static_cast<double>(k), 1.0);
        values[k] = varying_[k].low + share * (varying_[k].high - varying_[k].low);
    }
    return values;
}

void ModelLobes::findAffine() {
    Draws draw;
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        Varying& v = varying_[k];
        v.affine = true;
        for (std::size_t trial = 0; trial < trials && v.affine; ++trial) {
            std::vector<double> shares(varying_.size());
            for (double& share : shares) share = draw();
            std::vector<double> values = mapped(shares);
            const auto at = [&](double value) {
                values[k] = value;
                return valuesOf(specification(values), trial);
            };
            // A map of one value is as good as any: a range about it, within the model's.
            const double low = v.low, high = v.high;
            if (!(high > low)) {
                v.affine = false;
                break;
            }
            v.affine = isAffine(at(low), at((low + high) / 2), at(high));
        }
    }
}

/// The values of a product's corner: 1 where it has the factor, else 0.
std::vector<double> ModelLobes::valuesAt(std::size_t product, std::span<const double> p) const {
    std::vector<double> values(varying_.size());
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        if (!varying_[k].affine) values[k] = p[varying_[k].axis];
    }
    for (std::size_t i = 0; i < affine_.size(); ++i) {
        const Varying& v = varying_[affine_[i]];
        values[affine_[i]] = (product >> i & 1) != 0 ? v.high : v.low;
    }
    return values;
}

void ModelLobes::findProducts() {
    const std::size_t all = std::size_t{1} << affine_.size();
    std::vector<double> largest(all, 0.0);
    double scale = 0;
    Draws draw;
    for (std::size_t trial = 0; trial < trials; ++trial) {
        std::vector<double> p;
        for (const LobeAxis& axis : axes_) p.push_back(axis.low + draw() * (axis.high - axis.low));
        std::vector<std::vector<double>> lobes(all);
        for (std::size_t product = 0; product < all; ++product)
            lobes[product] = valuesOf(specification(valuesAt(product, p)), trial);
        for (const auto& values : lobes)
            for (const double value : values) scale = std::max(scale, std::abs(value));
        for (std::size_t bit = 1; bit < all; bit *= 2)
            for (std::size_t product = 0; product < all; ++product)
                for (std::size_t k = 0; (product & bit) != 0 && k < pairs; ++k)
                    lobes[product][k] -= lobes[product ^ bit][k];
        for (std::size_t product = 0; product < all; ++product)
            for (const double value : lobes[product])
                largest[product] = std::max(largest[product], std::abs(value));
    }
    for (std::size_t product = 0; product < all; ++product)
        if (largest[product] > 1e-10 * scale) products_.push_back(product);
    if (products_.empty()) products_.push_back(0);
    std::ranges::stable_sort(products_, {}, [](std::size_t bits) { return std::popcount(bits); });
}

std::vector<std::string> ModelLobes::names() const {
    std::vector<std::string> names;
    for (const std::size_t product : products_) {
        std::vector<std::string> factors;
        for (std::size_t i = 0; i < affine_.size(); ++i)
            if ((product >> i & 1) != 0) factors.push_back(varying_[affine_[i]].name);
        names.push_back(factors.empty() ? "1" : fmt::format("{}", fmt::join(factors, " * ")));
    }
    return names;
}

LobeFunction ModelLobes::function(const TexelLayout& layout, const Basis& basis,
                                  const ProjectionOptions& options, LeastCaptured& least) const {
    LobeFunction result{.axes = axes_, .lobes = count(), .length = layout.shape()};
    for (std::size_t o = 0; o < layout.outgoing.size(); ++o)
        result.weights.insert(result.weights.end(), layout.slots.size(), layout.weights()[o]);
    result.at = [this, &layout, &basis, &least, options](std::span<const double> p) {
        std::vector<double> lobes;
        for (std::size_t k = 0; k < products_.size(); ++k) {
            const std::string spec = specification(valuesAt(products_[k], p));
            const auto brdf = brdfs::openModel(spec);
            const Basis* bases[] = {&basis};
            const Projection projection =
                hshfit::project(*brdf, bases, layout.outgoing, options).front();
            const Coefficients& c = projection.coefficients;
            if (const auto share = capturedShare(projection, *brdf)) {
                const std::lock_guard lock(least.mutex);
                if (*share < least.share || (*share == least.share && spec < least.brdf)) {
                    least.share = *share;
                    least.brdf = spec;
                }
            }
            std::vector<double> lobe;
            for (std::size_t o = 0; o < layout.outgoing.size(); ++o)
                for (const int slot : layout.slots) lobe.push_back(c.at(o, 0)[slot]);
            // Less the products that it contains.
            for (std::size_t j = 0; j < k; ++j) {
                if ((products_[j] & products_[k]) != products_[j]) continue;
                for (std::size_t i = 0; i < lobe.size(); ++i) lobe[i] -= lobes[j * lobe.size() + i];
            }
            lobes.insert(lobes.end(), lobe.begin(), lobe.end());
        }
        return lobes;
    };
    return result;
}

TexelBlock ModelLobes::block(const std::vector<float>& row, std::size_t count) const {
    TexelBlock block{.count = count};
    const auto at = [&](const Varying& v, std::size_t channel) {
        return row.data() + (v.first + (v.channels > 1 ? channel : 0)) * count;
    };
    for (const std::size_t product : products_) {
        for (std::size_t c = 0; c < channels_; ++c) {
            std::vector<float> weight(count, 1.0F);
            for (std::size_t i = 0; i < affine_.size(); ++i) {
                if ((product >> i & 1) == 0) continue;
                const Varying& v = varying_[affine_[i]];
                const float* values = at(v, c);
                const auto low = static_cast<float>(v.low);
                const auto range = static_cast<float>(v.high - v.low);
                for (std::size_t t = 0; t < count; ++t) weight[t] *= (values[t] - low) / range;
            }
            block.weights.insert(block.weights.end(), weight.begin(), weight.end());
        }
    }
    for (const Varying& v : varying_) {
        if (v.affine) continue;
        for (std::size_t c = 0; c < (axesByChannel_ ? channels_ : 1); ++c)
            block.places.insert(block.places.end(), at(v, c), at(v, c) + count);
    }
    return block;
}

std::vector<TexelBlock> ModelRows::read(std::size_t top, std::size_t bottom) {
    std::vector<TexelBlock> rows;
    for (std::size_t row = top; row < bottom; ++row)
        rows.push_back(lobes_.block(maps_.row(row), maps_.width()));
    return rows;
}

}  // namespace hshfit::jobs
