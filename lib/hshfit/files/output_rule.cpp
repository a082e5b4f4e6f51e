#include <hshfit/files/output_rule.h>

#include <atomic>
#include <mutex>
#include <utility>

namespace hshfit::inline files {
namespace {

OutputRule& rule() {
    static OutputRule inUse;
    return inUse;
}

std::atomic<int> exitCode = 0;

struct KeptFiles {
    std::mutex mutex;
    std::vector<std::string> paths;
};

KeptFiles& keptFiles() {
    static KeptFiles files;
    return files;
}

thread_local const std::string* innermost = nullptr;

}  // namespace

const OutputRule& outputRule() {
    return rule();
}

void setOutputRule(OutputRule next) {
    rule() = std::move(next);
    exitCode = 0;
}

void stateExitCode(int code) {
    exitCode = code;
}

int statedExitCode() {
    return exitCode;
}

std::vector<std::string> takeKeptFiles() {
    const std::lock_guard lock(keptFiles().mutex);
    return std::exchange(keptFiles().paths, {});
}

void addKeptFile(std::string path) {
    const std::lock_guard lock(keptFiles().mutex);
    keptFiles().paths.push_back(std::move(path));
}

OutputKey::OutputKey(std::string key) : key_(std::move(key)), before_(innermost) {
    innermost = &key_;
}

OutputKey::~OutputKey() {
    innermost = before_;
}

std::string OutputKey::current() {
    return innermost ? *innermost : rule().key;
}

}  // namespace hshfit::inline files
