#include "mpi_processes.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <climits>
#include <cstdint>
#include <new>
#include <thread>

#include <sched.h>

namespace hshfit::jobs {
namespace {

using Number = std::uint64_t;
constexpr Number none = ~Number{0};
constexpr int askTag = 1, answerTag = 2, headTag = 3, bandTag = 4;
enum Question : int { nextBand, noMore };

[[noreturn]] void raise(int code, const std::string& text) {
    switch (static_cast<ExitCode>(code)) {
        case ExitCode::usage:
            throw UsageError(text);
        case ExitCode::input:
            throw InputError(text);
        case ExitCode::numeric:
            throw NumericError(text);
        case ExitCode::output:
            throw OutputError(text);
        case ExitCode::done:
            break;
    }
    throw std::runtime_error(text);
}

/// The processors that this process may run on.
cpu_set_t allowed() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (::sched_getaffinity(0, sizeof set, &set) != 0) CPU_SET(0, &set);
    return set;
}

/// Processors for this process: bound processes have their own, others share.
int processorsOfProcess() {
    const cpu_set_t mine = allowed();
    MPI_Comm machine = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    int processes = 1;
    MPI_Comm_size(machine, &processes);
    std::vector<cpu_set_t> all(static_cast<std::size_t>(processes));
    MPI_Allgather(&mine, sizeof mine, MPI_BYTE, all.data(), sizeof mine, MPI_BYTE, machine);
    MPI_Comm_free(&machine);
    const auto sharing =
        std::ranges::count_if(all, [&](const cpu_set_t& set) { return CPU_EQUAL(&set, &mine); });
    return std::max(1, CPU_COUNT(&mine) / static_cast<int>(sharing));
}

}  // namespace

/// The first process deals, in a thread, until every other process has been told that there is no
/// band left or has said that it takes no more.
class MpiProcesses::Dealer final : public BandDealer {
public:
    Dealer(MpiProcesses& processes, std::size_t bands) : processes_(processes), bands_(bands) {
        if (processes_.isFirst()) serving_ = std::thread([this] { serve(); });
    }
    ~Dealer() override {
        next_ = bands_;
        if (processes_.isFirst()) {
            serving_.join();
        } else if (!toldNone_) {
            const int question = noMore;
            MPI_Send(&question, 1, MPI_INT, 0, askTag, MPI_COMM_WORLD);
        }
    }
    Dealer(const Dealer&) = delete;
    Dealer& operator=(const Dealer&) = delete;

    std::optional<std::size_t> next() override {
        Number band = none;
        if (processes_.isFirst()) {
            band = take();
        } else if (!toldNone_) {
            const int question = nextBand;
            MPI_Send(&question, 1, MPI_INT, 0, askTag, MPI_COMM_WORLD);
            MPI_Recv(&band, 1, MPI_UINT64_T, 0, answerTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
            toldNone_ = band == none;
        }
        return band == none ? std::nullopt : std::optional<std::size_t>(band);
    }

    void collect(std::map<std::size_t, BandBytes>& results) override {
        processes_.meet();
        if (processes_.isFirst()) {
            for (int from = 1; from < static_cast<int>(processes_.count()); ++from)
                receive(from, results);
        } else {
            send(results);
            results.clear();
        }
    }

private:
    Number take() {
        const Number band = next_++;
        return band < bands_ ? band : none;
    }

    void serve() {
        for (std::size_t left = processes_.count() - 1; left > 0;) {
            int asked = 0;
            MPI_Status status;
            MPI_Iprobe(MPI_ANY_SOURCE, askTag, MPI_COMM_WORLD, &asked, &status);
            if (asked == 0) {  // a receive that waits would take a processor
                std::this_thread::sleep_for(std::chrono::microseconds(200));
                continue;
            }
            int question = nextBand;
            MPI_Recv(&question, 1, MPI_INT, status.MPI_SOURCE, askTag, MPI_COMM_WORLD,
                     MPI_STATUS_IGNORE);
            Number band = none;
            if (question == nextBand) {
                band = take();
                MPI_Send(&band, 1, MPI_UINT64_T, status.MPI_SOURCE, answerTag, MPI_COMM_WORLD);
            }
            if (band == none) --left;
        }
    }

    /// Bytes that one message takes, of those from `at` on.
    static int piece(const BandBytes& bytes, std::size_t at) {
        return static_cast<int>(std::min<std::size_t>(INT_MAX, bytes.size() - at));
    }

    static void send(const std::map<std::size_t, BandBytes>& results) {
        const Number bands = results.size();
        MPI_Send(&bands, 1, MPI_UINT64_T, 0, headTag, MPI_COMM_WORLD);
        for (const auto& [band, bytes] : results) {
            const Number head[] = {band, bytes.size()};
            MPI_Send(head, 2, MPI_UINT64_T, 0, headTag, MPI_COMM_WORLD);
            for (std::size_t at = 0; at < bytes.size(); at += INT_MAX)
                MPI_Send(bytes.data() + at, piece(bytes, at), MPI_BYTE, 0, bandTag, MPI_COMM_WORLD);
        }
    }

    static void receive(int from, std::map<std::size_t, BandBytes>& results) {
        Number bands = 0;
        MPI_Recv(&bands, 1, MPI_UINT64_T, from, headTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        for (; bands > 0; --bands) {
            Number head[2];
            MPI_Recv(head, 2, MPI_UINT64_T, from, headTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
            BandBytes& bytes = results[head[0]];
            bytes.resize(head[1]);
            for (std::size_t at = 0; at < bytes.size(); at += INT_MAX)
                MPI_Recv(bytes.data() + at, piece(bytes, at), MPI_BYTE, from, bandTag,
                         MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        }
    }

    MpiProcesses& processes_;
    const std::size_t bands_;
    std::atomic<Number> next_ = 0;
    bool toldNone_ = false;
    std::thread serving_;
};

MpiProcesses::MpiProcesses() {
    int provided = 0, count = 1, number = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_MULTIPLE, &provided);
    MPI_Comm_size(MPI_COMM_WORLD, &count);
    MPI_Comm_rank(MPI_COMM_WORLD, &number);
    count_ = static_cast<std::size_t>(count);
    number_ = static_cast<std::size_t>(number);
    processors_ = processorsOfProcess();
    if (provided < MPI_THREAD_MULTIPLE && count > 1) {
        ended_ = true;  // all processes come here
        MPI_Finalize();
        throw UsageError("this MPI has no MPI_THREAD_MULTIPLE, which dealing out bands takes");
    }
}

MpiProcesses::~MpiProcesses() {
    MPI_Finalize();
}

void MpiProcesses::gather(std::size_t items, std::size_t itemBytes, void* all) {
    meet();
    std::vector<int> counts, firsts;
    for (std::size_t k = 0; k < count_; ++k) {
        const std::size_t first = items * k / count_, last = items * (k + 1) / count_;
        counts.push_back(static_cast<int>(last - first));
        firsts.push_back(static_cast<int>(first));
    }
    // MPI takes counts of 32 bits, which are too few for counts of bytes.
    MPI_Datatype item = MPI_DATATYPE_NULL;
    MPI_Type_contiguous(static_cast<int>(itemBytes), MPI_BYTE, &item);
    MPI_Type_commit(&item);
    MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, all, counts.data(), firsts.data(), item,
                   MPI_COMM_WORLD);
    MPI_Type_free(&item);
}

void MpiProcesses::broadcast(std::string& text) {
    meet();
    Number bytes = text.size();
    MPI_Bcast(&bytes, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    text.resize(bytes);
    for (std::size_t at = 0; at < text.size(); at += INT_MAX) {
        MPI_Bcast(text.data() + at, static_cast<int>(std::min<std::size_t>(INT_MAX, bytes - at)),
                  MPI_CHAR, 0, MPI_COMM_WORLD);
    }
}

std::unique_ptr<BandDealer> MpiProcesses::deal(std::size_t bands) {
    meet();
    return std::make_unique<Dealer>(*this, bands);
}

void MpiProcesses::meet() {
    meetWith({});
}

void MpiProcesses::meetWith(const Failure& mine) {
    const int whole = static_cast<int>(count_);
    const int failed = mine.code != 0 ? static_cast<int>(number_) : whole;
    int first = whole;
    MPI_Allreduce(&failed, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (first == whole) return;
    ended_ = true;
    int head[] = {mine.code, static_cast<int>(mine.text.size())};
    MPI_Bcast(head, 2, MPI_INT, first, MPI_COMM_WORLD);
    std::string text = mine.text;
    text.resize(static_cast<std::size_t>(head[1]));
    MPI_Bcast(text.data(), head[1], MPI_CHAR, first, MPI_COMM_WORLD);
    raise(head[0], first == 0 ? text : fmt::format("process {} of {}: {}", first + 1, whole, text));
}

void MpiProcesses::fail() {
    if (ended_) return;
    Failure mine{.code = 1};
    try {
        throw;
    } catch (const Error& error) {
        mine = {static_cast<int>(error.code()), error.what()};
    } catch (const std::bad_alloc&) {
        mine = {static_cast<int>(ExitCode::numeric), "not enough memory for what was asked"};
    } catch (const std::exception& error) {
        mine.text = error.what();
    } catch (...) {
        mine.text = "an unknown exception";
    }
    meetWith(mine);
}

void MpiProcesses::leave(int exitCode) noexcept {
    if (ended_) return;
    try {
        meetWith({.code = exitCode, .text = fmt::format("ended with exit code {}", exitCode)});
    } catch (const std::exception&) {
        return;  // the process that failed has said why
    }
}

}  // namespace hshfit::jobs
