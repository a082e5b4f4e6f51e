#pragma once

#include <hshfit/representation/forms/form.h>
#include <hshfit/representation/representation.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The way on from a poor result: at most one of the two calls.
struct Advice {
    std::string better;  ///< was tried: its result is not poor
    std::string toTry;   ///< was not tried, since that takes many times longer than the result did
};

/// The advice about a result with this head, poor by the rule of pictures/poor.h. Coefficients of
/// up to 32 bands for the same outgoing directions (64 bands for one direction) are tried, and the
/// forms `first` before them. The halfway form takes some hundred times longer, so that it is only
/// named; if `halfway`, the poor result, is in that form, its usual functions and more of them are
/// tried, so that calls that are only named never follow one another. Scattered data with fewer
/// measured pairs than the halfway form has functions are sent to the fit of a model.
Advice adviceBeside(const CoefficientHead& head, const Representation* halfway, const Brdf& source,
                    const std::string& output, const std::vector<Form>& first = {});

/// Whether the form of this source is not poor: it is made, and judged by its pictures and energy.
bool passes(const Form& form, const Brdf& source);

/// The call that writes `form` of the source of `head` to `output`.
std::string callOf(const Form& form, const CoefficientHead& head, const std::string& output);
/// Coefficients of this order for the quantity and outgoing directions of `head`. A basis that ends
/// below the order gives way to hemispherical harmonics.
Form coefficientsOf(int order, const CoefficientHead& head);
/// The halfway form as it is by default; the fit of a model where data do not determine it.
std::string callOfHalfway(const CoefficientHead& head, const Brdf& source,
                          const std::string& output);

/// The functions of the halfway form as it is by default.
std::size_t halfwayFunctions(const Laws& laws);
/// The measured pairs of directions behind a BRDF; none of functions and tables.
std::optional<std::size_t> measuredPairs(const Brdf& source);
/// Whether the data determine a form of so many functions.
bool determine(const Brdf& source, std::size_t functions);
/// The fit of a model to the source of `head`.
std::string callOfModel(const CoefficientHead& head);

}  // namespace hshfit::jobs
