#pragma once

#include <hshfit/transport/radiance_cache/record.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

/// The records of one kind, found by place. Not changed while it is asked.
class RecordIndex {
public:
    RecordIndex();
    ~RecordIndex();
    RecordIndex(RecordIndex&&) noexcept;

    /// A record whose reach will never grow.
    void add(std::uint32_t record, const Point& at, double reach);
    /// Numbers of the records near a point, ascending. A record stands for the cube of half width
    /// `reach` about it; it is found if that meets the cube of half width `about` about the point.
    void near(const Point& at, double about, std::vector<std::uint32_t>& found) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace hshfit::inline transport::inline radiance_cache
