#pragma once

#include "command.h"

#include <jobs/batches/run.h>

#include <memory>
#include <string>

namespace hshfit::cli {

/// The progress of a batch: a line on a terminal (items, rate, time left, failures), and JSON lines
/// for programs that watch.
class BatchProgress {
public:
    /// `path` gets a line for each item; empty: none. Throws OutputError.
    BatchProgress(const Globals& globals, const std::string& path);
    ~BatchProgress();
    BatchProgress(const BatchProgress&) = delete;
    BatchProgress& operator=(const BatchProgress&) = delete;

    void show(const jobs::BatchEvent& event);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace hshfit::cli
