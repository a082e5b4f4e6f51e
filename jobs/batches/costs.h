#pragma once

#include <map>
#include <optional>
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
    /// Costs from the times.csv that a merge of earlier results wrote (docs/reference/batch.md):
    /// items get the measured processor time of their name or, if there is none, the mean of their
    /// class or their wider class. Throws InputError.
    static Costs fromFile(const std::string& path);

    double of(const BatchItem& item, const BatchProgram& program) const;

private:
    std::optional<double> classMean(const std::string& name, std::size_t least) const;

    std::map<std::string, double, std::less<>> seconds_;                          ///< by name
    std::map<std::string, std::pair<double, std::size_t>, std::less<>> classes_;  ///< sum, count
};

/// The class of an item; items of one class take similar times. It is a text of the command, its
/// options and its input: a model with the binary exponents of its parameters, or the extension of
/// a file with the binary exponent of its size.
std::string classOf(const BatchItem& item, const BatchProgram& program);
/// The class without the exponents.
std::string widerClassOf(const BatchItem& item, const BatchProgram& program);
/// A text, different for each item, by whose order items that take similar times are neighbours:
/// the class, then the values of parameters.
std::string similarityOf(const BatchItem& item, const BatchProgram& program);

}  // namespace hshfit::jobs
