#pragma once

#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/containers/test_triples.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::gpu::inline containers {

/// What a sidecar says about files: to be known before texels are read.
struct SidecarIndex {
    Texels coefficients;  ///< without bytes
    std::optional<Texels> basisTexels;
    std::string coefficientsSha256, basisSha256;  ///< of the bytes
    std::vector<ExportedFile> files;
    /// Which texels the file around this sidecar holds; none for a sidecar beside its files.
    std::optional<Role> holds;
};

/// The sidecar's text, docs/schemas/gpu.schema.json. `files` lists what lies beside it; `holds` is
/// for one within a container.
std::string sidecarText(const Payload& payload, std::span<const ExportedFile> files,
                        std::optional<Role> holds, std::span<const TestTriple> tests,
                        const std::string& fitError);

/// The first step of reading; allocates nothing by the sizes that it finds. Throws InputError that
/// starts with `file` and names the field.
SidecarIndex parseSidecarIndex(std::string_view text, const std::string& file);

/// The second step, once the index's texels have their bytes, so that sizes are real ones. Checks
/// that slots, channels and layers are as pack() makes them; the tests go to `tests`.
Payload parseSidecar(std::string_view text, const std::string& file, SidecarIndex index,
                     std::vector<TestTriple>& tests);

/// NAME_test.json: docs/schemas/gpu_test.schema.json.
std::string testText(const Payload& payload, std::span<const TestTriple> tests);

/// Order, layout, map and so on as words, for attributes beside the sidecar.
std::vector<std::pair<std::string, std::string>> payloadFacts(const Payload& payload);

}  // namespace hshfit::gpu::inline containers
