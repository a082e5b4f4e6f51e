#pragma once

#include <hshfit/gpu/forms/form_table.h>

namespace hshfit::gpu::inline forms {

// The functions of the rows of the table, each form in a source file of its own.
std::vector<StreamNumber> halfwayStream(const Representation& form);
void fillHalfway(FormText& text);
std::vector<StreamNumber> basisStream(const Representation& form);
void fillBasis(FormText& text);

}  // namespace hshfit::gpu::inline forms
