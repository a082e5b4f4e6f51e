// hshfit-mpi: the commands that several processes of MPI share.

#include "command.h"
#include "run_words.h"
#include "wording.h"

#include <hshfit/files/atomic_file.h>

#include <jobs/maps/map_processes.h>
#include <jobs/mpi/mpi_processes.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace {

bool has(const std::vector<std::string>& words, std::string_view option) {
    return std::ranges::any_of(words, [&](const std::string& word) {
        return word == option || word.starts_with(std::string(option) + "=");
    });
}

/// Whether the words ask for work that is shared, or for none.
bool isShared(const std::vector<std::string>& words) {
    return words.empty() || words.front() == "svbrdf" || has(words, "--help") ||
           has(words, "--version");
}

int run(std::vector<std::string> words, hshfit::jobs::MpiProcesses& processes) {
    if (!processes.isFirst()) hshfit::cli::closeOutput();  // one process speaks for all
    if (processes.count() > 1 && !isShared(words)) {
        hshfit::cli::printMessage(fmt::format(
            "{} is not shared out over MPI, and would be done {} times; start it as hshfit",
            words.front(), processes.count()));
        return 2;
    }
    if (!words.empty() && words.front() == "svbrdf" && !has(words, "--threads"))
        words.push_back(fmt::format("--threads={}", processes.processors()));
    hshfit::jobs::shareMapsWith(processes);
    return hshfit::cli::runWords(words);
}

}  // namespace

int main(int argc, char** argv) {
    hshfit::cli::occupyStandardStreams();
    hshfit::removeTemporariesOnSignals();
    hshfit::cli::endUncaughtInOneLine();
    hshfit::setWording(hshfit::cli::optionWording());
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    try {
        hshfit::jobs::MpiProcesses processes;
        const int code = run(words, processes);
        processes.leave(code);
        return code;
    } catch (const std::exception& error) {
        hshfit::cli::printMessage(error.what());
        return 2;
    }
}
