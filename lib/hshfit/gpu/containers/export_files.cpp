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

std::vector<ExportedFile> writeContainers(const Payload& payload,
                                          std::span<const Container* const> chosen,
                                          const std::string& name, const ExportOptions& options,
                                          FileSet& files) {
    checkName(name);
    for (const Container* container : chosen) {
        for (const auto& [role, texels] : texelSets(payload)) {
            checkNumber(*container, texels->number);
        }
    }
    const auto tests = testTriples(payload);
    const auto facts = payloadFacts(payload);
    std::vector<ExportedFile> written;
    for (const auto& [role, texels] : texelSets(payload)) {
        const std::string sidecar = sidecarText(payload, {}, role, tests, options.fitError);
        for (const Container* container : chosen) {
            const std::string path = container->fileName(name, role, texels->number);
            AtomicFile& file = files.add(path);
            container->write({.role = role,
                              .texels = *texels,
                              .name = name,
                              .sidecar = sidecar,
                              .facts = facts,
                              .zstd = options.zstd},
                             file);
            written.push_back(described(*container, role, path, file));
        }
    }
    files.write(name + ".hsh.json", sidecarText(payload, written, {}, tests, options.fitError));
    files.write(name + "_test.json", testText(payload, tests));
    return written;
}

}  // namespace hshfit::gpu::inline containers
