#include <hshfit/tradeoff/projection_folder.h>

#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/made_from.h>
#include <hshfit/files/mapped_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

namespace hshfit::tradeoff {
namespace {

namespace fs = std::filesystem;

constexpr const char* keptFormat = "hshfit-projection";
constexpr int keptVersion = 1, deepestKept = 4;

/// The codes that projections fail with.
constexpr std::array codes{ExitCode::done, ExitCode::usage, ExitCode::numeric};

KeptProjection read(const std::string& path) {
    const MappedFile file(path);
    const std::string text(file.bytes().begin(), file.bytes().end());
    const nlohmann::json root = parseJson(text, path, deepestKept);
    file.checkIntact();
    const JsonFields fields(root, "", path);
    requireFormat(fields, keptFormat, keptVersion);
    KeptProjection kept{.seconds = fields.number("seconds"),
                        .failure = codes.at(static_cast<std::size_t>(
                            fields.integer("failure", 0, static_cast<int>(codes.size()) - 1))),
                        .reason = fields.word("reason")};
    if (kept.failure == ExitCode::done)
        kept.representation = representationFromJson(fields.word("coefficients"), path);
    return kept;
}

}  // namespace

std::string ProjectionFolder::fileOf(const std::string& sum) const {
    constexpr std::size_t digits = 32;
    return (fs::path(path) / (sum.substr(0, digits) + ".json")).string();
}

void ProjectionFolder::make() const {
    std::error_code error;
    fs::create_directories(path, error);
    if (error || !fs::is_directory(path, error))
        throw OutputError(fmt::format("cannot make the folder '{}'", path));
}

std::optional<KeptProjection> ProjectionFolder::find(const std::string& key) const {
    const std::string sum = sha256(key), file = fileOf(sum);
    std::error_code error;
    if (!fs::exists(file, error)) return std::nullopt;
    const auto made = madeFromOf(file);
    try {
        if (made && !made->changed && made->key == sum) return read(file);
    } catch (const InputError&) {
        // A file that states its own checksum and is none of ours all the same.
    }
    if (tell) tell(fmt::format("{}: not as it was written; the projection is made anew", file));
    return std::nullopt;
}

void ProjectionFolder::keep(const std::string& key, const KeptProjection& projection) const {
    const std::string sum = sha256(key);
    const auto code = std::ranges::find(codes, projection.failure) - codes.begin();
    nlohmann::ordered_json root = {{"format", keptFormat},
                                   {"version", keptVersion},
                                   {"seconds", projection.seconds},
                                   {"failure", code},
                                   {"reason", projection.reason}};
    if (projection.failure == ExitCode::done)
        root["coefficients"] = representationToJson(projection.representation);
    const OutputKey stated(sum);
    AtomicFile file(fileOf(sum), AtomicFile::Existing::always);
    file.write(jsonText(root) + "\n");
    file.commit();
}

}  // namespace hshfit::tradeoff
