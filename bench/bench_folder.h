#pragma once

#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <string>

/// A folder for the files of a benchmark's run, removed at the end.
struct BenchFolder {
    std::filesystem::path path;
    BenchFolder() {
        std::string name =
            (std::filesystem::temp_directory_path() / "hshfit-bench-XXXXXX").string();
        if (!mkdtemp(name.data())) std::abort();
        path = name;
    }
    ~BenchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
};
