#pragma once

#include <hshfit/files/file_set.h>
#include <hshfit/gpu/payload.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::gpu::inline containers {

/// The content of a file's texels.
enum class Role { coefficients, basis };
std::string roleName(Role role);  ///< "coef", "basis", as in file names and sidecars

/// One set of texels to be written, with its metadata.
struct TexelFile {
    Role role = Role::coefficients;
    const Texels& texels;
    const std::string& name;     ///< of the export, for identifiers in source code
    const std::string& sidecar;  ///< JSON text, for containers that hold it
    /// The main facts ("order", "7") for readers that look at attributes only.
    const std::vector<std::pair<std::string, std::string>>& facts;
    bool zstd = false;  ///< compress, where the container can (KTX2)
};

/// A row of the container table: a file around texels laid out as in `Texels`.
/// docs/reference/export_files.md has the bytes of each.
struct Container {
    std::string_view name;        ///< as on the command line
    std::string_view suffix;      ///< of the file: NAME.coef + suffix; {} is the number, "f16"
    std::string_view summary;     ///< one line
    std::vector<Number> numbers;  ///< the types that it can hold; it can hold every map
    bool holdsSidecar;            ///< can be imported alone

    /// Throws UsageError for texels that the container cannot hold.
    void (*write)(const TexelFile& file, AtomicFile& out);
    /// Whether these are the bytes of a file that this container's `write` made.
    bool (*recognises)(std::string_view bytes);
    /// The sidecar that a file holds. Throws InputError.
    std::string (*sidecar)(std::string_view bytes, const std::string& file);
    /// The texels, in the layout and number of `expected`. Throws InputError for a file that
    /// differs; allocates no more than its bytes can yield.
    std::vector<std::byte> (*texels)(std::string_view bytes, Role role, const Texels& expected,
                                     const std::string& file);

    bool holds(Number number) const;
    std::string fileName(const std::string& name, Role role, Number number) const;
};

std::span<const Container> catalog();  ///< all containers
/// Throws UsageError with the known names.
const Container& findContainer(std::string_view name);

/// A file of an export, as the sidecar lists it.
struct ExportedFile {
    Role role = Role::coefficients;
    std::string container, path;  ///< beside the sidecar
    std::uint64_t bytes = 0;
    std::string sha256;
};

struct ExportOptions {
    bool zstd = false;
    std::string fitError = {};  ///< JSON object for the key "fit_error"; empty: null
    std::string proposal = {};  ///< likewise for "proposal" (gpu/proposals); empty: no key
};

/// Texels and all that is written about them: a payload of any form as containers see it.
struct TexelExport {
    std::vector<std::pair<Role, const Texels*>> sets;        ///< coefficients first
    std::vector<std::pair<std::string, std::string>> facts;  ///< TexelFile::facts
    /// The sidecar's text; `holds` is for one within a container.
    std::function<std::string(std::span<const ExportedFile>, std::optional<Role> holds)> sidecar;
    std::string tests;  ///< text of NAME_test.json
};

/// writeContainers for texels of any form.
std::vector<ExportedFile> writeTexels(const TexelExport& texels,
                                      std::span<const Container* const> containers,
                                      const std::string& name, bool zstd, FileSet& files);

/// Adds to `files` NAME.hsh.json (the sidecar), NAME_test.json (the test triples alone), and for
/// each container the coefficients and, if the payload has them, the basis textures. Nothing
/// appears before files.commit(). Returns what was added besides the two JSON files. Throws
/// UsageError for a number type that a container cannot hold (naming those that can) and for a name
/// that is no plain file name; OutputError.
std::vector<ExportedFile> writeContainers(const Payload& payload,
                                          std::span<const Container* const> containers,
                                          const std::string& name, const ExportOptions& options,
                                          FileSet& files);

/// The payload that was read, and its files.
struct ImportedPayload {
    Payload payload;
    std::string container;      ///< name in the table
    std::string file;           ///< the file that had the texels
    std::string sidecar;        ///< the file that had the sidecar; may be the same
    std::size_t tests = 0;      ///< test triples evaluated again
    double testDifference = 0;  ///< largest difference, relative to the largest value
};

/// Reads any file of an export: the sidecar (then the first file of coefficients that it lists and
/// that is there), a container that holds its sidecar, or a .bin or .dds beside NAME.hsh.json.
/// Sizes, SHA-256 sums, finiteness and the test triples are checked. Throws InputError.
ImportedPayload readPayload(const std::string& path);

/// The same from the bytes of one container that holds its sidecar; `path` is for messages.
ImportedPayload readTexelFile(std::string_view bytes, const Container& container,
                              const std::string& path);

/// Whether readPayload recognises the file. False for a file that cannot be read.
bool looksLikePayload(const std::string& path);

}  // namespace hshfit::gpu::inline containers
