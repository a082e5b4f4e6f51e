// Shares of a batch: their sums, their order, the engines that number them.

#include <jobs/batches/shards.h>

#include <hshfit/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <random>

namespace hshfit::jobs {
namespace {

/// Lognormal costs, as item times are: a few take ten times the median.
struct Items {
    explicit Items(std::size_t count, double spread = 1) {
        std::mt19937 random(5);
        std::lognormal_distribution<double> cost(0, spread);
        for (std::size_t i = 0; i < count; ++i) {
            costs.push_back(cost(random));
            names.push_back("item" + std::to_string(i));
        }
    }
    std::vector<double> sums(std::size_t count) const {
        std::vector<double> sums(count);
        const auto shards = assignShards(costs, names, count);
        for (std::size_t i = 0; i < costs.size(); ++i) sums.at(shards[i]) += costs[i];
        return sums;
    }
    std::vector<double> costs;
    std::vector<std::string> names;
};

TEST(Shards, AreWithinGrahamsBoundOfTheBest) {
    for (const std::size_t count : {1, 2, 7, 64}) {
        const Items items(2000);
        const auto sums = items.sums(count);
        const double total = std::accumulate(items.costs.begin(), items.costs.end(), 0.0);
        const double n = static_cast<double>(count);
        const double least = std::max(total / n, *std::ranges::max_element(items.costs));
        EXPECT_LE(*std::ranges::max_element(sums), least * (4. / 3 - 1 / (3 * n)) * (1 + 1e-12));
        EXPECT_NEAR(std::accumulate(sums.begin(), sums.end(), 0.0), total, 1e-9 * total);
    }
}

TEST(Shards, DependOnNamesAndNotOnTheOrder) {
    Items items(500, 0);  // equal costs: names alone decide
    const auto before = assignShards(items.costs, items.names, 16);
    std::ranges::reverse(items.names);
    auto after = assignShards(items.costs, items.names, 16);
    std::ranges::reverse(after);
    EXPECT_EQ(before, after);
    EXPECT_NE(before, std::vector<std::uint32_t>(500, before[0]));
}

TEST(Shards, MoreThanItemsLeaveSomeEmpty) {
    const Items items(3);
    const auto sums = items.sums(8);
    EXPECT_EQ(std::ranges::count(sums, 0.0), 5);
}

/// Variables of the environment for the time of a test.
class Engine : public testing::Test {
protected:
    void TearDown() override {
        for (const char* name : names_) unsetenv(name);
    }
    void set(const char* name, const char* value) {
        setenv(name, value, 1);
        names_.push_back(name);
    }
    std::vector<const char*> names_;
};

TEST_F(Engine, SaysWhichShard) {
    EXPECT_EQ(shardOf(""), (Shard{1, 1}));
    EXPECT_EQ(shardOf("3/8"), (Shard{3, 8}));
    set("SLURM_ARRAY_TASK_ID", "7");
    set("SLURM_ARRAY_TASK_MIN", "1");
    set("SLURM_ARRAY_TASK_STEP", "3");
    set("SLURM_ARRAY_TASK_COUNT", "4");
    EXPECT_EQ(shardOf(""), (Shard{3, 4}));
    EXPECT_EQ(shardOf("2/8"), (Shard{2, 8}));
    set("OMPI_COMM_WORLD_RANK", "1");
    set("OMPI_COMM_WORLD_SIZE", "2");
    EXPECT_EQ(shardOf(""), (Shard{6, 8}));
}

TEST_F(Engine, WithoutACountHasToBeToldOne) {
    set("JOB_COMPLETION_INDEX", "5");
    EXPECT_THROW(shardOf(""), UsageError);
    EXPECT_EQ(shardOf("/64"), (Shard{6, 64}));
    EXPECT_THROW(shardOf("/4"), UsageError);
    set("JOB_COMPLETION_INDEX", "five");
    EXPECT_THROW(shardOf("/64"), UsageError);
}

TEST_F(Engine, IsNeededForASlashAlone) {
    EXPECT_THROW(shardOf("/8"), UsageError);
    EXPECT_THROW(shardOf("8"), UsageError);
}

}  // namespace
}  // namespace hshfit::jobs
