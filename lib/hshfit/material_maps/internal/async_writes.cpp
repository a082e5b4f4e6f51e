#include <hshfit/material_maps/internal/async_writes.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>

#ifdef __linux__
#include <linux/aio_abi.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace hshfit::inline material_maps {

#ifdef __linux__

namespace {
constexpr std::size_t most = 128;  // under way at a time
}

AsyncWrites::AsyncWrites() {
    if (::syscall(SYS_io_setup, most, &context_) != 0) context_ = 0;
}

AsyncWrites::~AsyncWrites() {
    if (context_ != 0) ::syscall(SYS_io_destroy, context_);
}

std::vector<std::size_t> AsyncWrites::write(int descriptor, std::span<const FilePiece> pieces) {
    std::vector<std::size_t> written(pieces.size(), 0);
    if (context_ == 0) return written;
    std::vector<iocb> orders(pieces.size());
    std::vector<iocb*> pointers(pieces.size());
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        orders[k].aio_data = k;
        orders[k].aio_lio_opcode = IOCB_CMD_PWRITE;
        orders[k].aio_fildes = static_cast<std::uint32_t>(descriptor);
        orders[k].aio_buf = reinterpret_cast<std::uintptr_t>(pieces[k].bytes.data());
        orders[k].aio_nbytes = pieces[k].bytes.size();
        orders[k].aio_offset = static_cast<std::int64_t>(pieces[k].offset);
        pointers[k] = &orders[k];
    }
    bool refused = false;
    std::size_t begun = 0, ended = 0;
    while (ended < begun || (begun < pieces.size() && !refused)) {
        const std::size_t room = std::min(most - (begun - ended), pieces.size() - begun);
        if (room > 0 && !refused) {
            const long taken = ::syscall(SYS_io_submit, context_, room, pointers.data() + begun);
            if (taken > 0) begun += static_cast<std::size_t>(taken);
            // With nothing under way, trying again would have nothing to wait for.
            refused = taken <= 0 && (begun == ended || (errno != EAGAIN && errno != EINTR));
        }
        if (begun == ended) continue;
        io_event events[most];
        // All of them are waited for, in one sleep.
        const long done =
            ::syscall(SYS_io_getevents, context_, begun - ended, most, events, nullptr);
        for (long k = 0; k < done; ++k)
            written[events[k].data] =
                static_cast<std::size_t>(std::max<std::int64_t>(0, events[k].res));
        if (done > 0) ended += static_cast<std::size_t>(done);
    }
    return written;
}

#else

AsyncWrites::AsyncWrites() = default;
AsyncWrites::~AsyncWrites() = default;
std::vector<std::size_t> AsyncWrites::write(int, std::span<const FilePiece> pieces) {
    return std::vector<std::size_t>(pieces.size(), 0);
}

#endif

}  // namespace hshfit::inline material_maps
