#pragma once

#include <map>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct BatchItem;
struct BatchProgram;

/// Estimates of the time that items take, in seconds of an unnamed machine: only their ratios
/// count. They depend on the manifest, the sizes of files and the table of costs alone, so that all
/// shards agree on them.
class Costs {
public:
    Costs() = default;
    /// Of the times.csv that a merge of earlier results wrote (docs/batch.md): items get the
    /// measured time of their name or, if there is none, the mean of their class. Throws
    /// InputError.
    static Costs fromFile(const std::string& path);

    double of(const BatchItem& item, const BatchProgram& program) const;

private:
    std::map<std::string, double, std::less<>> seconds_;                          ///< by name
    std::map<std::string, std::pair<double, std::size_t>, std::less<>> classes_;  ///< sum, count
};

/// Items of one class take similar times: the command, its options, the kind of the input and the
/// power of two of its size.
std::string classOf(const BatchItem& item, const BatchProgram& program);

}  // namespace hshfit::jobs
