#include <hshfit/gpu/forms/form_table.h>

#include <hshfit/error.h>
#include <hshfit/gpu/forms/internal/form_rows.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace hshfit::embedded {
extern const std::string_view form_basis, form_halfway;
}  // namespace hshfit::embedded

namespace hshfit::gpu::inline forms {

std::span<const FormRow> formTable() {
    static const std::array rows{
        FormRow{Representation::Kind::halfway,
                "f = min(t, exp(min(a, sum_t c_t P_t)) + L exp(min(b, sum_u c_u P_u)))", "",
                halfwayStream, embedded::form_halfway, fillHalfway},
        FormRow{Representation::Kind::basis, "f = sum_t c_t P_t(wi, wo)",
                "f = q / cos(theta_i), q = f cos(theta_i) = sum_t c_t P_t(wi, wo)", basisStream,
                embedded::form_basis, fillBasis},
    };
    return rows;
}

bool hasShader(const Representation& form, bool addsConstant) {
    return (form.added.empty() || addsConstant) &&
           std::ranges::any_of(formTable(),
                               [&](const FormRow& row) { return row.kind == form.kind(); });
}

std::string_view formulaOf(const Representation& form) {
    const FormRow& row = formRow(form.kind());
    return form.head.quantity == Quantity::brdfCosine ? row.cosineFormula : row.formula;
}

const FormRow& formRow(Representation::Kind kind) {
    for (const FormRow& row : formTable()) {
        if (row.kind == kind) return row;
    }
    throw UsageError(fmt::format("the form '{}' has no shader of its own", kindName(kind)));
}

}  // namespace hshfit::gpu::inline forms
