#include "map_processes.h"

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

}  // namespace hshfit::jobs
