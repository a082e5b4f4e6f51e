// Bad texels, sizes, orders and distributions of filtered normals.

#include <lib/normal_filtering/maps.h>

#include <hshfit/error.h>
#include <hshfit/normal_filtering/mip_filter.h>

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace {

using namespace hshfit;
using hshfit::test::ggxTable;

/// The message of the error that `work` throws.
template <class Failure, class Work>
std::string messageOf(const Work& work) {
    try {
        work();
    } catch (const Failure& error) {
        return error.what();
    }
    return "no error";
}

TEST(Refusals, NameRowAndColumnOfTexels) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto message = [&](const SurfaceTexel& bad, double ay = 0.3) {
        std::vector<SurfaceTexel> texels(12);
        texels[4 + 2] = bad;
        return messageOf<InputError>([&] {
            filterNormals(4, 3, texels, ggxTable(3, 0.3, ay),
                          {.weights = 1, .albedos = 1, .order = 3});
        });
    };
    SurfaceTexel t;
    EXPECT_EQ(message(t), "no error");
    t.normal = {0, nan, 1};
    EXPECT_EQ(message(t),
              "texel in row 1, column 2: the normal is (0, nan, 1); a finite vector other than 0 "
              "is needed");
    t.normal = {0, 0, 0};
    EXPECT_NE(message(t).find("row 1, column 2: the normal is (0, 0, 0)"), std::string::npos);
    t = {};
    t.tangent = {0, 0, 2};
    EXPECT_EQ(message(t), "no error");
    EXPECT_NE(message(t, 0.5).find("row 1, column 2: the tangent is (0, 0, 2)"), std::string::npos);
    t = {};
    t.weights[0] = -1;
    EXPECT_NE(message(t).find("row 1, column 2: weight 0 is -1"), std::string::npos);
    t = {};
    t.albedos[0] = nan;
    EXPECT_NE(message(t).find("row 1, column 2: albedo 0 is nan"), std::string::npos);
    t = {};
    t.lobe[1] = nan;
    EXPECT_NE(message(t).find("row 1, column 2: the place"), std::string::npos);
}

TEST(Refusals, OfSizesOrdersAndDistributions) {
    const auto table = ggxTable(3, 0.3, 0.3);
    const MipLayout layout{.weights = 1, .albedos = 1, .order = 3};
    const std::vector<SurfaceTexel> texels(12);
    EXPECT_THROW(filterNormals(5, 2, texels, table, layout), UsageError);  // no whole rows
    EXPECT_THROW(filterNormals(4, 2, texels, table, layout), InputError);  // too many
    EXPECT_THROW(filterNormals(4, 4, texels, table, layout), InputError);  // too few
    EXPECT_THROW(filterNormals(0, 4, {}, table, layout), UsageError);
    EXPECT_THROW(filterNormals(4, 3, texels, table, {.order = 5}), UsageError);  // beyond the table
    EXPECT_THROW(filterNormals(4, 3, texels, table, {.order = 2}), UsageError);
    EXPECT_THROW(filterNormals(4, 3, texels, table, {.weights = 7, .order = 3}), UsageError);
    const auto make = [](double value) {
        return [value](std::size_t, std::size_t) {
            return NormalDistribution{[value](const Direction&) { return value; }, 0.3, 0.3};
        };
    };
    EXPECT_THROW(LobeTable(1, 1, make(-1)), InputError);
    EXPECT_THROW(LobeTable(1, 1, make(0)), InputError);
    EXPECT_THROW(LobeTable(1, 1, make(std::nan(""))), InputError);
    EXPECT_THROW(LobeTable(0, 1, make(1)), UsageError);
    EXPECT_THROW(LobeTable(1, 1, make(1), {4}), UsageError);
    EXPECT_NO_THROW(LobeTable(1, 1, make(1)));
}

}  // namespace
