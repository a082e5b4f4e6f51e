#include <hshfit/files/checksum.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/containers/sidecar.h>

#include <hshfit/error.h>

#include <fmt/format.h>

namespace hshfit::gpu::inline containers {
namespace {

void checkName(const std::string& name) {
    const bool plain = !name.empty() && name[0] != '.' &&
                       name.find_first_of(std::string("/\\\0\n", 4)) == std::string::npos;
    if (!plain) {
        throw UsageError(fmt::format(
            "'{}' is no name for an export; it has to be the beginning of a file name", name));
    }
}

void checkNumber(const Container& container, Number number) {
    if (container.holds(number)) return;
    std::string others;
    for (const Container& other : containers::catalog()) {
        if (other.holds(number)) others += fmt::format(" {}", other.name);
    }
    throw UsageError(
        fmt::format("{} cannot hold {}; these can:{}", container.name, numberName(number), others));
}

/// The sets of texels of a payload.
std::vector<std::pair<Role, const Texels*>> texelSets(const Payload& payload) {
    std::vector<std::pair<Role, const Texels*>> sets = {
        {Role::coefficients, &payload.coefficients}};
    if (payload.basisTexels) sets.emplace_back(Role::basis, &*payload.basisTexels);
    return sets;
}

ExportedFile described(const Container& container, Role role, const std::string& path,
                       AtomicFile& file) {
    file.finish();
    const MappedFile written(file.temporaryPath());
    return {.role = role,
            .container = std::string(container.name),
            .path = path,
            .bytes = written.size(),
            .sha256 = sha256(std::as_bytes(written.bytes()))};
}

}  // namespace

std::vector<ExportedFile> writeTexels(const TexelExport& texels,
                                      std::span<const Container* const> chosen,
                                      const std::string& name, bool zstd, FileSet& files) {
    checkName(name);
    for (const Container* container : chosen) {
        for (const auto& [role, set] : texels.sets) checkNumber(*container, set->number);
    }
    std::vector<ExportedFile> written;
    for (const auto& [role, set] : texels.sets) {
        const std::string sidecar = texels.sidecar({}, role);
        for (const Container* container : chosen) {
            const std::string path = container->fileName(name, role, set->number);
            AtomicFile& file = files.add(path);
            container->write({.role = role,
                              .texels = *set,
                              .name = name,
                              .sidecar = sidecar,
                              .facts = texels.facts,
                              .zstd = zstd},
                             file);
            written.push_back(described(*container, role, path, file));
        }
    }
    files.write(name + ".hsh.json", texels.sidecar(written, std::nullopt));
    files.write(name + "_test.json", texels.tests);
    return written;
}

std::vector<ExportedFile> writeContainers(const Payload& payload,
                                          std::span<const Container* const> chosen,
                                          const std::string& name, const ExportOptions& options,
                                          FileSet& files) {
    const auto tests = testTriples(payload);
    return writeTexels({.sets = texelSets(payload),
                        .facts = payloadFacts(payload),
                        .sidecar =
                            [&](std::span<const ExportedFile> written, std::optional<Role> holds) {
                                return sidecarText(payload, written, holds, tests, options);
                            },
                        .tests = testText(payload, tests)},
                       chosen, name, options.zstd, files);
}

}  // namespace hshfit::gpu::inline containers
