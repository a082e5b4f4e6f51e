#pragma once

#include <hshfit/files/file_set.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/forms/form_payload.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::gpu::inline forms {

/// Adds to `files` the sidecar, the test triples and the texels of a form in each container, as
/// writeContainers does. The sidecar (docs/schemas/gpu_form.schema.json) has all of the coefficient
/// file but its numbers. `open` opens what the form adds, for the values of the tests. Throws as
/// writeContainers.
std::vector<ExportedFile> writeForm(const FormPayload& payload,
                                    std::span<const Container* const> containers,
                                    const std::string& name, const ExportOptions& options,
                                    const BrdfOpener& open, FileSet& files);

/// A form that was read, and its files as in ImportedPayload.
struct ImportedForm {
    FormPayload payload;
    std::string container, file, sidecar;
    std::size_t tests = 0;
    double testDifference = 0;  ///< largest difference of a test, relative to the largest value
};

/// Whether the file is one of an export of a form. False for one that cannot be read.
bool looksLikeForm(const std::string& path);

/// The form where the file is one of an export of a form, read once; else, and where it cannot be
/// read, nothing. Throws InputError for one that is no coefficient file's.
std::optional<ImportedForm> readIfForm(const std::string& path, const BrdfOpener& open);

/// Reads any file of such an export, as readPayload does. The form equals the coefficient file that
/// was exported, bit by bit, unless the export rounded it. Throws InputError.
ImportedForm readForm(const std::string& path, const BrdfOpener& open);

}  // namespace hshfit::gpu::inline forms
