#pragma once

// How a lobe, written for any scalar, becomes a LobeFormula: `Lobe<T>(const T* values, words)` and
// `T operator()(PairGeometry, T& base)`, what the linear parameter multiplies, with what stands
// without it added to `base`. T is double, or Ceres' Jet, which differentiates.

#include <brdfs/fit/lobe_formula.h>
#include <brdfs/fit/lobe_geometry.h>

#include <ceres/jet.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

namespace hshfit::brdfs {

/// What of a row is free, and what the rest is.
struct LobePlaces {
    std::optional<std::size_t> diffuse, lobe;  ///< among the linear parameters
    double diffuseValue = 0, lobeValue = 1;    ///< where they are not among them
    std::size_t linears = 0;
    std::vector<double> values;     ///< of the row's parameters, those that are not free
    std::vector<std::size_t> free;  ///< where the free shapes stand among these
    LobeWords words;
};

/// A formula: the parameters that it takes in order, its linear one, and the choice it is for.
struct LobeRow {
    std::string_view model;
    std::vector<std::string_view> parameters;
    std::string_view linear;
    std::string_view choice;  ///< "key=word" that has to stand; empty: any
    std::unique_ptr<LobeFormula> (*make)(LobePlaces);
};

/// The tables of lobes_*.cpp.
std::span<const LobeRow> cosineLobes();
std::span<const LobeRow> facetLobes();
std::span<const LobeRow> fittedLobes();
std::span<const LobeRow> disneyLobes();

template <class Lobe, class T>
class LobeColumnsOf final : public LobeColumns {
public:
    LobeColumnsOf(const LobePlaces& places, const T* values, bool derivatives)
        : places_(places), lobe_(values, places.words), derivatives_(derivatives) {}

    void fill(const FitSamples& samples, std::size_t begin, std::size_t size, double* base,
              double* linear, double* slopes) const override {
        std::fill_n(linear, places_.linears * size, 0.0);
        if (places_.diffuse) std::fill_n(linear + *places_.diffuse * size, size, 1 / pi);
        const std::size_t columns = 1 + places_.linears;
        if (derivatives_) std::fill_n(slopes, places_.free.size() * columns * size, 0.0);
        for (std::size_t k = 0; k < size; ++k) {
            const std::size_t at = begin + k;
            T own(0.0);
            T value =
                lobe_({samples.wo[at], samples.wiX[at], samples.wiY[at], samples.wiZ[at]}, own);
            if (!places_.lobe) own += value * places_.lobeValue;
            base[k] += places_.diffuseValue / pi + valueOf(own);
            if (places_.lobe) linear[*places_.lobe * size + k] = valueOf(value);
            if constexpr (!std::is_same_v<T, double>) {
                for (std::size_t j = 0; j < places_.free.size(); ++j) {
                    const auto from = static_cast<Eigen::Index>(places_.free[j]);
                    double* to = slopes + j * columns * size + k;
                    to[0] = own.v[from];
                    if (places_.lobe) to[(1 + *places_.lobe) * size] = value.v[from];
                }
            }
        }
    }

private:
    static double valueOf(const T& x) {
        if constexpr (std::is_same_v<T, double>)
            return x;
        else
            return x.a;
    }

    const LobePlaces& places_;
    Lobe lobe_;
    bool derivatives_;
};

template <template <class> class Lobe, int n>
class LobeFormulaOf final : public LobeFormula {
public:
    explicit LobeFormulaOf(LobePlaces places) : places_(std::move(places)) {}

    std::unique_ptr<LobeColumns> at(std::span<const double> shapes,
                                    bool derivatives) const override {
        using Jet = ceres::Jet<double, n>;
        std::vector<double> values = places_.values;
        for (std::size_t j = 0; j < shapes.size(); ++j) values[places_.free[j]] = shapes[j];
        if (!derivatives || shapes.empty())
            return std::make_unique<LobeColumnsOf<Lobe<double>, double>>(places_, values.data(),
                                                                         false);
        std::vector<Jet> jets;
        for (const double value : values) jets.emplace_back(value);
        for (const std::size_t i : places_.free) jets[i].v[static_cast<Eigen::Index>(i)] = 1;
        return std::make_unique<LobeColumnsOf<Lobe<Jet>, Jet>>(places_, jets.data(), true);
    }

private:
    LobePlaces places_;
};

template <template <class> class Lobe, int n>
std::unique_ptr<LobeFormula> makeLobe(LobePlaces places) {
    return std::make_unique<LobeFormulaOf<Lobe, n>>(std::move(places));
}

}  // namespace hshfit::brdfs
