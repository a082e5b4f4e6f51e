#include "shards.h"

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <numeric>
#include <queue>

namespace hshfit::jobs {

namespace {

constexpr std::size_t mostShards = 1'000'000;

std::optional<std::size_t> wholeNumber(std::string_view text) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (text.empty() || error != std::errc() || end != text.data() + text.size()) return {};
    return number;
}

/// The number in a variable of the environment. Throws UsageError for one that holds no number.
std::optional<std::size_t> variable(const char* name) {
    const char* text = std::getenv(name);
    if (!text || !*text) return {};
    const auto number = wholeNumber(text);
    if (!number) throw UsageError(fmt::format("{}='{}' is no whole number", name, text));
    return number;
}

/// A number from 0 and a count, 0 if unknown.
struct Share {
    std::size_t number = 0, count = 0;
    const char* origin = "";
};

std::optional<Share> shareOfSlurm() {
    const auto id = variable("SLURM_ARRAY_TASK_ID");
    if (!id) return {};
    const std::size_t least = variable("SLURM_ARRAY_TASK_MIN").value_or(0);
    const std::size_t step =
        std::max<std::size_t>(1, variable("SLURM_ARRAY_TASK_STEP").value_or(1));
    return Share{(*id - std::min(*id, least)) / step,
                 variable("SLURM_ARRAY_TASK_COUNT").value_or(0), "Slurm array"};
}

std::optional<Share> shareOfKubernetes() {
    const auto index = variable("JOB_COMPLETION_INDEX");
    if (!index) return {};
    return Share{*index, 0, "Kubernetes indexed job"};
}

std::optional<Share> shareOfMpi() {
    const auto rank = variable("OMPI_COMM_WORLD_RANK");
    if (!rank) return {};
    return Share{*rank, variable("OMPI_COMM_WORLD_SIZE").value_or(0), "Open MPI"};
}

/// The share by the environment; MPI within an array multiplies.
std::optional<Share> shareOfEnvironment() {
    std::optional<Share> outer = shareOfSlurm();
    if (!outer) outer = shareOfKubernetes();
    const std::optional<Share> inner = shareOfMpi();
    if (!outer) return inner;
    if (!inner || inner->count == 0) return outer;
    return Share{outer->number * inner->count + inner->number, outer->count * inner->count,
                 outer->origin};
}

Shard checked(std::size_t index, std::size_t count, std::string_view text, const char* origin) {
    if (count < 1 || count > mostShards || index < 1 || index > count)
        throw UsageError(
            fmt::format("shard {}: give K/N with K from 1 to N, and N to {}, for "
                        "example 3/8",
                        text, mostShards));
    return {index, count, origin};
}

}  // namespace

Shard shardOf(std::string_view text) {
    const std::size_t slash = text.find('/');
    const std::string_view before = text.substr(0, slash);
    const std::string_view after =
        slash == std::string_view::npos ? std::string_view() : text.substr(slash + 1);
    if (!text.empty() && !before.empty()) {
        const auto index = wholeNumber(before), count = wholeNumber(after);
        return checked(index.value_or(0), count.value_or(0), fmt::format("'{}'", text), "");
    }
    const auto share = shareOfEnvironment();
    const std::size_t stated = text.empty() ? 0 : wholeNumber(after).value_or(0);
    if (!share) {
        if (text.empty()) return {};
        throw UsageError(
            fmt::format("shard '{}': no engine states the number of this process; "
                        "give K/N, for example 3/8",
                        text));
    }
    const std::size_t count = stated > 0 ? stated : share->count;
    if (count == 0)
        throw UsageError(
            fmt::format("{}: state the number of shards, for example /64", share->origin));
    return checked(share->number + 1, count,
                   fmt::format("{}/{} of the {}", share->number + 1, count, share->origin),
                   share->origin);
}

std::vector<std::uint32_t> assignShards(std::span<const double> costs,
                                        std::span<const std::string> texts, std::size_t count) {
    std::vector<std::uint32_t> shards(costs.size(), 0);
    if (count == 1) return shards;
    std::vector<std::size_t> order(costs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
        return costs[a] != costs[b] ? costs[a] > costs[b] : texts[a] < texts[b];
    });
    using Load = std::pair<double, std::uint32_t>;
    std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
    for (std::uint32_t k = 0; k < count; ++k) loads.emplace(0.0, k);
    for (const std::size_t i : order) {
        const auto [load, shard] = loads.top();
        loads.pop();
        shards[i] = shard;
        loads.emplace(load + costs[i], shard);
    }
    return shards;
}

}  // namespace hshfit::jobs
