#include <hshfit/transport/radiance_cache/record_index.h>

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

#include <algorithm>
#include <utility>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

namespace geometry = boost::geometry;
using Corner = geometry::model::point<double, 3, geometry::cs::cartesian>;
using Box = geometry::model::box<Corner>;

Box cube(const Point& at, double half) {
    return {{at[0] - half, at[1] - half, at[2] - half}, {at[0] + half, at[1] + half, at[2] + half}};
}

}  // namespace

struct RecordIndex::Tree {
    geometry::index::rtree<std::pair<Box, std::uint32_t>, geometry::index::rstar<16>> boxes;
};

RecordIndex::RecordIndex() : tree_(std::make_unique<Tree>()) {}
RecordIndex::~RecordIndex() = default;
RecordIndex::RecordIndex(RecordIndex&&) noexcept = default;

void RecordIndex::add(std::uint32_t record, const Point& at, double reach) {
    tree_->boxes.insert({cube(at, reach), record});
}

void RecordIndex::near(const Point& at, double about, std::vector<std::uint32_t>& found) const {
    found.clear();
    const auto asked = geometry::index::intersects(cube(at, about));
    for (auto it = tree_->boxes.qbegin(asked); it != tree_->boxes.qend(); ++it)
        found.push_back(it->second);
    std::ranges::sort(found);
}

}  // namespace hshfit::inline transport::inline radiance_cache
