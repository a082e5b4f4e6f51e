#include "batch.h"

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>
#include <brdfs/spec.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <filesystem>
#include <fstream>
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
    const std::string extension = path.extension().string();
    const bool known = std::ranges::any_of(brdfs::formats(), [&](const brdfs::Format& format) {
        return format.extension == extension || format.recognises(bytes, size);
    });
    return known && !looksLikeCoefficients(path.string());
}

std::vector<std::string> measuredFiles(const std::string& folder) {
    std::error_code error;
    std::vector<std::string> files;
    fs::directory_iterator entries(folder, error);
    if (error) throw InputError(fmt::format("{}: {}", folder, error.message()));
    for (const fs::directory_entry& entry : entries)
        if (entry.is_regular_file(error) && isMeasured(entry.path()))
            files.push_back(entry.path().string());
    if (files.empty())
        throw InputError(fmt::format("{}: no measured BRDF in this folder; {} shows what is read",
                                     folder, Call{.function = "formats"}));
    std::ranges::sort(files);
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

std::vector<std::string> expandInputs(const std::vector<std::string>& specs) {
    std::vector<std::string> inputs;
    for (const std::string& spec : specs) {
        if (isFolder(spec)) {
            for (std::string& file : measuredFiles(spec)) inputs.push_back(std::move(file));
        } else {
            inputs.push_back(spec);
        }
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

bool areMany(const std::vector<std::string>& specs) {
    return specs.size() > 1 || std::ranges::any_of(specs, isFolder);
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

std::vector<InputFailure> forEachInput(const std::vector<std::string>& specs,
                                       const Listener& listener, const std::string& part,
                                       const std::function<void(std::size_t, ProgressCall)>& work) {
    TotalProgress progress(specs.size(), listener.part(part));
    std::vector<std::optional<InputFailure>> failed(specs.size());
    // An exception that left a task would cancel the loops within other inputs, which would go on
    // with results that nobody has computed: it waits until all have ended.
    std::mutex mutex;
    std::exception_ptr end;
    std::atomic<bool> ended = false;
    const auto stop = [&] {
        const std::lock_guard lock(mutex);
        if (!ended.exchange(true)) end = std::current_exception();
    };
    const auto one = [&](std::size_t i) {
        if (ended) return;
        try {
            work(i, [&progress, i](std::size_t done, std::size_t total) {
                progress.update(i, done, total);
            });
        } catch (const OutputError&) {
            stop();
        } catch (const Error& error) {
            failed[i] = {specs[i], error.what(), error.code()};
        } catch (const std::bad_alloc&) {
            failed[i] = {specs[i], "not enough memory", ExitCode::numeric};
        } catch (...) {
            stop();
        }
        progress.finish(i);
    };
    // Task isolation keeps a thread that waits within one input from starting another; without
    // it all inputs would be open at once.
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, specs.size(), 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                tbb::this_task_arena::isolate([&] { one(i); });
        },
        tbb::simple_partitioner());
    if (end) std::rethrow_exception(end);
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
