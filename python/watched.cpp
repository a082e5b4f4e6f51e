#include "watched.h"

#include "arrays.h"

#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/stop_request.h>

#include <jobs/common/named_errors.h>
#include <jobs/source/source.h>

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace hshfit::python {
namespace {

/// The meeting place of the work and the thread that watches it.
struct Watch {
    std::mutex mutex;
    std::condition_variable changed;
    bool finished = false, news = false;
    std::string part;
    std::size_t done = 0, total = 0;
    std::vector<std::string> notes;
    std::exception_ptr failure;  ///< of the work
    std::atomic<bool> stop = false;

    void report(const std::string& name, std::size_t finishedAmount, std::size_t wholeAmount) {
        if (stop) throw Stopped();
        const std::lock_guard lock(mutex);
        // Threads may report out of their order.
        if (name == part && total == wholeAmount && finishedAmount < done) return;
        part = name;
        done = finishedAmount;
        total = wholeAmount;
        news = true;
    }
};

jobs::Listener listenerOf(Watch& watch) {
    return {.begin = [&watch](const std::string& part) -> jobs::ProgressCall {
                return [&watch, part](std::size_t done, std::size_t total) {
                    watch.report(part, done, total);
                };
            },
            .note =
                [&watch](const std::string& remark) {
                    const std::lock_guard lock(watch.mutex);
                    watch.notes.push_back(remark);
                }};
}

void openAll(std::span<Source* const> sources) {
    for (Source* source : sources) source->open();
}

/// Messages name the file of a single source.
void withNames(std::span<Source* const> sources, const std::function<void()>& work) {
    if (sources.size() == 1 && sources[0]->isSpecification())
        jobs::withFileNamed(sources[0]->name(), work);
    else
        work();
}

/// Hands news to `progress` and lets signal handlers run. Under the interpreter's lock.
void attend(Watch& watch, const py::object& progress) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    std::unique_lock lock(watch.mutex);
    const bool news = std::exchange(watch.news, false);
    const std::string part = watch.part;
    const std::size_t done = watch.done, total = watch.total;
    lock.unlock();
    if (news && !progress.is_none()) progress(part, done, total);
}

/// Waits for the end of the work. Returns what was raised meanwhile.
std::exception_ptr wait(Watch& watch, const py::object& progress,
                        std::span<Source* const> sources) {
    std::exception_ptr raised;
    std::unique_lock lock(watch.mutex);
    while (!watch.finished) {
        watch.changed.wait_for(lock, std::chrono::milliseconds(50));
        if (watch.finished || raised) continue;
        lock.unlock();
        try {
            const py::gil_scoped_acquire held;
            attend(watch, progress);
        } catch (...) {
            raised = std::current_exception();
            watch.stop = true;
            for (const Source* source : sources)
                if (source->function()) source->function()->stop();
        }
        lock.lock();
    }
    return raised;
}

void rethrow(std::span<Source* const> sources) {
    for (const Source* source : sources)
        if (source->function()) source->function()->rethrow();
}

/// At the caller of the function around it (python/hshfit/_arguments.py).
void warn(const std::vector<std::string>& notes) {
    for (const std::string& note : notes)
        if (PyErr_WarnEx(PyExc_UserWarning, note.c_str(), 2) != 0) throw py::error_already_set();
}

}  // namespace

Source::Source(const py::object& argument, bool rgb, const char* name) : rgb_(rgb) {
    const py::object brdf = py::hasattr(argument, "brdf") ? argument.attr("brdf")() : argument;
    if (py::isinstance<Brdf>(brdf)) {
        if (rgb)
            throw UsageError(
                fmt::format("{}: rgb=True is for a specification; give it to open()", name));
        brdf_ = brdf.cast<std::shared_ptr<Brdf>>();
        if (const auto* function = dynamic_cast<const FunctionBrdf*>(brdf_.get())) {
            function_ = function->fresh();
            brdf_ = function_;
        }
        name_ = brdf_->name();
        return;
    }
    if (PyCallable_Check(brdf.ptr()) != 0)
        throw UsageError(fmt::format("{}: a function becomes a BRDF by hshfit.function()", name));
    name_ = pathOf(brdf, name);
    specified_ = true;
}

void Source::open() {
    if (!brdf_) brdf_ = jobs::openSource(name_, rgb_, jobs::Sides::eitherAndNamed);
}

void watched(const py::object& progress, std::span<Source* const> sources,
             const std::function<void(const jobs::Listener&)>& work) {
    Watch watch;
    std::exception_ptr raised;
    {
        const py::gil_scoped_release released;
        std::thread worker([&] {
            std::exception_ptr failure;
            stopRequest = &watch.stop;
            try {
                openAll(sources);
                withNames(sources, [&] { work(listenerOf(watch)); });
            } catch (...) {
                failure = std::current_exception();
            }
            const std::lock_guard lock(watch.mutex);
            watch.failure = failure;
            watch.finished = true;
            watch.changed.notify_all();
        });
        raised = wait(watch, progress, sources);
        worker.join();
    }
    if (raised) std::rethrow_exception(raised);
    rethrow(sources);
    if (watch.failure) std::rethrow_exception(watch.failure);
    attend(watch, progress);
    warn(watch.notes);
}

void unwatched(std::span<Source* const> sources, const std::function<void()>& work) {
    std::exception_ptr failure;
    {
        const py::gil_scoped_release released;
        try {
            openAll(sources);
            withNames(sources, work);
        } catch (...) {
            failure = std::current_exception();
        }
    }
    rethrow(sources);
    if (failure) std::rethrow_exception(failure);
}

}  // namespace hshfit::python
