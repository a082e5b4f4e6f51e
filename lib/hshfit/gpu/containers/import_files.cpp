#include <hshfit/files/checksum.h>
#include <hshfit/files/json_format.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/sidecar.h>

#include <hshfit/error.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

namespace hshfit::gpu::inline containers {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view sidecarSuffix = ".hsh.json";
/// The largest error of a test triple, relative to the largest value, because another compiler
/// may order sums of doubles differently.
constexpr double testTolerance = 1e-9;

std::string_view textOf(const MappedFile& file) {
    return {reinterpret_cast<const char*>(file.data()), file.size()};
}

const Container* recognised(std::string_view bytes) {
    for (const Container& container : containers::catalog()) {
        if (container.recognises(bytes)) return &container;
    }
    return nullptr;
}

bool isSidecar(std::string_view bytes) {
    return jsonFormat(bytes) == "hshfit-gpu";
}

void checkSum(std::span<const std::byte> bytes, const std::string& wanted,
              const std::string& file) {
    const std::string found = sha256(bytes);
    if (found == wanted) return;
    throw InputError(fmt::format("{}: SHA-256 of the texels is {}…; the sidecar says {}…", file,
                                 found.substr(0, 12), wanted.substr(0, 12)));
}

/// Checks all texels; corners with markers are finite too.
void checkFinite(const Texels& texels, const std::string& file) {
    const std::vector<double> values = decode(texels);
    const auto bad = std::find_if_not(values.begin(), values.end(),
                                      [](double value) { return std::isfinite(value); });
    if (bad == values.end()) return;
    const auto at = static_cast<std::size_t>(bad - values.begin());
    const auto width = static_cast<std::size_t>(texels.width);
    const auto height = static_cast<std::size_t>(texels.height);
    throw InputError(fmt::format("{}: is not finite at layer {}, row {}, column {}, lane {}", file,
                                 at / 4 / width / height, at / 4 / width % height, at / 4 % width,
                                 at % 4));
}

void loadInto(const Container& container, std::string_view bytes, Role role, const std::string& sum,
              const std::string& file, Texels& texels) {
    texels.bytes = container.texels(bytes, role, texels, file);
    checkSum(texels.bytes, sum, file);
    checkFinite(texels, file);
}

ImportedPayload assemble(LoadedTexels loaded) {
    ImportedPayload result;
    result.container = loaded.container;
    result.file = loaded.file;
    result.sidecar = loaded.sidecar;
    std::vector<TestTriple> tests;
    result.payload = parseSidecar(loaded.text, loaded.sidecar, std::move(loaded.index), tests);
    result.tests = tests.size();
    result.testDifference = largestDifference(result.payload, tests);
    if (!(result.testDifference <= testTolerance)) {
        throw InputError(
            fmt::format("{}: the tests differ from the coefficients by {:.2g} of the largest value",
                        result.sidecar, result.testDifference));
    }
    return result;
}

/// The first of the files of a role that lies beside the sidecar; none if there is no such file.
const ExportedFile* firstPresent(const SidecarIndex& index, Role role, const fs::path& folder) {
    for (const ExportedFile& file : index.files) {
        std::error_code error;
        if (file.role == role && fs::exists(folder / file.path, error)) return &file;
    }
    return nullptr;
}

void loadListed(const ExportedFile& listed, const fs::path& folder, const std::string& sum,
                Texels& texels) {
    const MappedFile file((folder / listed.path).string());
    if (file.size() != listed.bytes) {
        throw InputError(fmt::format("{}: has {} bytes; the sidecar says {}", file.path(),
                                     file.size(), listed.bytes));
    }
    checkSum(std::as_bytes(file.bytes()), listed.sha256, file.path());
    loadInto(findContainer(listed.container), textOf(file), listed.role, sum, file.path(), texels);
    file.checkIntact();
}

/// From a sidecar: `only` names one of its files, or is empty for the first one of coefficients.
LoadedTexels fromSidecar(const fs::path& path, const std::string& only) {
    const MappedFile sidecar(path.string());
    SidecarIndex index = parseSidecarIndex(textOf(sidecar), sidecar.path());
    const fs::path folder = path.parent_path();
    const ExportedFile* listed = firstPresent(index, Role::coefficients, folder);
    if (!only.empty()) {
        const auto found = std::find_if(index.files.begin(), index.files.end(),
                                        [&](const ExportedFile& f) { return f.path == only; });
        if (found == index.files.end()) {
            throw InputError(fmt::format("{}: is not among the files of {}", only, sidecar.path()));
        }
        if (found->role != Role::coefficients) {
            throw InputError(fmt::format(
                "{}: holds basis textures, which anyone can compute; import the coefficients",
                (folder / only).string()));
        }
        listed = &*found;
    }
    if (!listed) {
        throw InputError(
            fmt::format("{}: none of its files of coefficients lies beside it; an export to a "
                        "container, such as bin, has one",
                        sidecar.path()));
    }
    const ExportedFile chosen = *listed;
    loadListed(chosen, folder, index.coefficientsSha256, index.coefficients);
    const ExportedFile* basis = firstPresent(index, Role::basis, folder);
    if (index.basisTexels && basis) {
        const ExportedFile chosenBasis = *basis;
        loadListed(chosenBasis, folder, index.basisSha256, *index.basisTexels);
    } else {
        index.basisTexels.reset();
    }
    LoadedTexels result{.text = std::string(textOf(sidecar)),
                        .index = std::move(index),
                        .container = chosen.container,
                        .file = (folder / chosen.path).string(),
                        .sidecar = sidecar.path()};
    sidecar.checkIntact();
    return result;
}

/// From a container that holds its sidecar.
LoadedTexels fromContainer(std::string_view bytes, const Container& container,
                           const std::string& path) {
    LoadedTexels result{.text = container.sidecar(bytes, path),
                        .index = {},
                        .container = std::string(container.name),
                        .file = path,
                        .sidecar = path};
    result.index = parseSidecarIndex(result.text, path);
    if (result.index.holds != Role::coefficients) {
        throw InputError(fmt::format(
            "{}: holds basis textures, which anyone can compute; import the coefficients", path));
    }
    loadInto(container, bytes, Role::coefficients, result.index.coefficientsSha256, path,
             result.index.coefficients);
    result.index.basisTexels.reset();
    return result;
}

}  // namespace

fs::path sidecarBeside(const fs::path& path) {
    const std::string name = path.filename().string();
    const auto at = std::min(name.find(".coef."), name.find(".basis."));
    if (at == std::string::npos) return {};
    return path.parent_path() / (name.substr(0, at) + std::string(sidecarSuffix));
}

ImportedPayload readTexelFile(std::string_view bytes, const Container& container,
                              const std::string& path) {
    return assemble(fromContainer(bytes, container, path));
}

LoadedTexels loadTexels(const std::string& path) {
    const MappedFile file(path);
    const std::string_view bytes = textOf(file);
    if (isSidecar(bytes)) return fromSidecar(path, {});
    const Container* container = recognised(bytes);
    if (container && container->holdsSidecar) {
        LoadedTexels result = fromContainer(bytes, *container, path);
        file.checkIntact();
        return result;
    }
    const fs::path sidecar = sidecarBeside(path);
    std::error_code error;
    if (!sidecar.empty() && fs::exists(sidecar, error)) {
        return fromSidecar(sidecar, fs::path(path).filename().string());
    }
    if (container) {
        throw InputError(
            fmt::format("{}: a .{} needs its sidecar beside it, NAME.hsh.json for NAME.coef.{}",
                        path, container->name, container->name));
    }
    const std::string format = jsonFormat(bytes);
    if (format.starts_with("hshfit-gpu-"))
        throw InputError(fmt::format(
            "{}: is the sidecar of an export in the format {}; exports of one material as "
            "coefficients are read back, of the format hshfit-gpu",
            path, format));
    throw InputError(fmt::format(
        "{}: is no file of an export; those are sidecars (NAME.hsh.json) and what they list",
        path));
}

ImportedPayload readPayload(const std::string& path) {
    return assemble(loadTexels(path));
}

bool looksLikePayload(const std::string& path) {
    try {
        const MappedFile file(path);
        if (isSidecar(textOf(file))) return true;
        const Container* container = recognised(textOf(file));
        if (container && container->holdsSidecar) return true;
        const fs::path sidecar = sidecarBeside(path);
        if (sidecar.empty() || !fs::exists(sidecar)) return false;
        const MappedFile beside(sidecar.string());
        return isSidecar(textOf(beside));
    } catch (const Error&) {
        return false;
    } catch (const fs::filesystem_error&) {
        return false;
    }
}

}  // namespace hshfit::gpu::inline containers
