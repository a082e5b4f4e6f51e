// "-" for standard input and output.

#include "program.h"
#include "unstated.h"

#include <nlohmann/json.hpp>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

class Streams : public Cli {
protected:
    Answer shell(const std::string& command) const {
        write("job.sh", "cd " + folder_.string() + "\nhshfit() { " + program() + " \"$@\"; }\n" +
                            command + "\n");
        const std::string line = "sh " + path("job.sh") + " >" + path("out") + " 2>" + path("err");
        const int status = std::system(line.c_str());
        return {WEXITSTATUS(status), read(path("out")), read(path("err"))};
    }
};

TEST_F(Streams, CoefficientsGoThroughAPipe) {
    const std::string job = "project lambert --order 3 --outgoing 2 ";
    ASSERT_EQ(run(job + "-o " + path("file.json")).code, 0);
    const Answer piped = shell("hshfit " + job + "-o -");
    ASSERT_EQ(piped.code, 0) << piped.err;
    EXPECT_EQ(piped.out, unstated(read(path("file.json"))));
    // The answer goes to standard error, since the file has standard output.
    EXPECT_EQ(piped.err.find("standard output: hsh order 3"), 0U) << piped.err;
    const Answer info = shell("hshfit " + job + "-o - 2>/dev/null | hshfit info - --json");
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_EQ(Json::parse(info.out)["facts"]["order"], 3);
    const Answer exr = shell("hshfit " + job + "-o exr:- 2>/dev/null | hshfit info - --json");
    ASSERT_EQ(exr.code, 0) << exr.err;
    EXPECT_EQ(Json::parse(exr.out)["facts"]["order"], 3);
}

TEST_F(Streams, FilesWithOthersBesideThemAreNotReadFromStandardInput) {
    for (const std::string line :
         {"illuminate - -o out", "plan - -o out", "transfer - -o out",
          "render lambert -o out.png --mesh -", "batch list.jsonl -o out --costs -"}) {
        const Answer answer = shell("echo '{}' | hshfit " + line);
        EXPECT_EQ(answer.code, 2) << line << answer.err;
        EXPECT_NE(answer.err.find(" -: "), std::string::npos) << answer.err;
        EXPECT_NE(answer.err.find("give a path; see hshfit help "), std::string::npos)
            << answer.err;
    }
}

TEST_F(Streams, PairsPresetsAndMeasuredFilesAreReadByTheirContent) {
    write("pairs.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0.6,0.8,0,0,1\n");
    const Answer file = run("eval lambert --pairs " + path("pairs.csv"));
    for (const std::string line : {"cat pairs.csv | hshfit eval lambert --pairs -",
                                   "hshfit eval lambert --pairs - <pairs.csv",
                                   "hshfit eval lambert --pairs=- -o - <pairs.csv"}) {
        const Answer piped = shell(line);
        EXPECT_EQ(piped.code, 0) << line << piped.err;
        EXPECT_EQ(piped.out, file.out) << line;
    }
    write("fit.json", R"({"format":"hshfit-preset","version":1,"model":"lambert",)"
                      R"("parameters":{"kd":0.25}})");
    const std::string at = " --wi 10,0 --wo 20,0";
    EXPECT_EQ(shell("cat fit.json | hshfit eval -" + at).out, run("eval lambert:kd=.25" + at).out);
    const Answer table = shell(
        "hshfit convert lambert:kd=.25 - --to merl 2>/dev/null | "
        "hshfit eval -" +
        at);
    ASSERT_EQ(table.code, 0) << table.err;
    EXPECT_NEAR(std::stod(table.out.substr(table.out.find('\t'))), 0.25 / M_PI, 1e-9);
}

TEST_F(Streams, AdviceNamesStandardInputAsItIsTyped) {
    ASSERT_EQ(run("convert ggx:alpha=.1 " + path("g.binary")).code, 0);
    const Answer poor = shell("hshfit project - --order 2 --outgoing 2 -o c.json <g.binary");
    ASSERT_EQ(poor.code, 0) << poor.err;
    EXPECT_NE(poor.err.find(": hshfit project - -o c.json --force "), std::string::npos)
        << poor.err;
}

TEST_F(Streams, OneInputMayBeNamedTwice) {
    const Answer same = shell(
        "hshfit project ggx:alpha=.5 --order 4 --outgoing 4 --cosine -o - "
        "2>/dev/null | hshfit compare - - --metrics maximum --json");
    ASSERT_EQ(same.code, 0) << same.err;
    EXPECT_EQ(Json::parse(same.out)["metrics"][0]["value"], 0.0);
}

TEST_F(Streams, ErrorsAreOneLineAndNothingHalfWrittenGoesOut) {
    EXPECT_EQ(shell("hshfit info - </dev/null").code, 3);
    EXPECT_NE(read(path("err")).find("standard input: is empty"), std::string::npos);
    EXPECT_EQ(shell("hshfit info - <&-").code, 3);
    EXPECT_EQ(shell("echo nothing | hshfit info -").code, 3);
    EXPECT_EQ(shell("hshfit project lambert -o - --json").code, 2);
    EXPECT_EQ(shell("hshfit report lambert -o -").code, 2);
    EXPECT_EQ(shell("hshfit export lambert -o - --target gltf").code, 2);
    EXPECT_EQ(shell("hshfit project lambert --outgoing 2 -o - >/dev/full").code, 5);
    // Ward's f has no coefficients at all with this variant.
    const Answer none = shell("hshfit project ward:ax=.2,ay=.5,variant=duer -o -");
    EXPECT_EQ(none.code, 4);
    EXPECT_EQ(none.out, "");
}

TEST_F(Streams, ReportWithoutAFolderPrintsItsTable) {
    const Answer report = run("report phong:exponent=5 --outgoing 20,0 --max-order 4 --cosine");
    ASSERT_EQ(report.code, 0) << report.err;
    EXPECT_NE(report.out.find("\n  hsh "), std::string::npos) << report.out;
    EXPECT_EQ(report.out.find("written to"), std::string::npos);
    EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace hshfit::test
