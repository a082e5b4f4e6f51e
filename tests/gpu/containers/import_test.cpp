// hshfit import as a user meets it, from files that hshfit export wrote.

#include <cli/program.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

class Import : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        ASSERT_EQ(run("project ward:ax=.2,ay=.5 --order 4 --outgoing 8x8 --cosine -o " +
                      path("ward.json"))
                      .code,
                  0);
        ASSERT_EQ(run("export --no-error --target bin,exr,exr-parts,ktx2,dds,js,h,tensor " +
                      path("ward.json") + " -o " + path("out"))
                      .code,
                  0);
    }
    std::vector<std::string> exported() const {
        std::vector<std::string> files;
        for (const auto& entry : fs::directory_iterator(folder_ / "out")) {
            const std::string name = entry.path().filename();
            if (name.find(".coef.") != name.npos || name.ends_with(".hsh.json")) {
                files.push_back(entry.path());
            }
        }
        return files;
    }
};

TEST_F(Import, EveryFileGivesTheCoefficientsAgain) {
    const Json before = Json::parse(read(path("ward.json")));
    std::size_t count = 0;
    for (const std::string& file : exported()) {
        const Answer answer = run("import --json --force " + file + " -o " + path("again.json"));
        ASSERT_EQ(answer.code, 0) << file << answer.err;
        EXPECT_EQ(Json::parse(answer.out)["tests"]["largest_difference"], 0);
        const Json after = Json::parse(read(path("again.json")));
        if (count == 0) {
            EXPECT_TRUE(keepsSchema(answer.out, "import"));
            EXPECT_TRUE(keepsSchema(after.dump(), "coefficients"));
        }
        for (const char* key : {"source", "basis", "quantity", "channels", "outgoing", "symmetry",
                                "energy", "energy_error", "error", "generator"}) {
            EXPECT_EQ(before[key], after[key]) << key;
        }
        // half floats: 11 bits, 6e-8 at the least
        std::size_t marked = 0;
        for (std::size_t o = 0; o < 64; ++o) {
            for (std::size_t k = 0; k < 16; ++k) {
                const double a = before["coefficients"][o][0][k],
                             b = after["coefficients"][o][0][k];
                const bool corner = k == 0 && (o == 0 || o == 7 || o == 56 || o == 63);
                if (corner) ++marked;
                if (corner) continue;
                EXPECT_NEAR(a, b, std::abs(a) / 2048 + 3e-8) << file;
            }
        }
        EXPECT_EQ(marked, 4u);
        ++count;
    }
    EXPECT_EQ(count, 9u);
}

TEST_F(Import, ExportedFilesAreBrdfs) {
    const std::string wanted =
        run("eval " + path("out/ward.coef.f16.bin") + " --cosine --wi 20,10 --wo 30,50").out;
    EXPECT_NE(wanted, "");
    for (const std::string& file : exported()) {
        EXPECT_EQ(run("eval " + file + " --cosine --wi 20,10 --wo 30,50").out, wanted) << file;
    }
    const Answer info = run("info --json " + path("out/ward.coef.ktx2"));
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_TRUE(keepsSchema(info.out, "info"));
    EXPECT_EQ(Json::parse(info.out)["facts"]["container"], "ktx2");
}

TEST_F(Import, ErrorsAreOneLineAndLeaveNothing) {
    write("other.json", "{}");
    write("broken.ktx2", read(path("out/ward.coef.ktx2")).substr(0, 900));
    write("mine.json", "mine");
    write("map.hsh.json", R"({"format": "hshfit-gpu-map"})");
    const std::string to = " -o " + path("x.json");
    expectError("import " + path("other.json") + to, 3, "is no file of an export", 6);
    expectError("import " + path("ward.json") + to, 3, "is no file of an export", 6);
    expectError("import " + path("map.hsh.json") + to, 3, "in the format hshfit-gpu-map", 6);
    expectError("import " + path("broken.ktx2") + to, 3, "broken.ktx2", 6);
    expectError("import " + path("absent.ktx2") + to, 3, "absent.ktx2", 6);
    expectError("import " + path("out/ward.coef.ktx2") + " -o " + path("x.txt"), 2, ".json", 6);
    expectError("import " + path("out/ward.coef.ktx2") + " -o " + path("no/x.json"), 5, "no/x", 6);
    expectError("import " + path("out/ward.coef.ktx2") + " -o " + path("mine.json"), 5, "--force",
                6);
    EXPECT_EQ(read(path("mine.json")), "mine");
}

TEST_F(Import, HelpHasAnExample) {
    const Answer help = run("import --help");
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.out.find("\nExample:\n  hshfit import "), std::string::npos) << help.out;
}

}  // namespace
}  // namespace hshfit::test
