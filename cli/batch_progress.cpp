#include "batch_progress.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>

namespace hshfit::cli {

struct BatchProgress::State {
    using Clock = std::chrono::steady_clock;
    std::string path;
    TerminalLine terminal;
    std::FILE* file = nullptr;
    Clock::time_point shown = Clock::now();

    void line(const jobs::BatchEvent& event) {
        constexpr auto interval = std::chrono::milliseconds(200);
        if (!terminal.isShown() || Clock::now() - shown < interval) return;
        shown = Clock::now();
        const std::string failed =
            event.failed > 0 ? fmt::format("  {} failed", event.failed) : std::string();
        terminal.show(fmt::format("{}/{} items  {:.3g}/s  {:.0f} s left{}", event.finished,
                                  event.items, static_cast<double>(event.finished) / event.seconds,
                                  event.secondsLeft, failed));
    }
    void record(const jobs::BatchEvent& event) const {
        if (!file) return;
        const jobs::ItemRecord& record = event.record;
        nlohmann::ordered_json line = {{"item", record.name},
                                       {"state", event.kept        ? "kept"
                                                 : record.isDone() ? "done"
                                                                   : "failed"},
                                       {"exit_code", record.exitCode},
                                       {"seconds", record.seconds},
                                       {"peak_bytes", record.peakBytes},
                                       {"finished", event.finished},
                                       {"failed", event.failed},
                                       {"items", event.items},
                                       {"elapsed_seconds", event.seconds},
                                       {"left_seconds", event.secondsLeft}};
        if (!record.message.empty()) line["message"] = record.message;
        const std::string text = jsonText(line) + "\n";
        const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
        if (!written || std::fflush(file) != 0)
            throw OutputError(fmt::format("{}: {}", path, std::strerror(errno)));
    }
};

BatchProgress::BatchProgress(const Globals& globals, const std::string& path)
    : state_(new State{.path = path, .terminal = TerminalLine(globals)}) {
    if (path.empty()) return;
    state_->file = std::fopen(path.c_str(), "ae");
    if (!state_->file) throw OutputError(fmt::format("{}: {}", path, std::strerror(errno)));
}

BatchProgress::~BatchProgress() {
    if (state_->file) std::fclose(state_->file);
}

void BatchProgress::show(const jobs::BatchEvent& event) {
    state_->line(event);
    state_->record(event);
}

}  // namespace hshfit::cli
