// The manual: formatted by groff without warnings, complete, and shown by man.

#include "program.h"

#include <cli/command_table.h>
#include <cli/topics.h>

namespace hshfit::test {
namespace {

class Manual : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        const Answer answer = run("manual -o " + path("man"));
        ASSERT_EQ(answer.code, 0) << answer.err;
    }
    /// Standard output and error of a shell command.
    std::string shell(const std::string& command) const {
        const std::string line = command + " >" + path("out") + " 2>&1";
        EXPECT_EQ(std::system(line.c_str()), 0) << command << "\n" << read(path("out"));
        return read(path("out"));
    }
};

bool has(const std::string& tool) {
    return std::system(("command -v " + tool + " >/dev/null").c_str()) == 0;
}

TEST_F(Manual, HasAPageForTheProgramEveryCommandAndEveryTopic) {
    EXPECT_TRUE(fs::exists(path("man/man1/hshfit.1")));
    for (const cli::Command& row : cli::commands())
        EXPECT_TRUE(fs::exists(path(std::string("man/man1/hshfit-") + row.name + ".1")));
    for (const cli::Topic& topic : cli::topics())
        EXPECT_TRUE(fs::exists(path(std::string("man/man7/hshfit-") + topic.name + ".7")));
    const std::string page = path("man/man1/hshfit.1"), text = read(page);
    EXPECT_EQ(run("manual -o " + path("man")).code, 0);
    std::ofstream(page, std::ios::app) << "more";
    expectError("manual -o " + path("man"), 5, page, 1);
    EXPECT_EQ(run("manual --force -o " + path("man")).code, 0);
    EXPECT_EQ(read(page), text);
}

TEST_F(Manual, GroffFormatsEveryPageWithoutAWarning) {
    if (!has("groff")) GTEST_SKIP() << "groff is not installed";
    for (const auto& page : fs::recursive_directory_iterator(path("man"))) {
        if (!page.is_regular_file()) continue;
        const std::string said =
            shell("(groff -man -ww -Tutf8 " + page.path().string() + " 2>&1 >/dev/null)");
        EXPECT_EQ(said, "") << page.path();
    }
}

TEST_F(Manual, ManShowsACommandWithItsOptionsAndExample) {
    if (!has("man") || !has("groff")) GTEST_SKIP() << "man or groff is not installed";
    const std::string page = shell("MANWIDTH=100 man -l " + path("man/man1/hshfit-project.1"));
    for (const std::string part :
         {"HSHFIT-PROJECT(1)", "SYNOPSIS", "hshfit project [OPTIONS] SPEC…", "--tolerance NUMBER",
          "hshfit project ward:ax=.2,ay=.5 -o ward.json --basis hsh --order 7 --cosine",
          "hshfit-specifications(7)"})
        EXPECT_NE(page.find(part), std::string::npos) << part << page;
    const std::string topic = shell("MANWIDTH=100 man -l " + path("man/man7/hshfit-losses.7"));
    EXPECT_NE(topic.find("Löw"), std::string::npos) << topic;
}

}  // namespace
}  // namespace hshfit::test
