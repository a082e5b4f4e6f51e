#pragma once

#include <hshfit/gpu/forms/form_payload.h>

#include <span>
#include <string_view>

namespace hshfit::gpu::inline forms {

struct FormText;

/// A form that is exported as it is: a row of the table of forms.
struct FormRow {
    Representation::Kind kind;
    std::string_view formula;        ///< as sidecars say it
    std::string_view cosineFormula;  ///< the same where f cos(theta_i) was projected
    /// The order of its numbers.
    std::vector<StreamNumber> (*stream)(const Representation& form);
    std::string_view body;  ///< the template of its evaluation
    /// Fills the template in.
    void (*fill)(FormText& text);
};
std::span<const FormRow> formTable();
/// Whether the table has a row for the form, which adds no BRDF, or one whose f is the same for all
/// directions (FormPayload::constant).
bool hasShader(const Representation& form, bool addsConstant = false);
/// The formula of a form, for sidecars and shaders.
std::string_view formulaOf(const Representation& form);
/// Throws UsageError for a form that the table lacks.
const FormRow& formRow(Representation::Kind kind);

}  // namespace hshfit::gpu::inline forms
