#include "batch_options.h"

namespace hshfit::jobs {
namespace {

using options::at;

constexpr OptionRow batchRows[] = {
    OptionRow{"shard", at<&BatchRequest::shard>,
              "K/N: the share K of N, from 1; /N: K from the environment of Slurm, Kubernetes or "
              "Open MPI"}
        .byDefault("from the environment, else 1/1"),
    OptionRow{"memory", at<&BatchRequest::run, &BatchOptions::memory>,
              "Bytes for all processes together, with a unit (8G)"}
        .in(Unit::bytes),
    OptionRow{"costs", at<&BatchRequest::run, &BatchOptions::costs>,
              "times.csv of an earlier merge, by which shards are weighed"}
        .takes({.files = Files::read}),
    OptionRow{"progress", at<&BatchRequest::progress>,
              "File to which a JSON line is added for each item, such as /dev/stderr"}
        .takes({.files = Files::added}),
    OptionRow{"force", at<&BatchRequest::run, &BatchOptions::force>,
              "Do again what is done and valid"},
    OptionRow{"seconds", at<&BatchRequest::run, &BatchOptions::seconds>,
              "Begin no item after that time; the next run makes the others (default: no end)"}
        .within(bounds::seconds),
    OptionRow{"check", at<&BatchRequest::check>, "Check the manifest and run nothing"}.notWith(
        "status merge"),
    OptionRow{"list", at<&BatchRequest::list>,
              "With --check: the names of the shard's items, the most costly first"}
        .with("check"),
    OptionRow{"status", at<&BatchRequest::status>, "Count what is done, failed, stale, missing"}
        .notWith("merge"),
    OptionRow{"merge", at<&BatchRequest::merge>,
              "Write table.csv, table.jsonl, times.csv and index.html of all items"},
    OptionRow{"thumbnails", at<&BatchRequest::merging, &MergeOptions::thumbnail>,
              "With --merge: pixels of each material's sphere; 0: none"}
        .within(Bounds<int>{0, 512})
        .with("merge"),
};

}  // namespace

OptionRows<BatchRequest> batchOptions() {
    return {batchRows};
}

}  // namespace hshfit::jobs
