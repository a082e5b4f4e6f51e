#pragma once

#include "function_brdf.h"

#include <jobs/common/listener.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::python {

/// The BRDF of an argument: a Brdf, coefficients or a form of them, or a specification, which is
/// opened by `open`.
class Source {
public:
    /// Under the interpreter's lock. Throws UsageError for anything else.
    explicit Source(const py::object& argument, bool rgb = false, const char* name = "brdf");

    /// Anywhere; `brdf` may be used afterwards. Throws as jobs::openSource does.
    void open();
    const Brdf& brdf() const { return *brdf_; }
    /// The specification, or the name of a BRDF at hand.
    const std::string& name() const { return name_; }
    bool isSpecification() const { return specified_; }
    const FunctionBrdf* function() const { return function_.get(); }

private:
    std::string name_;
    bool rgb_ = false, specified_ = false;
    std::shared_ptr<const Brdf> brdf_;
    std::shared_ptr<const FunctionBrdf> function_;
};

/// Does `work` on a thread of its own without the interpreter's lock, after `sources` are opened.
/// The caller's thread meanwhile passes progress to `progress(part, done, total)`, unless that is
/// None, and looks for signals every 50 ms. If a signal handler, `progress` or a function behind a
/// source raises, the work ends at its next report of progress, evaluation or look at
/// hshfit::stopRequest, and the exception goes to the caller. Remarks become warnings of Python at
/// the end.
void watched(const py::object& progress, std::span<Source* const> sources,
             const std::function<void(const jobs::Listener&)>& work);

/// Does work that is over within a moment on the caller's thread, without a look at signals.
void unwatched(std::span<Source* const> sources, const std::function<void()>& work);

}  // namespace hshfit::python
