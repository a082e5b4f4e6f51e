#include "run.h"

#include <jobs/common/clock.h>

#include "costs.h"
#include "item_key.h"
#include "item_work.h"
#include "program.h"
#include "workers.h"

#include <hshfit/error.h>
#include <hshfit/time_limit.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <thread>
#include <utility>

namespace hshfit::jobs {

namespace {

std::size_t processesOf(const BatchOptions& options) {
    if (options.processes > 0) return options.processes;
    return std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

/// The items of a shard, the most costly first, so that no long one is left for the end.
struct ShardWork {
    std::vector<std::size_t> items;
    std::vector<double> costs;  ///< of all items of the manifest
};

ShardWork workOf(const Manifest& manifest, const BatchProgram& program,
                 const BatchOptions& options) {
    const Costs costs = options.costs.empty() ? Costs() : Costs::fromFile(options.costs);
    ShardWork share;
    std::vector<std::string> similarity;
    for (const BatchItem& item : manifest.items) {
        share.costs.push_back(costs.of(item, program));
        similarity.push_back(similarityOf(item, program));
    }
    const auto shards = assignShards(share.costs, similarity, options.shard.count);
    for (std::size_t i = 0; i < shards.size(); ++i)
        if (shards[i] + 1 == options.shard.index) share.items.push_back(i);
    std::ranges::stable_sort(
        share.items, [&](std::size_t a, std::size_t b) { return share.costs[a] > share.costs[b]; });
    return share;
}

/// One run over the items of a shard.
class Run {
public:
    Run(const std::string& folder, const BatchProgram& program, const BatchOptions& options,
        const std::function<void(const BatchEvent&)>& event, BatchRun& result,
        const ShardWork& share)
        : program_(program),
          options_(options),
          event_(event),
          result_(result),
          share_(share),
          store_(folder),
          writer_(store_),
          limit_(options.seconds) {
        for (const std::size_t i : share.items) costLeft_ += share.costs[i];
        result_.items = share.items.size();
    }

    /// Items that lacked memory in their share of it wait for `again`.
    void all(Workers& workers, bool again) {
        std::vector<std::size_t> items = again ? std::move(postponed_) : share_.items;
        postponed_.clear();
        std::vector<std::optional<ItemOrder>> orders(workers.size());
        std::size_t next = 0, busy = 0;
        const auto feed = [&](std::size_t worker) {
            while (next < items.size()) {
                if (limit_.isOver()) {
                    result_.left += items.size() - std::exchange(next, items.size());
                    return;
                }
                const std::size_t item = items[next++];
                auto order = orderFor(item);
                if (!order) continue;
                itemOf_.resize(workers.size());
                itemOf_[worker] = item;
                workers.send(worker, orderText(*order));
                orders[worker] = std::move(order);
                ++busy;
                return;
            }
        };
        for (std::size_t worker = 0; worker < workers.size(); ++worker) feed(worker);
        while (busy > 0) {
            const Workers::Reply reply = workers.wait();
            --busy;
            take(reply, *orders[reply.worker], again);
            feed(reply.worker);
        }
    }

    bool hasPostponed() const { return !postponed_.empty(); }
    std::size_t postponed() const { return postponed_.size(); }

private:
    /// None where the item is there and valid, or fails before it begins.
    std::optional<ItemOrder> orderFor(std::size_t index) {
        const BatchItem& item = result_.manifest.items[index];
        const auto earlier = store_.read(item.name);
        ItemOrder order{.part = writer_.part(item.name), .place = store_.place(item.name)};
        order.record.name = item.name;
        try {
            const ItemState state = stateOf(item, program_, sums_, earlier);
            const bool valid = earlier && earlier->isDone() && earlier->key == state.key &&
                               store_.isWhole(*earlier);
            if (valid && !options_.force) {
                finish(*earlier, true, index);
                return {};
            }
            order.record.words = state.words;
            order.record.key = state.key;
            order.record.inputs = state.inputs;
        } catch (const Error& error) {
            recordFailure(order, static_cast<int>(error.code()), error.what());
            finish(order.record, false, index);
            return {};
        }
        order.words = program_.words(item, order.part.string());
        return order;
    }

    void take(const Workers::Reply& reply, ItemOrder& order, bool again) {
        const std::size_t index = itemOf_[reply.worker];
        if (reply.text.empty()) {
            recordDeath(order, reply.signal);
            finish(order.record, false, index);
            return;
        }
        const ItemRecord record = madeItem(reply.text);
        if (options_.memory > 0 && !again && lackedMemory(record))
            postponed_.push_back(index);
        else
            finish(record, false, index);
    }

    void finish(const ItemRecord& record, bool kept, std::size_t index) {
        if (record.isDone()) {
            ++result_.done;
            result_.kept += kept ? 1 : 0;
        } else {
            result_.failures.push_back(record);
        }
        costLeft_ -= share_.costs[index];
        costMade_ += kept ? 0 : share_.costs[index];
        if (!event_) return;
        const double seconds = secondsSince(start_);
        event_({.record = record,
                .kept = kept,
                .finished = result_.done + result_.failures.size(),
                .failed = result_.failures.size(),
                .items = result_.items,
                .seconds = seconds,
                .secondsLeft = costMade_ > 0 ? seconds * std::max(0.0, costLeft_) / costMade_ : 0});
    }

    const BatchProgram& program_;
    const BatchOptions& options_;
    const std::function<void(const BatchEvent&)>& event_;
    BatchRun& result_;
    const ShardWork& share_;
    BatchStore store_;
    StoreWriter writer_;
    const TimeLimit limit_;
    FileSums sums_;
    std::vector<std::size_t> postponed_, itemOf_;
    double costLeft_ = 0, costMade_ = 0;
    Clock::time_point start_ = Clock::now();
};

}  // namespace

std::vector<std::size_t> itemsOfShard(const Manifest& manifest, const BatchProgram& program,
                                      const BatchOptions& options) {
    return workOf(manifest, program, options).items;
}

BatchRun runBatch(const std::string& manifest, const std::string& folder,
                  const BatchProgram& program, const BatchOptions& options,
                  const Listener& listener, const std::function<void(const BatchEvent&)>& event) {
    const auto start = Clock::now();
    const auto work = [&program](const std::string& order) { return makeItem(order, program); };
    const std::size_t processes = processesOf(options);
    std::optional<Workers> workers, whole;
    // Before the check, which may start threads.
    workers.emplace(processes, options.memory / processes, work);
    if (options.memory > 0) whole.emplace(1, options.memory, work);
    BatchRun result{.manifest = readManifest(manifest, program)};
    const ShardWork share = workOf(result.manifest, program, options);
    result.items = share.items.size();
    if (!result.manifest.mistakes.empty()) return result;
    Run run(folder, program, options, event, result, share);
    run.all(*workers, false);
    if (run.hasPostponed()) {
        listener.say(
            fmt::format("{} items need more than their share of the memory and are tried "
                        "again, one at a time",
                        run.postponed()));
        workers.reset();
        run.all(*whole, true);
    }
    std::ranges::sort(result.failures, {}, &ItemRecord::name);
    result.seconds = secondsSince(start);
    return result;
}

}  // namespace hshfit::jobs
