#pragma once

#include <hshfit/material_maps/processes.h>

#include <cstddef>
#include <memory>
#include <string>

namespace hshfit::jobs {

/// The processes of MPI_COMM_WORLD, which work on one map. MPI is initialised by the constructor
/// and finalised by the destructor; there is one object in a program.
///
/// Bands are dealt out by a thread of the first process, which computes as well: MPI needs
/// MPI_THREAD_MULTIPLE, and works over any transport, also one in which memory of a busy process
/// cannot be reached. A failure ends all processes at their next meeting.
class MpiProcesses final : public Processes {
public:
    MpiProcesses();
    ~MpiProcesses() override;
    MpiProcesses(const MpiProcesses&) = delete;
    MpiProcesses& operator=(const MpiProcesses&) = delete;

    std::size_t count() const override { return count_; }
    std::size_t number() const override { return number_; }
    /// Processors for each process: those that it may run on, shared out among the processes of
    /// this machine where all of them may run on the same.
    int processors() const { return processors_; }

    void gather(std::size_t items, std::size_t itemBytes, void* all) override;
    void broadcast(std::string& text) override;
    std::unique_ptr<BandDealer> deal(std::size_t bands) override;
    void meet() override;
    void fail() override;
    /// The last meeting: a process that ends with a code other than 0, without the others knowing,
    /// ends them.
    void leave(int exitCode) noexcept;

private:
    class Dealer;
    struct Failure {
        int code = 0;  ///< the exit code, 0: none
        std::string text = {};
    };
    void meetWith(const Failure& mine);

    std::size_t count_ = 1, number_ = 0;
    int processors_ = 1;
    bool ended_ = false;  ///< all know of a failure
};

}  // namespace hshfit::jobs
