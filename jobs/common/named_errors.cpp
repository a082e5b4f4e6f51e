#include "named_errors.h"

#include <hshfit/error.h>

#include <brdfs/rows/spec.h>

#include <fmt/format.h>

#include <string_view>

namespace hshfit::jobs {

void withFileNamed(const std::string& spec, const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& error) {
        const std::string_view path = brdfs::pathIn(spec), message = error.what();
        if (error.code() == ExitCode::output || message.find(path) != std::string_view::npos) throw;
        throw Error(error.code(), fmt::format("{}: {}", path, message));
    }
}

}  // namespace hshfit::jobs
