#include "kept_outputs.h"

#include "inputs.h"
#include "named_files.h"

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/made_from.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/specification/parameters.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

namespace hshfit::jobs {
namespace {

namespace fs = std::filesystem;

enum class Standing { absent, unknown, kept, incomplete };

struct Stood {
    Standing standing = Standing::absent;
    int exitCode = 0;
};

std::string sumOf(const std::string& path) {
    std::error_code error;
    if (fs::file_size(path, error) == 0 || error) return "empty";
    const MappedFile file(path);
    const std::string sum = sha256(std::as_bytes(file.bytes()));
    file.checkIntact();
    return sum;
}

[[noreturn]] void refuse(const std::string& path, std::string_view why) {
    throw OutputError(fmt::format("'{}' exists and {}; nothing is written without {}", path, why,
                                  Setting{"FileSet::force"}));
}

/// The state of files that state the key.
Stood stoodAs(const MadeFrom& made, const fs::path& folder) {
    std::error_code error;
    for (std::size_t k = 0; k < made.files.size(); ++k) {
        const std::string path = (folder / made.files[k]).string();
        if (!fs::exists(path, error)) continue;
        const std::string sum = k < made.sums.size() ? made.sums[k] : "";
        const auto own = sum.empty() && canStateMadeFrom(path) ? madeFromOf(path) : std::nullopt;
        if (sum.empty() ? own && own->changed : sumOfPart(path) != sum)
            refuse(path, "was changed after it was made");
    }
    const bool whole = std::ranges::all_of(
        made.files, [&](const std::string& name) { return fs::exists(folder / name, error); });
    const bool failed = made.exitCode == static_cast<int>(ExitCode::input);
    return {whole && !failed ? Standing::kept : Standing::incomplete, made.exitCode};
}

Stood standingOf(const std::string& path, const std::string& key) {
    if (!canStateMadeFrom(path)) return {Standing::unknown};
    const auto made = madeFromOf(path);
    if (!made) refuse(path, "does not say that it was made from this input with these options");
    if (made->changed) refuse(path, "was changed after it was made");
    if (made->key != key) refuse(path, "was made from other input, options or version");
    return stoodAs(*made, fs::path(path).parent_path());
}

/// The state of a folder: its files that state a key decide.
Stood standingOfFolder(const fs::path& folder, const std::string& key) {
    std::error_code error;
    std::optional<std::string> other;
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (canStateMadeFrom(entry.path().string())) paths.push_back(entry.path());
    std::ranges::sort(paths);
    for (const fs::path& path : paths) {
        const auto made = madeFromOf(path.string());
        if (!made || made->command != outputRule().command) continue;
        if (made->changed) refuse(path.string(), "was changed after it was made");
        if (made->key == key) return stoodAs(*made, folder);
        other = path.string();
    }
    // Several exports stand in one folder, each with names of its own.
    if (other && outputRule().command != "export")
        refuse(*other, "was made from other input, options or version");
    return {Standing::unknown};
}

Stood standingAt(const std::string& output, const std::string& key) {
    std::error_code error;
    const auto status = fs::status(output, error);
    if (fs::is_directory(status)) return standingOfFolder(output, key);
    return fs::is_regular_file(status) ? standingOf(output, key) : Stood{};
}

}  // namespace

std::string contentOf(const std::string& word) {
    std::string facts = word;
    std::error_code error;
    std::vector<std::string> words{word};
    if (fs::is_directory(word, error)) {
        facts = "folder";
        words = expandInputs({word}, Members::both);
    } else if (pathIn(word).empty()) {
        words = expandInputs(words);  // a pattern
    }
    std::set<std::string> files;
    for (const std::string& each : words) addNamedFiles(each, files);
    // Names instead of paths: results do not depend on where a file lies. Long paths first, since
    // one may begin another.
    std::vector<std::string> paths(files.begin(), files.end());
    std::ranges::stable_sort(paths, std::ranges::greater{}, &std::string::size);
    std::vector<std::string> sums;
    for (const std::string& path : paths) {
        const std::string sum =
            fmt::format("{} {}", fs::path(path).filename().string(), sumOf(path));
        std::size_t at = facts.find(path);
        if (at == std::string::npos) sums.push_back(sum);
        for (; at != std::string::npos; at = facts.find(path, at + sum.size()))
            facts.replace(at, path.size(), sum);
    }
    std::ranges::sort(sums);
    return sha256(fmt::format("{}\n{}", facts, fmt::join(sums, "\n")));
}

bool namesFile(const std::string& word) {
    std::set<std::string> files;
    addNamedFiles(word, files);
    return !files.empty();
}

std::string keyOf(const std::vector<std::string>& specs) {
    const OutputRule& rule = outputRule();
    if (rule.facts.empty()) return {};
    std::string facts = rule.facts;
    for (const std::string& spec : specs) facts += fmt::format("\n{}", contentOf(spec));
    return sha256(facts);
}

FoundOutputs findOutputs(const std::vector<std::string>& outputs, const std::string& key) {
    if (outputRule().replace || key.empty()) return {};
    bool any = false, all = true, incomplete = false;
    FoundOutputs found;
    for (const std::string& output : outputs) {
        const auto [standing, exitCode] = standingAt(output, key);
        any = any || standing == Standing::kept;
        all = all && standing == Standing::kept;
        incomplete = incomplete || standing == Standing::incomplete;
        found.exitCode = std::max(found.exitCode, exitCode);
    }
    if (incomplete)
        found.found = Found::incomplete;
    else if (any && all)
        found.found = Found::valid;
    return found;
}

std::string keptLine(const std::string& output) {
    return fmt::format("kept {}: made from the same input, options and version", output);
}

std::vector<std::string> takeKept(std::vector<std::string>& specs,
                                  std::vector<std::string>& outputs) {
    std::vector<std::string> kept, leftSpecs, leftOutputs;
    for (std::size_t i = 0; i < specs.size(); ++i) {
        std::error_code error;
        const bool stands = fs::exists(outputs[i], error);
        if (stands && findOutputs({outputs[i]}, keyOf({specs[i]})).found == Found::valid) {
            kept.push_back(outputs[i]);
        } else {
            leftSpecs.push_back(specs[i]);
            leftOutputs.push_back(outputs[i]);
        }
    }
    specs = std::move(leftSpecs);
    outputs = std::move(leftOutputs);
    return kept;
}

}  // namespace hshfit::jobs
