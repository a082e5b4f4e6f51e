#pragma once

// Runs that are killed, for the tests of what goes on after a stop.

#include "places.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace hshfit::test {

/// Bytes of the files of unfinished work in a folder.
inline std::uintmax_t keptBytes(const std::string& folder) {
    std::uintmax_t sum = 0;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        if (!entry.path().filename().string().starts_with(".hshfit-")) continue;
        const auto size = entry.file_size(error);
        if (!error) sum += size;
    }
    return sum;
}

/// Starts the program with these words `attempts` times, and kills it a random moment after its
/// kept work in `folder` has grown. The number of runs that were killed; the first that ends by
/// itself is the last.
inline int killedRuns(const std::vector<std::string>& words, const std::string& folder,
                      int attempts) {
    const std::string name = program();
    std::vector<char*> arguments{const_cast<char*>(name.c_str())};
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    std::mt19937 random(7);
    int kills = 0;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        const auto before = keptBytes(folder);
        const pid_t child = fork();
        if (child == 0) {
            execv(name.c_str(), arguments.data());
            _exit(127);
        }
        int status = 0;
        pid_t ended = 0;
        while (ended == 0 && keptBytes(folder) <= before) {
            usleep(200);
            ended = waitpid(child, &status, WNOHANG);
        }
        usleep(std::uniform_int_distribution<unsigned>(0, 2000)(random));
        if (ended == 0) {
            ::kill(child, SIGKILL);
            waitpid(child, &status, 0);
        }
        if (!WIFSIGNALED(status)) break;
        ++kills;
    }
    return kills;
}

}  // namespace hshfit::test
