#pragma once

#include <cstddef>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace hshfit::inline material_maps {

/// Numbers of a band on their way to another process.
using BandBytes = std::vector<std::byte>;

/// The bytes of trivially copyable values, in their order.
template <class T>
BandBytes bandBytes(const std::vector<T>& values) {
    const auto bytes = std::as_bytes(std::span(values));
    return {bytes.begin(), bytes.end()};
}
/// The values whose bytes `bandBytes` gave; bytes of an incomplete value at the end are left out.
template <class T>
std::vector<T> bandValues(std::span<const std::byte> bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    static_assert(std::is_trivially_copyable_v<T>);
    if (!values.empty())
        std::memcpy(static_cast<void*>(values.data()), bytes.data(), values.size() * sizeof(T));
    return values;
}

/// Deals the bands of a map to the processes that share the work, and brings their results to the
/// first of them.
class BandDealer {
public:
    virtual ~BandDealer() = default;
    /// The next band that nobody has yet; none: all are taken.
    virtual std::optional<std::size_t> next() = 0;
    /// Afterwards the first process has the results of all, by band, and the others none.
    virtual void collect(std::map<std::size_t, BandBytes>& results) { (void)results; }
};

/// All bands, in order.
class OneDealer final : public BandDealer {
public:
    explicit OneDealer(std::size_t bands) : bands_(bands) {}
    std::optional<std::size_t> next() override {
        return next_ < bands_ ? std::optional(next_++) : std::nullopt;
    }

private:
    std::size_t bands_, next_ = 0;
};

/// Items [first, last) of a list.
struct ItemRange {
    std::size_t first = 0, last = 0;
};

/// The processes that make one map together; this class itself is a process on its own. All
/// processes call the same functions in the same order, as they do in MPI, from the thread that
/// made the object. Each function throws the failure of another process if there is one.
class Processes {
public:
    virtual ~Processes() = default;
    virtual std::size_t count() const { return 1; }
    virtual std::size_t number() const { return 0; }  ///< from 0
    bool isFirst() const { return number() == 0; }

    /// The consecutive items of this process, of which the shares differ by one at most.
    ItemRange share(std::size_t items) const;
    /// all[items][itemBytes], of which each process has filled its share; then each has all.
    virtual void gather(std::size_t items, std::size_t itemBytes, void* all);
    /// The text of the first process, for all.
    virtual void broadcast(std::string& text) { (void)text; }
    /// Deals the numbers below `bands`. One dealer at a time.
    virtual std::unique_ptr<BandDealer> deal(std::size_t bands);
    /// Returns when all processes have come here.
    virtual void meet() {}
    /// To be called while an exception is handled: the others learn of it. Throws the exception of
    /// the process with the lowest number.
    virtual void fail() {}
};

/// gather() of a vector of as many values for each item.
template <class T>
void gatherValues(Processes& processes, std::size_t items, std::vector<T>& all) {
    if (items > 0) processes.gather(items, all.size() / items * sizeof(T), all.data());
}

}  // namespace hshfit::inline material_maps
