#pragma once

#include <hshfit/material_maps/processes.h>
#include <hshfit/time_limit.h>

namespace hshfit::jobs {

/// The processes that share the work of `svbrdf` and `filteredMap` from now on; by default this one
/// alone. The first has the results. `processes` has to outlive all calls.
void shareMapsWith(Processes& processes);
Processes& processesOfMaps();

/// The result of work that all processes do together; a failure of one ends all of them.
template <class Work>
auto together(const Work& work) {
    Processes& processes = processesOfMaps();
    try {
        auto result = work();
        processes.meet();
        return result;
    } catch (...) {
        processes.fail();
        throw;
    }
}

/// Whether the time is over for the first process, and so for all.
bool isOver(const TimeLimit& limit, Processes& processes);

}  // namespace hshfit::jobs
