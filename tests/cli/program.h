#pragma once

// Runs the program in a folder of its own.

#include "places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <sys/wait.h>

namespace hshfit::test {

namespace fs = std::filesystem;

struct Answer {
    int code;
    std::string out, err;
};

class Cli : public testing::Test {
protected:
    void SetUp() override {
        std::string name = fs::temp_directory_path() / "hshfit-cli-XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string path(const std::string& name) const { return folder_ / name; }

    Answer run(const std::string& arguments) const {
        const std::string err = path("stderr");
        std::FILE* pipe = popen((test::program() + " " + arguments + " 2>" + err).c_str(), "r");
        Answer answer{};
        std::array<char, 4096> buffer;
        while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
            answer.out.append(buffer.data(), n);
        }
        answer.code = WEXITSTATUS(pclose(pipe));
        answer.err = read(err);
        fs::remove(err);
        return answer;
    }

    static std::string read(const std::string& file) {
        std::ifstream in(file, std::ios::binary);
        std::stringstream text;
        text << in.rdbuf();
        return text.str();
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
    }

    /// Checks the exit code, one line on standard error that contains `part`, and no files but
    /// those known.
    void expectError(const std::string& arguments, int code, const std::string& part,
                     std::ptrdiff_t files) const {
        const Answer answer = run(arguments);
        EXPECT_EQ(answer.code, code) << arguments << "\n" << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
        EXPECT_NE(answer.err.find(part), std::string::npos) << answer.err;
        EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), files) << arguments;
    }

    /// Validates `document` against docs/schemas/NAME.schema.json. Without python3-jsonschema
    /// it prints that and returns true.
    bool keepsSchema(const std::string& document, const std::string& name) const {
        if (std::system("/usr/bin/python3 -c 'import jsonschema' 2>/dev/null") != 0) {
            std::printf("%s: not held to its schema, python3-jsonschema is absent\n", name.c_str());
            return true;
        }
        write("answer.json", document);
        const std::string source = test::sourceFolder();
        const std::string check = "/usr/bin/python3 " + source + "/tests/validate_schema.py " +
                                  source + "/docs/schemas/" + name + ".schema.json " +
                                  path("answer.json");
        const bool kept = std::system(check.c_str()) == 0;
        fs::remove(path("answer.json"));
        return kept;
    }

    fs::path folder_;
};

}  // namespace hshfit::test
