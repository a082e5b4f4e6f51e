#pragma once

#include "unstated.h"

#include <cli/program.h>

#include <map>
#include <string>

namespace hshfit::test {

/// A folder in which the program and jobs write, to compare their files.
class JobFiles : public Cli {
protected:
    /// Runs the program, which has to succeed; its standard output.
    std::string runProgram(const std::string& arguments) const {
        const Answer answer = run(arguments);
        EXPECT_EQ(answer.code, 0) << arguments << "\n" << answer.err;
        return answer.out;
    }

    /// Bytes of a file without the key that the program states in it.
    static std::string read(const std::string& file) { return unstated(Cli::read(file)); }

    /// Name -> bytes of every file below a folder.
    std::map<std::string, std::string> filesIn(const std::string& folder) const {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::recursive_directory_iterator(path(folder)))
            if (entry.is_regular_file())
                files[fs::relative(entry.path(), path(folder)).string()] =
                    read(entry.path().string());
        return files;
    }
};

}  // namespace hshfit::test
