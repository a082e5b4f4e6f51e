// `list presets`: a line per collection, search by name, what is said when nothing matches.

#include "places.h"
#include "program.h"

#include <nlohmann/json.hpp>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

std::ptrdiff_t lines(const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
}

TEST_F(Cli, PresetsAreSummedUpByCollection) {
    const Answer answer = run("list presets");
    EXPECT_EQ(answer.code, 0);
    EXPECT_LT(lines(answer.out), 40) << "1,302 materials are not to be printed unasked";
    for (const char* name : {"hsh-ward", "ngan-ward-duer", "low-abc-smooth-e2", "bagher-sgd"})
        EXPECT_NE(answer.out.find(name), std::string::npos) << name;
    const Json json = Json::parse(run("list presets --json").out);
    EXPECT_EQ(json["collections"].size(), 14u);
    int materials = 0;
    for (const Json& row : json["collections"]) materials += row["materials"].get<int>();
    EXPECT_EQ(materials, 1302);
    EXPECT_EQ(json["presets"].size(), 2u);
}

TEST_F(Cli, PresetsAreFoundByAnyPartOfTheirNames) {
    const Answer answer = run("list presets Blue-Acry");
    EXPECT_EQ(answer.code, 0);
    EXPECT_NE(answer.out.find("ngan-he/blue-acrylic\n"), std::string::npos) << answer.out;
    EXPECT_EQ(lines(answer.out), 14) << "one in each collection";
    EXPECT_EQ(lines(run("list presets ngan-ward-duer/").out), 86);
    EXPECT_EQ(lines(run("list presets --all").out), 1304);
    const Json json = Json::parse(run("list presets bagher-sgd/brass --json").out);
    ASSERT_EQ(json["presets"].size(), 1u);
    EXPECT_EQ(json["presets"][0]["name"], "bagher-sgd/brass");
    // Every listed name opens.
    const std::string spec = json["presets"][0]["spec"];
    EXPECT_EQ(run("eval '" + spec + "' --wi 20,0 --wo 30,180").out,
              run("eval preset:bagher-sgd/brass --wi 20,0 --wo 30,180").out);
}

TEST_F(Cli, NothingFoundIsAnsweredWithTheNearest) {
    expectError("list presets bleu-acrylic", 2, "blue-acrylic", 0);
    expectError("list presets qqqqqqqqq", 2, "--all", 0);
    expectError("list models acrylic", 2, "list presets", 0);
    expectError("eval preset:ngan-ward/blue-acrylik --wi 0,0 --wo 0,0", 2, "blue-acrylic", 0);
}

TEST_F(Cli, ListsOfPresetsKeepTheirSchema) {
    if (std::system("/usr/bin/python3 -c 'import jsonschema' 2>/dev/null") != 0)
        GTEST_SKIP() << "python3-jsonschema is not installed";
    for (const std::string arguments : {"", " --all", " acrylic"}) {
        write("answer.json", run("list presets --json" + arguments).out);
        const std::string source = test::sourceFolder();
        const std::string check = "/usr/bin/python3 " + source + "/tests/validate_schema.py " +
                                  source + "/docs/schemas/list.schema.json " + path("answer.json");
        EXPECT_EQ(std::system(check.c_str()), 0) << arguments;
    }
}

std::string words(const std::string& text) {
    std::istringstream in(text);
    std::string all;
    for (std::string word; in >> word;) all += word + " ";
    return all;
}

TEST_F(Cli, TablesWrapToTheTerminalAndStayWholeForOtherPrograms) {
    for (const char* section : {"models", "lights", "metrics", "presets"}) {
        const std::string list = std::string("list ") + section;
        ::unsetenv("COLUMNS");
        const std::string whole = run(list).out;
        ::setenv("COLUMNS", "60", 1);
        const std::string wrapped = run(list).out;
        ::unsetenv("COLUMNS");
        EXPECT_EQ(words(wrapped), words(whole)) << section;
        EXPECT_GT(lines(wrapped), lines(whole)) << section;
        std::istringstream in(wrapped);
        for (std::string line; std::getline(in, line);) {
            // Only a word that does not fit beside its indentation is longer.
            const std::size_t word = line.find_last_of(' ');
            if (line.size() > 60) {
                EXPECT_GT(line.size() - word, 60u - 43u) << line;
            }
        }
    }
}

}  // namespace
}  // namespace hshfit::test
