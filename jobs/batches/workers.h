#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace hshfit::jobs {

/// Processes that answer orders, one order at a time each. A process that dies of one takes nothing
/// else along, and another stands in its place.
class Workers {
public:
    /// Forks `count` processes. The calling process must have no other threads yet. `work` turns an
    /// order into a reply and throws nothing; both are texts without line feeds. With `memory`
    /// above 0, each process gets at most that many bytes for its data (RLIMIT_DATA), past which
    /// allocations fail. Throws OutputError where processes cannot be made.
    Workers(std::size_t count, std::size_t memory,
            const std::function<std::string(const std::string&)>& work);
    /// Ends the processes, those at work too.
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    std::size_t size() const { return workers_.size(); }
    void send(std::size_t worker, const std::string& order);

    struct Reply {
        std::size_t worker = 0;
        std::string text = {};  ///< empty if the process died
        int signal = 0;         ///< of its death; 0: it ended by itself
    };
    /// Waits for the next reply to an order. Throws OutputError if no process is left to give one.
    Reply wait();

private:
    struct Worker {
        pid_t process = 0;
        int socket = -1;
        std::string received = {};  ///< up to a line feed that has not come yet
    };
    std::vector<Worker> workers_;
};

}  // namespace hshfit::jobs
