#pragma once

#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/containers/test_triples.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::inline files {
class JsonFields;
}

namespace hshfit::gpu::inline containers {

/// The facts about files in a sidecar, which are needed before texels are read.
struct SidecarIndex {
    Texels coefficients;  ///< without bytes
    std::optional<Texels> basisTexels;
    std::string coefficientsSha256, basisSha256;  ///< of the bytes
    std::vector<ExportedFile> files;
    /// The content of the container that has this sidecar; none for a sidecar beside its files.
    std::optional<Role> holds;
    std::string form;  ///< empty for coefficients per outgoing direction
};

/// The sidecar's text, docs/schemas/gpu.schema.json. `files` lists the files beside it; `holds`
/// is for a sidecar within a container.
std::string sidecarText(const Payload& payload, std::span<const ExportedFile> files,
                        std::optional<Role> holds, std::span<const TestTriple> tests,
                        const ExportOptions& options);

// Parts of sidecars that every form has, as JSON text.

/// A document with one key per line, and one element per line for arrays of arrays or objects.
std::string readableSidecar(const std::string& document);
/// The values of "data" (of texels without markers), "files", "frame" and "tests".
std::string dataText(const Texels& texels, const char* layout);
std::string filesText(std::span<const ExportedFile> files);
std::string frameText();
std::string testsText(std::span<const TestTriple> tests);
/// NAME_test.json of any form; `value` says what the values are.
std::string testText(const CoefficientHead& head, std::span<const TestTriple> tests,
                     const std::string& value);

/// The version of sidecars of coefficients per outgoing direction, which have no key "form".
inline constexpr int payloadSidecarVersion = 1;

/// The version of sidecars with a form other than coefficients per outgoing direction, which has
/// the name of the form in the key "form" (gpu/forms).
inline constexpr int formSidecarVersion = 2;

/// NAME.hsh.json for NAME.coef.… and NAME.basis.…, whose import reads it; empty for other names.
std::filesystem::path sidecarBeside(const std::filesystem::path& path);

/// The first step of reading, which allocates nothing by the stated sizes. Throws InputError
/// that starts with `file` and names the field.
SidecarIndex parseSidecarIndex(std::string_view text, const std::string& file);

/// The triples of a sidecar, whatever its form.
std::vector<TestTriple> readSidecarTests(const JsonFields& root, std::size_t channels);

/// A sidecar with the texels that it is about, sizes and sums checked.
struct LoadedTexels {
    std::string text;                      ///< of the sidecar
    SidecarIndex index;                    ///< its texels have their bytes
    std::string container, file, sidecar;  ///< as in ImportedPayload
};
/// The part of readPayload that all forms share.
LoadedTexels loadTexels(const std::string& path);

/// The second step, once the index's texels have their bytes and sizes are known to be true.
/// Checks slots, channels and layers against what pack() gives; the tests go to `tests`.
Payload parseSidecar(std::string_view text, const std::string& file, SidecarIndex index,
                     std::vector<TestTriple>& tests);

/// NAME_test.json: docs/schemas/gpu_test.schema.json.
std::string testText(const Payload& payload, std::span<const TestTriple> tests);

/// Order, layout, map and so on as words, for attributes beside the sidecar.
std::vector<std::pair<std::string, std::string>> payloadFacts(const Payload& payload);

}  // namespace hshfit::gpu::inline containers
