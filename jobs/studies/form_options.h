#pragma once

#include <jobs/common/option_row.h>

#include <hshfit/representation/forms/form.h>

#include <cstddef>
#include <optional>
#include <string>

namespace hshfit::jobs {

/// The options of a form as they are given; none given means plain coefficients in float64.
struct FormOptions {
    std::optional<Representation::Kind> kind = {};
    std::string halfway = {};  ///< parseHalfway
    bool reciprocal = false;
    std::string split = {};
    std::optional<Window> window = {};
    bool nonNegative = false, energyPreserving = false, nonNegativeFactors = false;
    int rank = 0;          ///< 0: not factored
    double rankError = 0;  ///< 0: not factored by it
    std::size_t keep = 0;  ///< 0: all
    std::optional<Precision> precision = {};

    bool operator==(const FormOptions&) const = default;

    /// The form that they ask for; none if nothing is given. Throws UsageError for options that
    /// contradict each other.
    std::optional<Form> form() const;
};

OptionRows<FormOptions> formOptions();

}  // namespace hshfit::jobs
