#pragma once

#include <hshfit/representation/forms/form.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace hshfit::cli {

/// The options of `project` that say in which form coefficients are kept.
class FormOptions {
public:
    void addTo(CLI::App& command);

    /// The form asked for, without basis, order, quantity and outgoing set; none where no option
    /// was given: plain coefficients. Throws UsageError.
    std::optional<Form> build() const;

private:
    std::string form_, halfway_, window_, precision_, split_;
    bool reciprocal_ = false, nonNegative_ = false, energyPreserving_ = false;
    bool nonNegativeFactors_ = false;
    int rank_ = 0;
    double rankError_ = 0;
    std::size_t keep_ = 0;
};

/// Kind, bytes and steps, for JSON answers.
nlohmann::ordered_json describeForm(const Representation& representation);
/// The same in one line.
std::string formLine(const Representation& representation);

}  // namespace hshfit::cli
