#pragma once

#include "inputs.h"
#include "kept_outputs.h"
#include "listener.h"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::jobs {

/// The results of one command on many inputs.
template <class Result>
struct Many {
    std::vector<std::string> specs = {};    ///< folders and patterns expanded
    std::vector<std::string> outputs = {};  ///< of each, where files are written
    /// In the order of `specs`; none where one failed.
    std::vector<std::optional<Result>> results = {};
    std::vector<InputFailure> failures = {};
    std::vector<std::string> kept = {};  ///< outputs that stand and are valid; not in `outputs`
};

/// Calls `make(spec, output, listener)` for every input as forEachInput does. Without `outputs`,
/// `output` is empty. Outputs that stand: kept_outputs.h. Remarks begin with the input; progress
/// counts inputs.
template <class Result, class Make>
Many<Result> makeMany(std::vector<std::string> specs, std::vector<std::string> outputs,
                      const std::string& part, const Listener& listener, const Make& make) {
    Many<Result> many{.specs = std::move(specs), .outputs = std::move(outputs)};
    if (!many.outputs.empty()) many.kept = takeKept(many.specs, many.outputs);
    many.results.resize(many.specs.size());
    many.failures =
        forEachInput(many.specs, listener, part, [&](std::size_t i, const ProgressCall& progress) {
            const std::string &spec = many.specs[i],
                              output = many.outputs.empty() ? std::string() : many.outputs[i];
            progress(0, 1);
            const Listener each{.note = [&](const std::string& said) {
                listener.say(said.find(spec) == std::string::npos ? spec + ": " + said : said);
            }};
            const OutputKey key(keyOf({spec}));
            many.results[i] = make(spec, output, each);
            progress(1, 1);
        });
    return many;
}

}  // namespace hshfit::jobs
