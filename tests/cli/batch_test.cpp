// `batch`: what is done again and what is kept, failures, mistakes, shards, kills.

#include "kills.h"
#include "program.h"
#include "unstated.h"

#include <hshfit/files/checksum.h>

#include <nlohmann/json.hpp>

#include <set>

namespace hshfit::test {
namespace {

using nlohmann::json;

class Batch : public Cli {
protected:
    Answer batch(const std::string& options = "") const {
        return run("batch " + path("m.jsonl") + " -o " + path("out") + " " + options);
    }
    json answerOf(const std::string& options = "") const {
        const Answer answer = batch("--json " + options);
        EXPECT_TRUE(keepsSchema(answer.out, "batch")) << answer.out << answer.err;
        return json::parse(answer.out);
    }
    std::string item(const std::string& name) const { return path("out/items/" + name); }
    json record(const std::string& name) const {
        return json::parse(read(item(name) + "/record.json"));
    }
    void manifest(const std::string& text) const { write("m.jsonl", text); }

    /// 24 small projections of files and models.
    void manyItems() const {
        std::string lines =
            R"({"defaults": {"command": "project", "options": {"order": 3, "outgoing": "4"}}})"
            "\n";
        for (int i = 1; i <= 24; ++i)
            lines += R"({"input": "phong:exponent=)" + std::to_string(i) + "\"}\n";
        manifest(lines);
    }
    std::set<std::string> hiddenIn(const std::string& folder) const {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder))
            if (entry.path().filename().string().starts_with('.'))
                names.insert(entry.path().filename());
        return names;
    }
    /// The table of all items, which is all that the batch found out.
    std::string merged() const {
        const Answer answer = batch("--merge --thumbnails 8 --quiet");
        EXPECT_EQ(answer.code, 0) << answer.err;
        return read(path("out/table.csv")) + read(path("out/table.jsonl")) +
               read(path("out/index.html"));
    }
};

/// The star of a weight is no pattern, and a pattern in a folder with a plus is one.
TEST_F(Batch, SumsAreNoPatterns) {
    fs::create_directory(path("a + b"));
    ASSERT_EQ(run("convert lambert '" + path("a + b/x.alta") + "' --to alta:theta=4,phi=8").code,
              0);
    manifest(
        R"({"defaults": {"command": "info", "name": "{stem}"}}
{"input": ["0.5 * lambert", "lambert:kd=.1 + 0.5 * ggx:alpha=.3"]}
{"input": "a + b/*.alta"}
)");
    const Answer answer = batch();
    EXPECT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(fs::exists(item("x")));
    EXPECT_EQ(std::distance(fs::directory_iterator(path("out/items")), {}), 3);
}

/// A change of a file that an input names, however deep, makes the item stale.
TEST_F(Batch, FilesThatInputsNameAreInputs) {
    ASSERT_EQ(run("convert lambert:kd=.5 " + path("data.alta") + " --to alta:theta=4,phi=8").code,
              0);
    ASSERT_EQ(
        run("project " + path("data.alta") + " --order 2 --outgoing 4 --form outgoing --split " +
            "diffuse -o " + path("c.json"))
            .code,
        0);
    manifest("{\"command\": \"info\", \"input\": \"" + path("c.json") + "\"}\n");
    EXPECT_EQ(answerOf()["done"], 1);
    EXPECT_EQ(answerOf()["kept"], 1);
    const auto inputs = record("c-info")["inputs"];
    bool named = false;
    for (const auto& input : inputs) named = named || input["path"] == path("data.alta");
    EXPECT_TRUE(named) << inputs;
    ASSERT_EQ(
        run("convert lambert:kd=.25 " + path("data.alta") + " --to alta:theta=4,phi=8 --force")
            .code,
        0);
    EXPECT_EQ(answerOf()["kept"], 0);
}

TEST_F(Batch, ItemsAreWhatTheCommandsWrite) {
    ASSERT_EQ(run("convert ggx:alpha=.4 " + path("one.binary")).code, 0);
    manifest(R"({"defaults": {"command": "project", "options": {"order": 4, "outgoing": "6"}}}
{"input": "one.binary"}

{"input": "phong:exponent=9", "name": "nine", "options": {"cosine": true, "outgoing": null}}
{"command": "compare", "input": "lambert", "with": "oren-nayar:kd=1,sigma=.3", "name": "c"}
{"command": "convert", "input": "lambert", "output": "l.binary"}
)");
    const json answer = answerOf();
    EXPECT_EQ(answer["items"], 4);
    EXPECT_EQ(answer["done"], 4);
    EXPECT_EQ(answer["kept"], 0);
    EXPECT_EQ(answer["failed"], 0);
    const std::string by = "cd " + folder_.string() + " && " + program();
    const auto same = [&](const std::string& words, const std::string& name) {
        const std::string quiet = " >/dev/null 2>&1";
        ASSERT_EQ(std::system((by + " " + words + " alone" + quiet).c_str()), 0) << words;
        EXPECT_EQ(sha256(read(item(name))), sha256(unstated(read(path("alone"))))) << name;
    };
    same("project one.binary --order 4 --outgoing 6 -o alone.json && mv alone.json",
         "one-project/coefficients.json");
    same("project phong:exponent=9 --order 4 --cosine -o alone.json && mv alone.json",
         "nine/coefficients.json");
    same("convert lambert alone.binary && mv alone.binary", "lambert-convert/l.binary");
    const json compared = json::parse(read(item("c/answer.json")));
    const json alone =
        json::parse(run("compare lambert oren-nayar:kd=1,sigma=.3 --json --threads 1").out);
    EXPECT_EQ(compared, alone);
    // Paths of the folder in which an item was made do not outlive it.
    const json projected = json::parse(read(item("nine/answer.json")));
    EXPECT_EQ(projected["output"], "coefficients.json");
    EXPECT_TRUE(hiddenIn(path("out/items")).empty());
    EXPECT_TRUE(fs::is_empty(path("out/running")));
}

TEST_F(Batch, OnlyWhatChangedIsDoneAgain) {
    ASSERT_EQ(run("convert lambert " + path("a.alta")).code, 0);
    ASSERT_EQ(run("convert lambert:kd=.5 " + path("b.alta")).code, 0);
    const std::string options = R"("options": {"order": 3, "outgoing": "20,0"})";
    const std::string defaults = R"({"defaults": {"command": "project", )" + options + "}}\n";
    manifest(defaults + R"({"input": ["a.alta", "b.alta", "lambert"]})");
    EXPECT_EQ(answerOf()["kept"], 0);
    EXPECT_EQ(answerOf()["kept"], 3);
    // The same bytes with another time are the same input.
    fs::last_write_time(path("a.alta"), fs::file_time_type::clock::now());
    EXPECT_EQ(answerOf()["kept"], 3);
    ASSERT_EQ(run("convert lambert:kd=.25 " + path("b.alta") + " --force").code, 0);
    EXPECT_EQ(answerOf("--status")["stale"], 1);
    EXPECT_EQ(answerOf()["kept"], 2);
    fs::remove(item("lambert-project/coefficients.json"));
    EXPECT_EQ(answerOf()["kept"], 2);
    manifest(defaults + R"({"input": ["a.alta", "b.alta"]}
{"input": "lambert", "options": {"order": 4}})");
    EXPECT_EQ(answerOf()["kept"], 2);
    EXPECT_EQ(answerOf("--force")["kept"], 0);
    EXPECT_EQ(answerOf("--status")["done"], 3);
}

/// A file of the same name beside the manifest is neither replaced nor an input.
TEST_F(Batch, FilesOfOptionsLieInTheFolderOfTheirItem) {
    write("r.csv", "mine");
    fs::create_directories(path("out/items"));
    fs::create_directory(path("aside"));
    fs::create_directory_symlink(path("aside"), item("linked"));
    const std::string options = R"({"model": "lambert", "residuals": "r.csv", "figures": "drawn"})";
    manifest(R"({"defaults": {"command": "fit", "options": )" + options + R"(}}
{"input": "lambert:kd=.5", "name": "half"}
{"input": "lambert:kd=.25", "name": "quarter"}
{"input": "lambert:kd=.25", "name": "linked"}
)");
    batch();
    for (const char* name : {"half", "quarter"}) {
        EXPECT_EQ(record(name)["exit_code"], 0);
        EXPECT_TRUE(fs::exists(item(name) + "/r.csv")) << name;
        EXPECT_TRUE(fs::is_directory(item(name) + "/drawn")) << name;
        EXPECT_EQ(record(name)["inputs"], json::array());
        const std::string answer = read(item(name) + "/answer.json");
        EXPECT_EQ(answer.find(folder_.string()), std::string::npos) << answer;
    }
    EXPECT_NE(read(item("half/r.csv")), read(item("quarter/r.csv")));
    EXPECT_EQ(read(path("r.csv")), "mine");
    EXPECT_TRUE(fs::is_empty(path("aside")));
    write("r.csv", "mine, changed");
    EXPECT_GE(answerOf()["kept"], 2);
    fs::remove(item("half/r.csv"));
    EXPECT_EQ(answerOf("--status")["stale"], 1);
}

TEST_F(Batch, TheNextRunBeginsWhatTheTimeDidNotSufficeFor) {
    manyItems();
    const Answer cut = batch("--seconds 0.01 --threads 1 --json");
    EXPECT_EQ(cut.code, 4) << cut.err;
    EXPECT_TRUE(keepsSchema(cut.out, "batch"));
    EXPECT_NE(cut.err.find("the time was over before"), std::string::npos) << cut.err;
    const json first = json::parse(cut.out);
    const int left = first["left"];
    EXPECT_GT(left, 0);
    EXPECT_EQ(first["done"].get<int>() + left, 24);
    EXPECT_EQ(first["failed"], 0);
    const json next = answerOf("--seconds 1000");
    EXPECT_EQ(next["left"], 0);
    EXPECT_EQ(next["done"], 24);
    EXPECT_EQ(next["kept"], first["done"]);
}

TEST_F(Batch, AFailureIsRecordedAndTriedAgain) {
    write("broken.binary", "no MERL file");
    manifest(R"({"defaults": {"command": "project", "options": {"order": 3, "outgoing": "20,0"}}}
{"input": ["broken.binary", "lambert"]}
{"input": "phong:exponent=5", "options": {"max-evaluations": 1000, "tolerance": 1e-12}}
)");
    const Answer first = batch();
    EXPECT_EQ(first.code, 3) << first.err;
    EXPECT_NE(first.err.find("of 3 items failed"), std::string::npos) << first.err;
    EXPECT_NE(first.err.find("broken-project: broken.binary"), std::string::npos) << first.err;
    EXPECT_EQ(record("broken-project")["exit_code"], 3);
    EXPECT_NE(record("broken-project")["message"].get<std::string>().find("broken.binary"),
              std::string::npos);
    EXPECT_FALSE(fs::exists(item("broken-project/coefficients.json")));
    EXPECT_TRUE(fs::exists(item("lambert-project/coefficients.json")));
    const json status = answerOf("--status");
    EXPECT_EQ(status["done"].get<int>() + status["failed"].get<int>(), 3);
    ASSERT_EQ(run("convert lambert " + path("good.binary")).code, 0);
    fs::rename(path("good.binary"), path("broken.binary"));
    batch();
    EXPECT_EQ(record("broken-project")["exit_code"], 0);
}

TEST_F(Batch, AllMistakesAreListedBeforeAnythingRuns) {
    manifest(R"({"defaults": {"command": "project"}}
{"input": "lambert"}
{"input": "lambret"}
{"input": "absent.binary"}
{"input": "lambert", "name": "again", "options": {"ordr": 3}}
{"input": "lambert", "name": "basis", "options": {"basis": "hhs"}}
{"input": "lambert", "name": "order", "options": {"order": "many"}}
{"input": "lambert"}
{"input": "no/*.binary"}
{"comand": "project", "input": "lambert"}
{"command": "projct", "input": "lambert"}
{"command": "convert", "input": "lambert", "name": "c"}
{"command": "fit", "input": "lambert", "name": "f", "options": {"model": "gxx"}}
{"command": "compare", "input": "lambert"}
{"input": "lambert", "with": "lambert"}
{"input": "lambert", "name": "a/b"}
{"input": "lambert", "output": "../up.json", "name": "up"}
{"input": "lambert", "name": "threads", "options": {"threads": 8}}
{"input": []}
{"input": "lambert", "name": "cost", "cost": -1}
[1, 2]
{"input": "lambert"
{"defaults": {"command": "fit"}}
)");
    const Answer answer = batch();
    EXPECT_EQ(answer.code, 3);
    EXPECT_FALSE(fs::exists(path("out")));
    EXPECT_NE(answer.err.find("m.jsonl: 21 mistakes; nothing was run"), std::string::npos)
        << answer.err;
    const std::pair<int, const char*> expected[] = {
        {3, "lambert"},    {4, "absent.binary"}, {5, "order"},       {6, "hsh"},
        {7, "--order"},    {8, "line 2"},        {9, "no/*.binary"}, {10, "command"},
        {11, "project"},   {12, "output"},       {13, "ggx"},        {14, "with is missing"},
        {15, "with"},      {16, "'a/b'"},        {17, "output"},     {18, "threads"},
        {19, "empty"},     {20, "cost"},         {21, "object"},     {22, "m.jsonl:22"},
        {23, "first line"}};
    for (const auto& [line, text] : expected) {
        const std::string place = "m.jsonl:" + std::to_string(line) + ":";
        const std::size_t at = answer.err.find(place);
        ASSERT_NE(at, std::string::npos) << place << "\n" << answer.err;
        const std::string said = answer.err.substr(at, answer.err.find('\n', at) - at);
        EXPECT_NE(said.find(text), std::string::npos) << said;
    }
    EXPECT_EQ(batch("--check").code, 3);
}

TEST_F(Batch, ManifestsThatAreNone) {
    write("m.jsonl", "\n\n");
    expectError("batch " + path("m.jsonl") + " -o " + path("out"), 3, "no items", 1);
    expectError("batch " + path("none.jsonl") + " -o " + path("out"), 3, "none.jsonl", 1);
    expectError("batch " + folder_.string() + " -o " + path("out"), 3, "folder", 1);
    expectError("batch " + path("m.jsonl"), 2, "--output", 1);
    for (const char* shard : {"0/4", "5/4", "x/4", "3", "1/0", "-1/2", "1/2/3"})
        expectError("batch " + path("m.jsonl") + " -o " + path("out") + " --shard " + shard, 2,
                    "K/N", 1);
    expectError("batch " + path("m.jsonl") + " -o " + path("out") + " --check --merge", 2,
                "give one of them", 1);
}

TEST_F(Batch, ShardsGiveTheSameMergedBytes) {
    manyItems();
    ASSERT_EQ(batch().code, 0);
    const std::string whole = merged();
    fs::remove_all(path("out"));
    std::size_t items = 0;
    for (int k = 1; k <= 8; ++k)
        items += answerOf("--shard " + std::to_string(k) + "/8")["items"].get<std::size_t>();
    EXPECT_EQ(items, 24u);
    EXPECT_EQ(merged(), whole);
    fs::remove_all(path("out"));
    // As a Slurm array from 10 to 14 in steps of 2, Open MPI, and Kubernetes would start them.
    const auto engine = [&](const std::string& variables, const std::string& shard) {
        const Answer answer =
            [&] {
                const std::string words = "env " + variables + " " + program() + " batch " +
                                          path("m.jsonl") + " -o " + path("out") + " --quiet " +
                                          shard;
                return std::system(words.c_str());
            }() == 0
                ? Answer{0, "", ""}
                : Answer{1, "", ""};
        EXPECT_EQ(answer.code, 0) << variables;
    };
    for (const char* id : {"10", "12", "14"})
        engine(
            "SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_MIN=10 SLURM_ARRAY_TASK_STEP=2 "
            "SLURM_ARRAY_TASK_ID=" +
                std::string(id),
            "");
    EXPECT_EQ(answerOf("--status")["done"], 24);
    EXPECT_EQ(merged(), whole);
    fs::remove_all(path("out"));
    for (const char* rank : {"0", "1"})
        engine("OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=" + std::string(rank), "");
    EXPECT_EQ(merged(), whole);
    fs::remove_all(path("out"));
    for (const char* index : {"0", "1", "2"})
        engine("JOB_COMPLETION_INDEX=" + std::string(index), "--shard /3");
    EXPECT_EQ(merged(), whole);
}

TEST_F(Batch, KillsLoseTheItemAtHandAlone) {
    manyItems();
    ASSERT_EQ(batch().code, 0);
    const std::string whole = merged();
    fs::remove_all(path("out"));
    const std::string items = path("out/items");
    const auto made = [&] {
        std::error_code error;
        return static_cast<std::size_t>(std::ranges::count_if(
            fs::directory_iterator(items, error),
            [](const auto& entry) { return !entry.path().filename().string().starts_with('.'); }));
    };
    int kills = 0, before = 0;
    for (int attempt = 0; attempt < 12 && made() < 12; ++attempt) {
        kills +=
            killedRuns({"batch", path("m.jsonl"), "-o", path("out"), "--quiet", "--threads", "2"},
                       made, 1, 12);
        const int done = answerOf("--status")["done"];
        EXPECT_GE(done, before) << "a result was lost";
        before = done;
    }
    EXPECT_GT(kills, 0);
    const json last = answerOf();
    EXPECT_EQ(last["done"], 24);
    EXPECT_GE(last["kept"].get<int>(), before);
    EXPECT_TRUE(hiddenIn(path("out/items")).empty());
    EXPECT_TRUE(fs::is_empty(path("out/running")));
    EXPECT_EQ(merged(), whole);
}

TEST_F(Batch, MemoryOfAnItemIsBounded) {
    // 90 x 90 x 180 values of three channels, 35 MB, do not fit into what an item may have.
    ASSERT_EQ(run("convert lambert " + path("a.binary")).code, 0);
    manifest(R"({"command": "convert", "input": "a.binary", "output": "b.binary"}
{"command": "eval", "input": "lambert", "options": {"wi": "0,0", "wo": "0,0"}}
)");
    const Answer answer = batch("--memory 20M --threads 1");
    EXPECT_EQ(answer.code, 4) << answer.err;
    EXPECT_NE(answer.err.find("not enough memory"), std::string::npos) << answer.err;
    EXPECT_EQ(record("lambert-eval")["exit_code"], 0);
    EXPECT_FALSE(fs::exists(item("a-convert/b.binary")));
    // Half of it does not suffice for one of two at a time, the whole does.
    const Answer enough = batch("--memory 600M --threads 2");
    EXPECT_EQ(enough.code, 0) << enough.err;
}

TEST_F(Batch, ProgressAsLines) {
    manyItems();
    ASSERT_EQ(batch("--progress " + path("progress.jsonl")).code, 0);
    std::istringstream lines(read(path("progress.jsonl")));
    std::set<std::string> items;
    for (std::string line; std::getline(lines, line);) {
        const json event = json::parse(line);
        EXPECT_EQ(event["state"], "done");
        items.insert(event["item"]);
        EXPECT_EQ(event["finished"], items.size());
    }
    EXPECT_EQ(items.size(), 24u);
}

TEST_F(Batch, TheTableHasNumbersAndTheTimesAreApart) {
    manyItems();
    ASSERT_EQ(batch().code, 0);
    merged();
    const std::string table = read(path("out/table.csv"));
    EXPECT_EQ(table.substr(0, table.find(',')), "name");
    EXPECT_NE(table.find(",accuracy"), std::string::npos) << table.substr(0, 300);
    EXPECT_EQ(table.find("seconds"), std::string::npos);
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 25);
    const json direct = json::parse(
        run("project phong:exponent=7 --order 3 --outgoing 4 --json -o " + path("x.json")).out);
    std::istringstream rows(read(path("out/table.jsonl")));
    bool found = false;
    for (std::string line; std::getline(rows, line);) {
        const json row = json::parse(line);
        if (row["input"] != "phong:exponent=7") continue;
        found = true;
        EXPECT_EQ(row["accuracy"], direct["accuracy"]);
        EXPECT_EQ(row["energy.value"], direct["energy"]["value"]);
    }
    EXPECT_TRUE(found);
    // The times weigh the shards of a later run.
    EXPECT_EQ(answerOf("--shard 1/2 --costs " + path("out/times.csv"))["failed"], 0);
    write("bad.csv", "name,seconds\n");
    EXPECT_EQ(batch("--costs " + path("bad.csv")).code, 3);
}

}  // namespace
}  // namespace hshfit::test
