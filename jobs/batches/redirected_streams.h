#pragma once

#include <filesystem>

namespace hshfit::jobs {

/// While it lives, the standard output and the standard error of the process go to files. Throws
/// OutputError for a file that cannot be made.
class RedirectedStreams {
public:
    RedirectedStreams(const std::filesystem::path& output, const std::filesystem::path& error);
    ~RedirectedStreams();
    RedirectedStreams(const RedirectedStreams&) = delete;
    RedirectedStreams& operator=(const RedirectedStreams&) = delete;

private:
    int output_, error_;  ///< the streams before
};

}  // namespace hshfit::jobs
