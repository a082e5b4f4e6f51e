#include <hshfit/error.h>
#include <hshfit/files/mapped_file.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <utility>

namespace hshfit::inline files {
namespace {

// The registry that the signal handler reads. A slot is claimed by setting `begin`, becomes visible
// to the handler once `end` is set, and is released by clearing `end`, then `begin`.
struct Region {
    std::atomic<std::uintptr_t> begin{0};
    std::atomic<std::uintptr_t> end{0};
    std::atomic<bool> lost{false};
};
std::array<Region, MappedFile::maxOpen> regions;
std::uintptr_t pageSize = 0;  // set before the handler is installed
struct sigaction previousAction;

static_assert(std::atomic<std::uintptr_t>::is_always_lock_free);

// Only system calls and lock-free atomics: async-signal-safe (mmap is not on the POSIX list, but is
// a bare system call on Linux).
void replaceLostPage(int signal, siginfo_t* info, void* context) {
    const int savedErrno = errno;
    const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
    for (Region& region : regions) {
        const std::uintptr_t end = region.end.load(std::memory_order_acquire);
        if (end == 0 || address >= end || address < region.begin.load(std::memory_order_relaxed)) {
            continue;
        }
        void* page = reinterpret_cast<void*>(address & ~(pageSize - 1));
        if (mmap(page, pageSize, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) ==
            MAP_FAILED) {
            break;
        }
        region.lost.store(true, std::memory_order_release);
        errno = savedErrno;
        return;
    }
    errno = savedErrno;
    if ((previousAction.sa_flags & SA_SIGINFO) != 0) {
        previousAction.sa_sigaction(signal, info, context);
    } else if (previousAction.sa_handler != SIG_DFL && previousAction.sa_handler != SIG_IGN) {
        previousAction.sa_handler(signal);
    } else {
        // The access is repeated on return and now ends the process, as it would have without us.
        struct sigaction fallback = {};
        fallback.sa_handler = SIG_DFL;
        sigaction(SIGBUS, &fallback, nullptr);
    }
}

void installHandlerOnce() {
    static std::once_flag once;
    std::call_once(once, [] {
        pageSize = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
        struct sigaction action = {};
        action.sa_sigaction = replaceLostPage;
        action.sa_flags = SA_SIGINFO | SA_ONSTACK;
        sigemptyset(&action.sa_mask);
        sigaction(SIGBUS, nullptr, &previousAction);  // complete before the handler can run
        sigaction(SIGBUS, &action, nullptr);
    });
}

int registerRegion(std::uintptr_t begin, std::uintptr_t end) {
    for (int i = 0; i < MappedFile::maxOpen; ++i) {
        std::uintptr_t free = 0;
        if (!regions[i].begin.compare_exchange_strong(free, begin)) continue;
        regions[i].lost.store(false, std::memory_order_relaxed);
        regions[i].end.store(end, std::memory_order_release);
        return i;
    }
    return -1;
}

void releaseRegion(int slot) {
    regions[slot].end.store(0, std::memory_order_release);
    regions[slot].begin.store(0, std::memory_order_release);
}

// Opens without blocking on a FIFO, and refuses everything that cannot be mapped.
int openRegularFile(const std::string& path, struct stat& status) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0) {
        throw InputError(path + ": cannot be opened: " + std::strerror(errno));
    }
    std::string reason;
    if (fstat(descriptor, &status) != 0) {
        reason = std::string("cannot be examined: ") + std::strerror(errno);
    } else if (S_ISDIR(status.st_mode)) {
        reason = "is a directory, expected a file";
    } else if (!S_ISREG(status.st_mode)) {
        reason = "is not a regular file (a pipe or a device cannot be mapped)";
    } else if (status.st_size == 0) {
        reason = "is empty";
    }
    if (!reason.empty()) {
        close(descriptor);
        throw InputError(path + ": " + reason);
    }
    return descriptor;
}

}  // namespace

MappedFile::MappedFile(std::string path) : path_(std::move(path)) {
    installHandlerOnce();
    struct stat status = {};
    descriptor_ = openRegularFile(path_, status);
    size_ = static_cast<std::size_t>(status.st_size);
    modifiedSeconds_ = status.st_mtim.tv_sec;
    modifiedNanoseconds_ = status.st_mtim.tv_nsec;

    void* map = mmap(nullptr, size_, PROT_READ, MAP_SHARED, descriptor_, 0);
    if (map == MAP_FAILED) {
        const int error = errno;
        close(descriptor_);
        throw InputError(path_ + ": cannot be mapped: " + std::strerror(error));
    }
    data_ = static_cast<const unsigned char*>(map);
    const auto begin = reinterpret_cast<std::uintptr_t>(map);
    // The last page reaches past the end of the file and is ours as well.
    slot_ = registerRegion(begin, (begin + size_ + pageSize - 1) & ~(pageSize - 1));
    if (slot_ < 0) {
        munmap(map, size_);
        close(descriptor_);
        throw InputError(path_ + ": cannot be mapped: " + std::to_string(maxOpen) +
                         " measured files are open already");
    }
}

MappedFile::~MappedFile() {
    releaseRegion(slot_);
    munmap(const_cast<unsigned char*>(data_), size_);
    close(descriptor_);
}

void MappedFile::releasePages() const {
    // Advice: pages that stay cost memory and nothing else. Those that stand for lost ones become
    // zeros again, as they were.
    ::madvise(const_cast<unsigned char*>(data_), size_, MADV_DONTNEED);
}

void MappedFile::checkIntact() const {
    struct stat status = {};
    const bool known = fstat(descriptor_, &status) == 0;
    // A file that shrank within its last page gives zeros without any signal.
    if (regions[slot_].lost.load(std::memory_order_acquire) || !known ||
        static_cast<std::uint64_t>(status.st_size) < size_) {
        throw InputError(path_ + ": the file shrank while it was being read");
    }
    if (status.st_mtim.tv_sec != modifiedSeconds_ ||
        status.st_mtim.tv_nsec != modifiedNanoseconds_) {
        throw InputError(path_ + ": the file was written to while it was being read");
    }
}

}  // namespace hshfit::inline files
