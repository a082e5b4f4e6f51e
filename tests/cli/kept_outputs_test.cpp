// The rule for files that stand, over the table of commands: what is valid is kept and said so,
// what is not is refused unless --force replaces it.

#include "next_second.h"
#include "program.h"

#include <cli/command_table.h>

#include <nlohmann/json.hpp>

#include <map>
#include <ostream>
#include <set>
#include <string_view>

#include <sys/stat.h>

namespace hshfit::test {
namespace {

struct Row {
    std::string_view command;
    const char *words, *more, *others;  ///< more: options of the first run; others: in their place
    const char* output;                 ///< of -o, or "OUT FILE" by its place, or "--option FILE"
    bool byBytes = false;               ///< the format has no place for a key
};

void PrintTo(const Row& row, std::ostream* out) {
    *out << row.command << " to " << row.output;
}

constexpr Row rows[] = {
    {"project", "phong:exponent=5 --outgoing 4", "--order 3", "--order 4", "a.json"},
    {"project", "phong:exponent=5 --outgoing 4", "--order 3", "--order 4", "a.exr"},
    {"report", "phong:exponent=5 --bases hsh --outgoing 20,0", "--max-order 3", "--max-order 4",
     "report"},
    {"compare", "lambert lambert:kd=.5", "--outgoing 4", "--outgoing 5", "page"},
    {"compare", "lambert lambert:kd=.5 --outgoing 4", "--figure-width column",
     "--figure-width page", "--figures figures", true},
    {"convert", "lambert", "--to alta:theta=4,phi=8", "--to alta:theta=5,phi=8", "OUT a.alta",
     true},
    {"export", "in.json --target bin --no-error", "--number float16", "--number float32", "out"},
    {"fit", "ggx:alpha=.4 --model ggx --starts 1 --samples 200 --loss l2", "--seed 1", "--seed 2",
     "fit.json"},
    {"fit", "ggx:alpha=.4 --model ggx --starts 1 --samples 200 --loss l2 -o fit.json", "--seed 1",
     "--seed 2", "--figures figures", true},
    {"render", "lambert", "--size 16", "--size 24", "a.png"},
    {"render", "lambert --light uniform: --order 2 --size 8", "--samples 1", "--samples 2",
     "a.exr"},
    {"plot", "hsh", "--order 2", "--order 3", "a.svg", true},
    {"plot", "hsh", "--order 2", "--order 3", "a.png"},
    {"plot", "hsh", "--order 2", "--order 3", "a.pdf", true},
    {"ltc", "ggx", "--size 2", "--size 3", "a.json"},
    {"gaussians", "lambert --lobes 1 --outgoing 2", "--kind sg", "--kind asg", "a.json"},
    {"irradiance", "uniform:", "--normals 100", "--normals 200", "--by-normal a.csv", true},
    {"import", "exported/in.hsh.json", "", "", "a.json"},
    {"rotate", "in.json", "--euler 0,30,0", "--euler 0,40,0", "a.json"},
    {"light", "uniform:radiance=1", "--order 3", "--order 4", "a.json"},
    {"eval", "lambert --pairs pairs.csv", "", "--cosine", "a.csv", true},
    {"sample", "lambert --outgoing 45,0 --count 3", "--seed 1", "--seed 2", "a.csv", true},
    {"completion", "", "bash", "fish", "a.sh", true},
    {"tradeoff",
     "lambert --forms outgoing --bases hsh --ranks 0 --precisions float32 --outgoing 4 "
     "--no-timing --pair-count 256",
     "--orders 2", "--orders 3", "trade"},
    {"choose", "lambert --kinds model", "--for any", "--for glsl", "choice"},
    {"plan", "budget.json --bases hsh", "--max-order 2", "--max-order 3", "plan"},
    {"stress", "--max-order 2 --bases hsh --of lambert", "--trials 1", "--trials 2", "stress"},
    {"illuminate", "scene.json --samples 1", "--seed 1", "--seed 2", "pictures"},
    {"transfer", "scene.json --rays 4 --edge 0", "--order 2", "--order 3", "light"},
    {"svbrdf", "map.json --checks 0", "--order 2", "--order 3", "map"},
    {"library", "learn lambert:kd=.3/.2/.1 ggx:alpha=.3,F0=.9/.6/.3", "--components 2",
     "--components 3", "a.library", true},
    {"manual", "", "", "", "man", true},
};

class KeptOutputs : public Cli, public testing::WithParamInterface<Row> {
protected:
    void SetUp() override {
        Cli::SetUp();
        write("pairs.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0.6,0,0.8,0,0,1\n");
        writeScenes();
        ASSERT_EQ(runHere("project phong:exponent=5 --outgoing 4 --order 3 -o in.json").code, 0);
        if (GetParam().command != "import") return;
        ASSERT_EQ(runHere("export in.json -o exported --target bin --no-error").code, 0);
    }
    void writeScenes() const {
        const std::string head = R"({"format": "hshfit-scene", "version": 1,
            "materials": [{"name": "m", "brdf": "lambert:kd=.5"}],
            "lights": [{"light": "uniform:radiance=1"}],)";
        write("budget.json", head + R"("budget": {"metric": "relative_l2", "error": 0.5}})");
        write("scene.json", head + R"("objects": [
            {"name": "floor", "mesh": "square", "material": "m"}], "cameras": [{"name": "view",
            "position": [0, -3, 3], "target": [0, 0, 0], "field_of_view": 34, "width": 8}]})");
        write("kd.pfm", std::string("Pf\n1 1\n-1.0\n") + std::string("\0\0\0\x3f", 4));
        write("map.json", R"({"format": "hshfit-svbrdf", "version": 1, "model": "lambert",
            "parameters": {"kd": {"map": "kd.pfm"}}})");
    }
    Answer runHere(const std::string& words) const {
        const std::string program = test::program(), err = path("stderr");
        const std::string line = "cd " + folder_.string() + " && " + program + " " + words + " >" +
                                 path("stdout") + " 2>" + err;
        const int code = WEXITSTATUS(std::system(line.c_str()));
        return {code, read(path("stdout")), read(err)};
    }
    Answer runRow(const Row& row, const char* options, const std::string& more = "") const {
        const std::string output(row.output), words = std::string(row.command) + " " + row.words;
        if (output.starts_with("OUT "))
            return runHere(words + " " + output.substr(4) + " " + options + " " + more);
        const std::string option = output.starts_with("--") ? " " : " -o ";
        return runHere(words + " " + options + option + output + " " + more);
    }
    static std::string nameOf(const Row& row) {
        const std::string output(row.output);
        return output.substr(output.find(' ') + 1);
    }
    /// The output: contents of files, and their times, by name.
    std::map<std::string, std::string> outputs(const Row& row, bool times = true) const {
        const fs::path place = folder_ / nameOf(row);
        std::map<std::string, std::string> found;
        const auto add = [&](const fs::path& file) {
            struct stat facts {};
            ::stat(file.c_str(), &facts);
            found[file.string()] = read(file);
            if (times)
                found[file.string()] +=
                    std::to_string(facts.st_ino) + " " + std::to_string(facts.st_mtim.tv_nsec);
        };
        if (!fs::is_directory(place)) {
            add(place);
            return found;
        }
        for (const auto& entry : fs::recursive_directory_iterator(place))
            if (entry.is_regular_file()) add(entry.path());
        return found;
    }
};

TEST_P(KeptOutputs, WhatIsValidIsKeptAndAnythingElseIsRefusedWithoutForce) {
    const Row& row = GetParam();
    const Answer first = runRow(row, row.more);
    ASSERT_EQ(first.code, 0) << first.err;
    const auto written = outputs(row), bytes = outputs(row, false);
    ASSERT_FALSE(written.empty());

    hshfit::test::untilNextSecond();
    const Answer again = runRow(row, row.more);
    EXPECT_EQ(again.code, 0) << again.err;
    const std::string& said = row.byBytes ? again.err : again.out;
    EXPECT_NE(said.find("kept "), std::string::npos) << again.out << again.err;
    EXPECT_EQ(outputs(row), written);

    // Made again, a file has no trace of the time at which that happened.
    EXPECT_EQ(runRow(row, row.more, "--force").code, 0);
    EXPECT_TRUE(outputs(row, false) == bytes);
    const auto made = outputs(row);

    if (std::string_view(row.others) == row.more) return;
    const Answer other = runRow(row, row.others);
    EXPECT_EQ(other.code, 5) << other.out << other.err;
    EXPECT_EQ(std::count(other.err.begin(), other.err.end(), '\n'), 1) << other.err;
    EXPECT_NE(other.err.find("exists"), std::string::npos) << other.err;
    EXPECT_NE(other.err.find("--force"), std::string::npos) << other.err;
    EXPECT_EQ(outputs(row), made);

    const Answer forced = runRow(row, row.others, "--force");
    EXPECT_EQ(forced.code, 0) << forced.err;
    EXPECT_NE(outputs(row), made);
    EXPECT_EQ(runRow(row, row.others).code, 0);
}

TEST_P(KeptOutputs, AFileOfSomebodyElseIsRefused) {
    const Row& row = GetParam();
    const std::string name = nameOf(row);
    if (!fs::path(name).has_extension()) return;  // a folder: its files are tried below
    write(name, "mine");
    const Answer refused = runRow(row, row.more);
    EXPECT_EQ(refused.code, 5) << refused.out << refused.err;
    EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
    EXPECT_EQ(read(path(name)), "mine");
}

INSTANTIATE_TEST_SUITE_P(Every, KeptOutputs, testing::ValuesIn(rows), [](const auto& row) {
    std::string name(row.param.command);
    for (const char c : std::string_view(row.param.output))
        if (std::isalpha(static_cast<unsigned char>(c)) != 0) name += c;
    return name;
});

TEST_F(Cli, EveryCommandThatWritesTakesForceAndHasARowOrAReason) {
    const std::set<std::string_view> reasons{"batch"};  // a rule of its own, by its records
    std::set<std::string_view> tried;
    for (const Row& row : rows) tried.insert(row.command);
    for (const cli::Command& command : cli::commands()) {
        const std::string help = run(std::string(command.name) + " --help").out;
        const bool force = help.find("--force") != std::string::npos;
        if (help.find("--output") != std::string::npos) {
            EXPECT_TRUE(force) << command.name;
        }
        EXPECT_EQ(force, tried.contains(command.name) || reasons.contains(command.name))
            << command.name;
    }
}

using KeptFiles = Cli;

TEST_F(KeptFiles, OtherBytesOfTheInputAreOtherInput) {
    ASSERT_EQ(run("convert lambert " + path("a.alta") + " --to alta:theta=4,phi=8").code, 0);
    const std::string job =
        "project " + path("a.alta") + " --order 2 --outgoing 4 -o " + path("c.json");
    ASSERT_EQ(run(job).code, 0);
    const std::string before = read(path("c.json"));
    ASSERT_EQ(
        run("convert lambert:kd=.25 " + path("a.alta") + " --to alta:theta=4,phi=8 --force").code,
        0);
    const Answer refused = run(job);
    EXPECT_EQ(refused.code, 5) << refused.out;
    EXPECT_NE(refused.err.find("other input, options or version"), std::string::npos)
        << refused.err;
    EXPECT_EQ(read(path("c.json")), before);
}

TEST_F(KeptFiles, ColoursWeightsAndSidecarsArePartOfTheInput) {
    const auto isOther = [&](const std::string& before, const std::string& after,
                             const std::string& name) {
        ASSERT_EQ(run(before + path(name)).code, 0) << before;
        const Answer other = run(after + path(name));
        EXPECT_EQ(other.code, 5) << after << other.out;
    };
    const std::string project = "project ", few = " --order 2 --outgoing 4 -o ";
    isOther(project + "lambert:kd=0.5/0.2/0.1" + few, project + "lambert:kd=0.9/0.9/0.1" + few,
            "kd.json");
    isOther(project + "ggx:alpha=.5,metal=gold,nm=450/550/650" + few,
            project + "ggx:alpha=.5,metal=gold,nm=400/500/650" + few, "nm.json");
    const std::string table = path("b.alta"), grid = " --to alta:theta=4,phi=8 --force";
    ASSERT_EQ(run("convert lambert " + table + grid).code, 0);
    const std::string sum = project + "'0.5 * " + table + " + lambert:kd=0.1'" + few;
    ASSERT_EQ(run(sum + path("sum.json")).code, 0);
    ASSERT_EQ(run("convert lambert:kd=.25 " + table + grid).code, 0);
    EXPECT_EQ(run(sum + path("sum.json")).code, 5);
    ASSERT_EQ(run(project + "lambert" + few + path("m.json")).code, 0);
    ASSERT_EQ(run("export " + path("m.json") + " --target bin -o " + path("e")).code, 0);
    const std::string import = "import " + path("e/m.coef.f16.bin") + " -o " + path("i.json");
    ASSERT_EQ(run(import).code, 0);
    EXPECT_NE(run(import).out.find("kept "), std::string::npos);
    std::string sidecar = read(path("e/m.hsh.json"));
    write("e/m.hsh.json", sidecar + " ");
    EXPECT_EQ(run(import).code, 5);
}

// The bytes of a format that states no key decide, whatever stands beside it.
TEST_F(KeptFiles, ATableBesideAValidFileIsNotTakenForValid) {
    const std::string fit = "fit ggx:alpha=.3 --model ggx --starts 1 --samples 200 ";
    ASSERT_EQ(run(fit + "-o " + path("a.json")).code, 0);
    write("r.csv", "somebody else's\n");
    const Answer refused = run(fit + "-o " + path("a.json") + " --residuals " + path("r.csv"));
    EXPECT_EQ(refused.code, 5) << refused.out;
    EXPECT_EQ(read(path("r.csv")), "somebody else's\n");
}

TEST_F(KeptFiles, AFileThatWasChangedIsRefused) {
    for (const std::string name : {"x.json", "x.exr", "x.png"}) {
        const std::string made = name == "x.png" ? "render lambert --size 16 --light uniform: -o "
                                                 : "project lambert --order 3 --outgoing 4 -o ";
        ASSERT_EQ(run(made + path(name)).code, 0) << name;
        EXPECT_NE(run(made + path(name)).out.find("kept "), std::string::npos) << name;
        std::string bytes = read(path(name));
        // A digit of a coefficient, a byte of the pixels.
        const std::size_t at = name == "x.json"
                                   ? bytes.find_first_of("123456789", bytes.find("coefficients\":"))
                               : name == "x.exr" ? bytes.size() - 1
                                                 : bytes.find("IDAT") + 12;
        bytes[at] = static_cast<char>(bytes[at] ^ 1);
        write(name, bytes);
        const Answer again = run(made + path(name));
        EXPECT_EQ(again.code, 5) << name;
        EXPECT_NE(again.err.find("was changed after it was made"), std::string::npos) << again.err;
        EXPECT_EQ(read(path(name)), bytes) << name;
    }
}

TEST_F(KeptFiles, AnInputElsewhereWithTheSameBytesIsTheSameInput) {
    ASSERT_EQ(run("convert lambert " + path("a.alta") + " --to alta:theta=4,phi=8").code, 0);
    const std::string job = " --order 2 --outgoing 4 -o " + path("c.json");
    ASSERT_EQ(run("project " + path("a.alta") + job).code, 0);
    fs::create_directory(path("moved"));
    fs::rename(path("a.alta"), path("moved/a.alta"));
    EXPECT_NE(run("project " + path("moved/a.alta") + job).out.find("kept "), std::string::npos);
}

TEST_F(KeptFiles, TheAnswerOfAKeptFileIsADocument) {
    const std::string job = "project lambert --order 2 --outgoing 4 --json -o " + path("c.json");
    ASSERT_EQ(run(job).code, 0);
    const Answer again = run(job);
    EXPECT_EQ(again.code, 0);
    EXPECT_TRUE(keepsSchema(again.out, "kept"));
    EXPECT_EQ(nlohmann::json::parse(again.out)["kept"][0], path("c.json"));
    EXPECT_TRUE(keepsSchema(read(path("c.json")), "coefficients"));
}

TEST_F(KeptFiles, ThreadsAndWordsOfTheAnswerAreNoOptionsOfTheResult) {
    const std::string job = "project lambert --order 2 --outgoing 4 -o " + path("c.json");
    ASSERT_EQ(run(job + " --threads 1 --quiet").code, 0);
    EXPECT_NE(run(job + " --threads 2").out.find("kept "), std::string::npos);
    EXPECT_NE(run(job + " --basis hsh").out.find("kept "), std::string::npos);  // the default
}

TEST_F(KeptFiles, OfManyInputsThoseThatAreValidAreKept) {
    const std::string job = "project lambert phong:exponent=5 --order 2 --outgoing 4 ";
    ASSERT_EQ(run(job + "-o " + path("out")).code, 0);
    fs::remove(path("out/lambert.json"));
    const Answer again = run(job + "--json -o " + path("out"));
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_TRUE(keepsSchema(again.out, "projects"));
    const auto document = nlohmann::json::parse(again.out);
    EXPECT_EQ(document["projections"].size(), 1u);
    ASSERT_EQ(document["kept"].size(), 1u);
    EXPECT_EQ(document["kept"][0], path("out/phong_exponent=5.json"));
    // One file that is not valid stops all, before any is written.
    fs::remove(path("out/lambert.json"));
    const Answer other = run(job + "--cosine -o " + path("out"));
    EXPECT_EQ(other.code, 5) << other.out;
    EXPECT_FALSE(fs::exists(path("out/lambert.json")));
}

TEST_F(KeptFiles, AReportThatLacksAFileIsMadeAgain) {
    const std::string job =
        "report lambert --bases hsh --max-order 2 --outgoing 20,0 -o " + path("out");
    ASSERT_EQ(run(job).code, 0);
    const std::string report = read(path("out/report.html"));
    fs::remove(path("out/report.html"));
    const Answer again = run(job);
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(read(path("out/report.html")), report);
}

TEST_F(KeptFiles, AReportWithoutNumbersKeepsItsExitCode) {
    const std::string job =
        "report ward:ax=.2,ay=.5,variant=duer --bases hsh --max-order 2 "
        "--outgoing 30,0 -o " +
        path("out");
    ASSERT_EQ(run(job).code, 4);
    const Answer again = run(job);
    EXPECT_EQ(again.code, 4) << again.out << again.err;
    EXPECT_NE(again.out.find("kept "), std::string::npos) << again.out;
}

TEST_F(KeptFiles, FilesThatStateTheirKeyAreReadAsBefore) {
    ASSERT_EQ(run("project ggx:alpha=.4 --order 3 --outgoing 4 -o " + path("a.json")).code, 0);
    ASSERT_EQ(run("project ggx:alpha=.4 --order 3 --outgoing 4 -o " + path("a.exr")).code, 0);
    EXPECT_NE(read(path("a.json")).find("\"made_from\""), std::string::npos);
    EXPECT_NE(read(path("a.exr")).find("hshfit:made_from"), std::string::npos);
    const Answer same = run("compare " + path("a.json") + " " + path("a.exr") +
                            " --metrics relative-l2-cosine --json");
    ASSERT_EQ(same.code, 0) << same.err;
    const auto value = nlohmann::json::parse(same.out)["metrics"][0]["value"];
    EXPECT_LT(value.get<double>(), 1e-6);  // EXR holds float32
    ASSERT_EQ(run("render lambert --size 16 -o " + path("a.png")).code, 0);
    EXPECT_EQ(
        std::system(("python3 -c \"import struct,zlib,sys;b=open('" + path("a.png") +
                     "','rb').read();p=8\nwhile p<len(b):\n n=struct.unpack('>I',b[p:p+4])[0]\n"
                     " assert struct.unpack('>I',b[p+8+n:p+12+n])[0]==zlib.crc32(b[p+4:p+8+n])\n"
                     " p+=12+n\n\"")
                        .c_str()),
        0);
}

}  // namespace
}  // namespace hshfit::test
