#include "map_processes.h"

#include <string>

namespace hshfit::jobs {
namespace {

Processes* sharing = nullptr;

}  // namespace

void shareMapsWith(Processes& processes) {
    sharing = &processes;
}

Processes& processesOfMaps() {
    static Processes alone;
    return sharing ? *sharing : alone;
}

bool isOver(const TimeLimit& limit, Processes& processes) {
    std::string over = limit.isOver() ? "yes" : "";
    processes.broadcast(over);
    return !over.empty();
}

}  // namespace hshfit::jobs
