#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <functional>
#include <span>
#include <stdexcept>

namespace hshfit::test {

/// The side of an array that has forbidden memory right beside it.
enum class Side { front, back };

/// `count` values between two pages of memory that nobody may touch: a load or a store beyond
/// `side` ends the program, with sanitizers and without.
template <class T>
class GuardedArray {
public:
    GuardedArray(std::size_t count, Side side) : count_(count) {
        const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
        const std::size_t within = (count * sizeof(T) + page - 1) / page * page;
        bytes_ = within + 2 * page;
        memory_ = static_cast<std::byte*>(
            ::mmap(nullptr, bytes_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
        if (memory_ == MAP_FAILED) throw std::runtime_error("no memory to guard");
        if (within > 0 && ::mprotect(memory_ + page, within, PROT_READ | PROT_WRITE) != 0)
            throw std::runtime_error("no memory between the guards");
        const std::size_t offset = side == Side::front ? 0 : within - count * sizeof(T);
        data_ = reinterpret_cast<T*>(memory_ + page + offset);
    }
    /// With `value(k)` at k.
    GuardedArray(std::size_t count, Side side, const std::function<double(std::size_t)>& value)
        : GuardedArray(count, side) {
        for (std::size_t k = 0; k < count; ++k) data_[k] = static_cast<T>(value(k));
    }
    ~GuardedArray() { ::munmap(memory_, bytes_); }
    GuardedArray(const GuardedArray&) = delete;
    GuardedArray& operator=(const GuardedArray&) = delete;

    T* data() { return data_; }
    const T* data() const { return data_; }
    std::size_t size() const { return count_; }
    T& operator[](std::size_t k) { return data_[k]; }
    const T& operator[](std::size_t k) const { return data_[k]; }
    std::span<T> all() { return {data_, count_}; }

private:
    std::size_t count_, bytes_ = 0;
    std::byte* memory_ = nullptr;
    T* data_ = nullptr;
};

}  // namespace hshfit::test
