#include "places.h"
#include "program.h"
#include "unstated.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

class Export : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        ASSERT_EQ(run("project ward:ax=.3,ay=.5,kd=.1/.2/.3 --order 4 --outgoing 12x8 -o " +
                      path("ward.json"))
                      .code,
                  0);
    }

    std::map<std::string, std::string> filesOf(const std::string& folder) const {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::directory_iterator(path(folder)))
            files[entry.path().filename()] = read(entry.path());
        return files;
    }
};

TEST_F(Export, EveryTargetIsWrittenAndListed) {
    const Answer answer =
        run("export " + path("ward.json") + " -o " + path("all") + " --target all --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export"));
    const Json document = Json::parse(answer.out);
    const auto files = filesOf("all");
    std::set<std::string> named, targets;
    for (const Json& file : document["files"]) {
        named.insert(file["path"].get<std::string>());
        if (file.contains("target")) targets.insert(file["target"].get<std::string>());
        ASSERT_TRUE(files.contains(file["path"])) << file;
        EXPECT_FALSE(files.at(file["path"]).empty()) << file;
        if (file.contains("bytes")) {
            EXPECT_EQ(files.at(file["path"]).size(), file["bytes"]);
        }
    }
    EXPECT_EQ(named.size(), files.size()) << "a file that is not listed, or twice";
    const std::set<std::string> ofOtherSources = {"renderer", "material", "mips"};
    // Files of engines that take no textures are left out, with a note.
    const std::map<std::string, std::string> noted = {{"filament", "ward.mat:"},
                                                      {"godot3", "ward_godot3.shader:"}};
    for (const Json all = Json::parse(run("list targets --json").out);
         const Json& row : all["targets"]) {
        const std::string name = row["name"];
        if (ofOtherSources.contains(row["kind"]) || targets.contains(name)) continue;
        ASSERT_TRUE(noted.contains(name)) << name << " is neither written nor noted";
        EXPECT_NE(answer.err.find("left out: " + noted.at(name)), std::string::npos) << answer.err;
    }
    // 16 functions of 3 channels, 4 a layer, 12 x 8 texels of 4 halves.
    EXPECT_EQ(document["layers"], 12);
    EXPECT_EQ(document["texel_bytes"], 12 * 12 * 8 * 4 * 2);
}

TEST_F(Export, ViewersCarryTheLightsThatAreGiven) {
    const std::string job = "export " + path("ward.json") + " -o " + path("lit") + " --json ";
    const Answer answer = run(job +
                              "--target viewer --light sun:elevation=40 --light "
                              "'sky:type=5+panel:width=20'");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export"));
    const Json lights = Json::parse(answer.out)["lights"];
    ASSERT_EQ(lights.size(), 2u);
    EXPECT_EQ(lights[1]["light"], "sky:type=5+panel:width=20");
    EXPECT_EQ(lights[0]["picture_bytes"], 256 * 128 * 4);
    const std::string page = read(path("lit/ward_viewer.html"));
    EXPECT_NE(page.find("sun:elevation=40"), std::string::npos);
    EXPECT_EQ(run(job + "--target glsl --light uniform").code, 2);
    EXPECT_EQ(run(job + "--target viewer --light moon --force").code, 2);
    EXPECT_EQ(run(job + "--target viewer --light absent.hdr --force").code, 3);
}

TEST_F(Export, SameBytesFromRunToRunWhateverTheThreads) {
    const std::string job = "export " + path("ward.json") +
                            " --basis-textures 16 --target "
                            "bin,exr,exr-parts,ktx2,dds,js,h,tensor,glsl-es,hlsl,wgsl,viewer ";
    ASSERT_EQ(run(job + "--threads 1 -o " + path("a")).code, 0);
    ASSERT_EQ(run(job + "--threads 2 -o " + path("b")).code, 0);
    const auto a = filesOf("a"), b = filesOf("b");
    ASSERT_EQ(a.size(), b.size());
    for (const auto& [name, bytes] : a) EXPECT_TRUE(b.at(name) == bytes) << name;
}

TEST_F(Export, FilesThatStandAreKeptUnlessForced) {
    const std::string job =
        "export " + path("ward.json") + " --no-error --target bin,hlsl -o " + path("out");
    ASSERT_EQ(run(job).code, 0);
    write("out/ward_hsh.hlsl", "mine");
    const auto before = filesOf("out");
    const Answer refused = run(job + " --number float32");
    EXPECT_EQ(refused.code, 5);
    EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
    EXPECT_EQ(filesOf("out"), before);
    EXPECT_EQ(run(job + " --force").code, 0);
    EXPECT_NE(filesOf("out").at("ward_hsh.hlsl"), "mine");
}

TEST_F(Export, NothingIsHalfWritten) {
    write("file", "");
    expectError("export " + path("ward.json") + " -o " + path("file"), 5, "file", 2);
    expectError("export " + path("ward.json") + " -o /dev/null/folder", 5, "/dev/null", 2);
    // A limit of 8 blocks of 512 bytes stands for a full disk.
    const std::string job = "ulimit -f 8; " + test::program() + " export " + path("ward.json") +
                            " --no-error --target bin,exr,glsl -o " + path("full") + " 2>" +
                            path("message");
    EXPECT_EQ(WEXITSTATUS(std::system(job.c_str())), 5);
    EXPECT_FALSE(fs::exists(path("full"))) << "the folder was made for these files alone";
    const std::string message = read(path("message"));
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 1) << message;
}

TEST_F(Export, ImpossibleExportsAreReported) {
    const std::string job = "export " + path("ward.json") + " -o " + path("out");
    expectError(job + " --target vrml", 2, "known: all, bin", 1);
    expectError("export ggx:alpha=.3 -o " + path("out") + " --target three", 3,
                "expected a file of coefficients", 1);
    expectError(job + " --number float8", 2, "float16", 1);
    expectError(job + " --chroma-order 9", 2, "1 to 4", 1);
    expectError(job + " --no-error --target exr --number unorm8", 2, "exr", 1);
    expectError(job + " --source absent.binary", 3, "absent.binary", 1);
    expectError("export lambert -o " + path("out"), 3, "lambert", 1);
    expectError("export " + path("absent.json") + " -o " + path("out"), 3, "absent.json", 1);
}

TEST_F(Export, AllLeavesOutImpossibleTargetsAndReportsThem) {
    const Answer answer = run("export " + path("ward.json") + " --no-error --target all --json " +
                              "--number unorm8 --basis-textures 8 -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    for (const char* left : {"exr cannot hold unorm8", "exr-parts", "OSL"})
        EXPECT_NE(answer.err.find(left), std::string::npos) << answer.err;
    const auto files = filesOf("out");
    EXPECT_TRUE(files.contains("ward.coef.ktx2"));
    EXPECT_FALSE(files.contains("ward.coef.strip.exr"));
    EXPECT_EQ(Json::parse(answer.out)["files"].size(), files.size());
}

TEST_F(Export, ErrorsAreSplitAndFollowThePrecision) {
    const auto errors = [&](const std::string& number) {
        return Json::parse(run("export " + path("ward.json") + " --json --target bin --force -o " +
                               path("out") + " --number " + number)
                               .out)["fit_error"];
    };
    const Json half = errors("float16"), byte = errors("unorm8");
    EXPECT_EQ(half["truncation"], byte["truncation"]);
    EXPECT_EQ(half["interpolation"], byte["interpolation"]);
    EXPECT_LT(half["quantisation"].get<double>(), std::ldexp(1, -10));
    EXPECT_GT(byte["quantisation"].get<double>(), 5 * half["quantisation"].get<double>());
}

TEST_F(Export, AMissingSourceIsReported) {
    Json document = Json::parse(read(path("ward.json")));
    document["source"]["brdf"] = "gone.binary";
    write("gone.json", document.dump());
    const Answer answer =
        run("export " + path("gone.json") + " --json --target bin -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export"));
    const std::string reason = Json::parse(answer.out)["fit_error"]["reason"];
    EXPECT_NE(reason.find("gone.binary"), std::string::npos) << reason;
    EXPECT_NE(reason.find("--source"), std::string::npos) << reason;
}

class ExportForm : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        ASSERT_EQ(run("project ward:ax=.4,ay=.4,kd=.1/.2/.3 --form halfway --halfway 5,3,2 "
                      "--precision half -o " +
                      path("form.json"))
                      .code,
                  0);
    }
};

TEST_F(ExportForm, HalfwayIsExportedAsItIsAndImportedByteByByte) {
    const Answer answer = run("export " + path("form.json") + " -o " + path("out") +
                              " --target bin,ktx2,glsl,hlsl,wgsl --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export"));
    const Json document = Json::parse(answer.out);
    EXPECT_EQ(document["form"], "halfway");
    // Nothing was rounded.
    EXPECT_EQ(document["fit_error"]["mean_log"], document["fit_error"]["file"]);
    EXPECT_TRUE(keepsSchema(read(path("out/form.hsh.json")), "gpu_form"));
    EXPECT_TRUE(keepsSchema(read(path("out/form_test.json")), "gpu_test"));
    for (const char* file : {"form.hsh.json", "form.coef.ktx2", "form.coef.f16.bin"}) {
        const Answer again =
            run("import " + path("out") + "/" + file + " --force --json -o " + path("again.json"));
        ASSERT_EQ(again.code, 0) << again.err;
        EXPECT_TRUE(keepsSchema(again.out, "import"));
        EXPECT_EQ(unstated(read(path("again.json"))), unstated(read(path("form.json")))) << file;
    }
    // A file of the export is a BRDF like the coefficient file.
    const auto value = [&](const std::string& file) {
        return run("eval " + path(file) + " --wi 30,20 --wo 50,200").out;
    };
    EXPECT_EQ(value("out/form.coef.ktx2"), value("form.json"));
}

/// Modules with nothing beside them but sidecar, triples and what says how each is bound. They
/// begin with a word, 07230203, and the version 1.3.
TEST_F(ExportForm, SpirvStandsAlone) {
    const std::string command = "export " + path("form.json") + " --target spirv --prefix paint" +
                                " --json -o " + path("out");
    const Answer answer = run(command);
    if (answer.err.find("needs glslang") != std::string::npos) GTEST_SKIP() << answer.err;
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export"));
    const Json document = Json::parse(answer.out);
    EXPECT_TRUE(document.contains("proposal"));
    std::vector<std::string> functions;
    ASSERT_EQ(document["files"].size(), 2u + 2 * 3);
    for (std::size_t k = 2; k < 8; k += 2) {
        const Json module = document["files"][k], bindings = document["files"][k + 1];
        EXPECT_EQ(module["role"], "binary");
        EXPECT_EQ(bindings["role"], "bindings");
        EXPECT_EQ(module["target"], "spirv");
        const std::string file = module["path"], text = read(path("out/" + file + ".json"));
        EXPECT_EQ(bindings["path"], file + ".json");
        EXPECT_TRUE(keepsSchema(text, "spirv"));
        const Json stated = Json::parse(text);
        functions.push_back(stated["function"]);
        EXPECT_EQ(stated["module"]["path"], file);
        const std::string bytes = read(path("out/" + file));
        EXPECT_EQ(bytes.size(), stated["module"]["bytes"]);
        EXPECT_EQ(bytes.size() % 4, 0u);
        EXPECT_EQ(bytes.substr(0, 8), std::string("\x03\x02\x23\x07\0\3\1\0", 8));
    }
    EXPECT_EQ(functions, (std::vector<std::string>{"eval", "sample", "pdf"}));
    EXPECT_EQ(document["files"][2]["path"], "form_paint.spv");

    const Answer alone = run(command + " --no-sampling --force");
    ASSERT_EQ(alone.code, 0) << alone.err;
    EXPECT_EQ(Json::parse(alone.out)["files"].size(), 4u);
}

/// Factored, sparse and with a Lambert term split off: as they are, and the same again.
TEST_F(ExportForm, FactoredSparseAndSplitFormsAreExportedAsTheyAre) {
    const std::string material = "project ward:ax=.4,ay=.4,kd=.1/.2/.3 ";
    for (const char* options :
         {"--form basis --order 6 --rank 2", "--form basis --order 6 --rank 2 --reciprocal",
          "--form basis --order 4 --keep 20 --precision half",
          "--form halfway --halfway 5,3,2 --split diffuse"}) {
        ASSERT_EQ(run(material + options + " --force -o " + path("one.json")).code, 0) << options;
        const Answer answer = run("export " + path("one.json") + " -o " + path("out") +
                                  " --target bin,glsl,osl --force --json --allow-loss");
        ASSERT_EQ(answer.code, 0) << options << answer.err;
        EXPECT_TRUE(Json::parse(answer.out).contains("form")) << options;
        EXPECT_TRUE(keepsSchema(read(path("out/one.hsh.json")), "gpu_form")) << options;
        const Answer again =
            run("import " + path("out/one.hsh.json") + " --force -o " + path("again.json"));
        ASSERT_EQ(again.code, 0) << options << again.err;
        EXPECT_EQ(unstated(read(path("again.json"))), unstated(read(path("one.json")))) << options;
        const Answer info = run("info " + path("out/one.hsh.json") + " --json");
        EXPECT_EQ(Json::parse(info.out)["facts"]["container"], "bin") << options;
    }
}

TEST_F(ExportForm, ALossOfMoreThanTwiceTheErrorIsRefusedUnlessAccepted) {
    const std::string anew = "export " + path("form.json") + " -o " + path("out") +
                             " --target bin --basis hsh --order 1 --outgoing 2";
    const Answer refused = run(anew);
    EXPECT_EQ(refused.code, 4);
    EXPECT_NE(refused.err.find("leave out --outgoing, or accept it with --allow-loss"),
              std::string::npos)
        << refused.err;
    EXPECT_FALSE(fs::exists(path("out/form.hsh.json")));
    EXPECT_EQ(run(anew + " --allow-loss").code, 0);
}

/// Lambert is exact but for the rounding of float16, which is many times the error of its file.
TEST_F(ExportForm, RoundingAloneIsNoLoss) {
    ASSERT_EQ(run("project lambert --form halfway --halfway 4,3,2 -o " + path("even.json")).code,
              0);
    const Answer answer =
        run("export " + path("even.json") + " -o " + path("out") + " --target bin --outgoing 8");
    EXPECT_EQ(answer.code, 0) << answer.err;
}

/// A file of which the split leaves nothing is read like any other.
TEST_F(ExportForm, AFileWithoutANumberIsExported) {
    const std::string file = path("split.json");
    ASSERT_EQ(run("project lambert --order 3 --outgoing 8 --split diffuse -o " + file).code, 0);
    const Answer value = run("eval " + file + " --wi 30,20 --wo 50,200 --json");
    ASSERT_EQ(value.code, 0) << value.err;
    EXPECT_NEAR(Json::parse(value.out)["values"][0].get<double>(), 1 / M_PI, 1e-7) << value.out;
    EXPECT_EQ(run("export " + file + " -o " + path("out") + " --target bin").code, 0);
}

TEST_F(ExportForm, OptionsOfOutgoingCoefficientsAreRefused) {
    for (const char* option : {" --packing rgb", " --chroma", " --basis-textures 16",
                               " --basis esh", " --order 5", " --environment-order 3"}) {
        const Answer answer = run("export " + path("form.json") + " -o " + path("out") + option);
        EXPECT_EQ(answer.code, 2) << option;
        EXPECT_NE(answer.err.find("--outgoing"), std::string::npos) << answer.err;
    }
}

/// A file of HSH gave HSH, whatever basis was asked for.
TEST_F(ExportForm, BasisAndOrderAreOfTheFormHalfwayAlone) {
    ASSERT_EQ(run("project lambert --order 3 --outgoing 8 -o " + path("plain.json")).code, 0);
    for (const char* option : {" --basis sh", " --order 2", " --outgoing 4 --basis sh"}) {
        const Answer answer =
            run("export " + path("plain.json") + " --target bin -o " + path("out") + option);
        EXPECT_EQ(answer.code, 2) << option;
        EXPECT_NE(answer.err.find("has hsh of order 3, which an export keeps"), std::string::npos)
            << answer.err;
    }
}

}  // namespace
}  // namespace hshfit::test
