#include "inputs.h"

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/files/extension.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>
#include <brdfs/composed/sum.h>
#include <brdfs/rows/spec.h>

#include <fmt/format.h>
#include <glob.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <new>
#include <optional>

namespace hshfit::jobs {

namespace fs = std::filesystem;

namespace {

bool isFolder(const std::string& spec) {
    std::error_code ignored;
    return fs::is_directory(spec, ignored);
}

bool isMeasured(const fs::path& path) {
    constexpr std::size_t headSize = 4096;
    std::array<unsigned char, headSize> head{};
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(head.data()), headSize);
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) return false;
    const std::span<const unsigned char> bytes(head.data(),
                                               static_cast<std::size_t>(file.gcount()));
    const std::string extension = extensionOf(path.string());
    const bool known = std::ranges::any_of(brdfs::formats(), [&](const brdfs::Format& format) {
        return format.extension == extension || format.recognises(bytes, size);
    });
    return known && !looksLikeCoefficients(path.string());
}

bool isMember(const fs::path& path, Members members) {
    const bool coefficients = looksLikeCoefficients(path.string());
    if (members == Members::coefficients) return coefficients;
    return (members == Members::both && coefficients) || isMeasured(path);
}

[[noreturn]] void refuseEmpty(const std::string& folder, Members members) {
    if (members == Members::coefficients)
        throw InputError(fmt::format("{}: no coefficient file in this folder", folder));
    throw InputError(fmt::format("{}: no measured BRDF{} in this folder; {} shows what is read",
                                 folder, members == Members::both ? " and no coefficient file" : "",
                                 Call{.function = "formats"}));
}

std::vector<std::string> filesIn(const std::string& folder, Members members) {
    std::error_code error;
    std::vector<std::string> files;
    fs::directory_iterator entries(folder, error);
    if (error) throw InputError(fmt::format("{}: {}", folder, error.message()));
    for (const fs::directory_entry& entry : entries)
        if (entry.is_regular_file(error) && isMember(entry.path(), members))
            files.push_back(entry.path().string());
    if (files.empty()) refuseEmpty(folder, members);
    std::ranges::sort(files);
    return files;
}

/// The files that match a pattern, sorted; none for any other specification.
std::vector<std::string> filesMatching(const std::string& spec) {
    std::vector<std::string> files;
    if (!isPattern(spec)) return files;
    glob_t found{};
    if (::glob(spec.c_str(), 0, nullptr, &found) == 0)
        files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
    ::globfree(&found);
    std::erase_if(files, isFolder);
    return files;
}

/// The path of a file specification, without its options; none if it names no file.
std::optional<fs::path> pathOf(const std::string& spec) {
    const std::string_view path = brdfs::pathIn(spec);
    return path.empty() ? std::nullopt : std::optional(fs::path(path));
}

/// Counts finished outgoing directions over all inputs. The number of an input is known once it
/// has been opened; unopened inputs count with the average of the others.
class TotalProgress {
public:
    TotalProgress(std::size_t inputs, ProgressCall show) : parts_(inputs), show_(std::move(show)) {}

    void update(std::size_t input, std::size_t done, std::size_t total) {
        if (!show_) return;
        const std::lock_guard lock(mutex_);
        Part& part = parts_[input];
        if (part.total == 0) ++known_;
        done_ += std::max(done, part.done) - part.done;
        total_ += total - part.total;
        part = {std::max(done, part.done), total};
        show_(done_, total_ * parts_.size() / known_);
    }
    /// An input that failed has nothing left to do.
    void finish(std::size_t input) {
        const std::size_t total = parts_[input].total;
        if (total > 0) update(input, total, total);
    }

private:
    struct Part {
        std::size_t done = 0, total = 0;
    };
    std::mutex mutex_;
    std::vector<Part> parts_;
    std::size_t known_ = 0, done_ = 0, total_ = 0;
    ProgressCall show_;
};

}  // namespace

std::vector<std::string> expandInputs(const std::vector<std::string>& specs, Members members) {
    std::vector<std::string> inputs;
    for (const std::string& spec : specs) {
        std::vector<std::string> files =
            isFolder(spec) ? filesIn(spec, members) : filesMatching(spec);
        if (files.empty()) files = {spec};
        std::ranges::move(files, std::back_inserter(inputs));
    }
    return inputs;
}

std::string nameOf(const std::string& spec) {
    if (const auto path = pathOf(spec)) return path->stem().string();
    std::string name = spec;
    for (char& c : name) {
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        const bool plain = letter || (c >= '0' && c <= '9') ||
                           std::string_view("._=,+-").find(c) != std::string_view::npos;
        if (!plain) c = '_';
    }
    return name;
}

bool isPattern(const std::string& spec) {
    constexpr const char* wildcards = "*?[";
    if (spec.find_first_of(wildcards) == std::string::npos || !brdfs::pathIn(spec).empty())
        return false;
    const auto isPath = [](std::string_view text) { return !brdfs::pathIn(text).empty(); };
    std::vector<brdfs::WeightedSpec> terms;
    try {
        terms = brdfs::splitSum(spec, isPath);
    } catch (const Error&) {
        return false;  // a sum with a mistake, which is named where it is opened
    }
    return std::ranges::any_of(terms, [&](const brdfs::WeightedSpec& term) {
        // "0.5*ggx", a weight without the spaces that it needs, is no pattern either.
        const std::size_t number = term.spec.find_first_not_of("0123456789.eE+- ");
        const bool weight = number != 0 && number != std::string::npos && term.spec[number] == '*';
        const std::string_view rest =
            std::string_view(term.spec).substr(weight ? number + 1 : std::size_t{0});
        return rest.find_first_of(wildcards) != std::string_view::npos && !isPath(rest);
    });
}

bool areMany(const std::vector<std::string>& specs) {
    return specs.size() > 1 || std::ranges::any_of(specs, [](const std::string& spec) {
               return isFolder(spec) || !filesMatching(spec).empty();
           });
}

std::vector<std::string> outputPaths(const std::vector<std::string>& specs,
                                     const std::string& folder, const std::string& extension) {
    std::vector<std::string> paths;
    std::map<std::string, std::string> taken;
    for (const std::string& spec : specs) {
        const std::string name = nameOf(spec) + extension;
        const auto [other, isNew] = taken.try_emplace(name, spec);
        if (!isNew) {
            throw UsageError(fmt::format(
                "'{}' and '{}' would both be written to {}; give them different folders",
                other->second, spec, (fs::path(folder) / name).string()));
        }
        paths.push_back((fs::path(folder) / name).string());
    }
    return paths;
}

void requireFolder(const std::string& folder) {
    std::error_code error;
    if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
        throw OutputError(fmt::format("{}: a file stands there; {} of several inputs is a folder",
                                      folder, Setting{"output"}));
    }
}

std::vector<InputFailure> forEachInput(const std::vector<std::string>& specs,
                                       const Listener& listener, const std::string& part,
                                       const std::function<void(std::size_t, ProgressCall)>& work) {
    TotalProgress progress(specs.size(), listener.part(part));
    std::vector<std::optional<InputFailure>> failed(specs.size());
    const auto one = [&](std::size_t i) {
        try {
            work(i, [&progress, i](std::size_t done, std::size_t total) {
                progress.update(i, done, total);
            });
        } catch (const OutputError&) {
            throw;
        } catch (const Error& error) {
            failed[i] = {specs[i], error.what(), error.code()};
        } catch (const std::bad_alloc&) {
            failed[i] = {specs[i], "not enough memory", ExitCode::numeric};
        }
        progress.finish(i);
    };
    // Task isolation keeps a thread that waits within one input from starting another; without
    // it all inputs would be open at once.
    eachInParallel(specs.size(),
                   [&](std::size_t i) { tbb::this_task_arena::isolate([&] { one(i); }); });
    std::vector<InputFailure> failures;
    for (auto& failure : failed)
        if (failure) failures.push_back(std::move(*failure));
    return failures;
}

ExitCode codeOf(const std::vector<InputFailure>& failures) {
    if (failures.empty()) return ExitCode::done;
    const bool numeric = std::ranges::all_of(
        failures, [](const InputFailure& failure) { return failure.code == ExitCode::numeric; });
    return numeric ? ExitCode::numeric : ExitCode::input;
}

}  // namespace hshfit::jobs
