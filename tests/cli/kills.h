#pragma once

// Runs that are killed, for the tests of what goes on after a stop.

#include "places.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::test {

/// Whole blocks in a file of unfinished work, as hshfit/files/checkpoint.h describes it: a line of
/// its name, a line of a checksum, and blocks of a head (index, size, checksum) and bytes.
inline std::size_t blocksIn(const std::filesystem::path& path) {
    constexpr std::string_view name = "hshfit-checkpoint 1\n";
    constexpr std::uint64_t checksum = 64;
    std::error_code error;
    const std::uint64_t length = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    std::string found(name.size(), ' ');
    if (error || !file.read(found.data(), static_cast<std::streamsize>(found.size())) ||
        found != name)
        return 0;
    std::size_t blocks = 0;
    for (std::uint64_t at = name.size() + checksum + 1;; ++blocks) {
        std::array<std::uint64_t, 2> head{};  // index, size
        file.seekg(static_cast<std::streamoff>(at));
        if (!file.read(reinterpret_cast<char*>(head.data()), sizeof head)) return blocks;
        at += sizeof head + checksum + head[1];
        if (at > length) return blocks;
    }
}

/// Blocks of the files of unfinished work in a folder.
inline std::size_t keptBlocks(const std::string& folder) {
    std::size_t sum = 0;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        if (entry.path().filename().string().starts_with(".hshfit-")) sum += blocksIn(entry.path());
    return sum;
}

/// Whether unfinished work or temporaries stand in a folder.
inline bool hasHidden(const std::string& folder) {
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().filename().string().starts_with('.')) return true;
    return false;
}

/// Starts the program with these words until `most` is done, at most `attempts` times, and kills it
/// a random moment after `done()` has grown. Processes that it started are waited for too. The
/// number of runs that were killed; the first that ends by itself is the last.
template <class Done>
int killedRuns(const std::vector<std::string>& words, Done done, int attempts, std::size_t most) {
    const std::string name = program();
    std::vector<char*> arguments{const_cast<char*>(name.c_str())};
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    static std::mt19937 random(7);
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);
    int kills = 0;
    for (int attempt = 0; attempt < attempts && done() < most; ++attempt) {
        const std::size_t before = done();
        const pid_t child = fork();
        if (child == 0) {
            execv(name.c_str(), arguments.data());
            _exit(127);
        }
        int status = 0;
        pid_t ended = 0;
        while (ended == 0 && done() <= before) {
            usleep(200);
            ended = waitpid(child, &status, WNOHANG);
        }
        usleep(std::uniform_int_distribution<unsigned>(0, 2000)(random));
        if (ended == 0) {
            ::kill(child, SIGKILL);
            waitpid(child, &status, 0);
        }
        while (waitpid(-1, nullptr, 0) > 0) continue;
        if (!WIFSIGNALED(status)) break;
        ++kills;
    }
    return kills;
}

}  // namespace hshfit::test
