#pragma once

#include <hshfit/representation/forms/form.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace hshfit::cli {

/// The options of `project` that choose the form in which coefficients are stored.
class FormOptions {
public:
    void addTo(CLI::App& command);

    /// The requested form, without basis, order, quantity and outgoing set. No option means
    /// plain coefficients and gives none. Throws UsageError.
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
