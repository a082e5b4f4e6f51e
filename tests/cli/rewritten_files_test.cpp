// JSON files that another tool has written again, with other spaces and another order of keys, and
// maps of exports: the commands read them as they read the files of the program.

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <fstream>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

const std::string at = " --wi 30,170 --wo 20,10";

class RewrittenFiles : public Cli {
protected:
    /// The file with sorted keys, indented and with a space before each colon.
    void rewrite(const std::string& from, const std::string& to) const {
        const std::string text = Json::parse(read(path(from))).dump(3);
        std::string wide;
        for (std::size_t k = 0; k < text.size(); ++k) {
            if (text.compare(k, 2, "\":") == 0 && text[k + 2] == ' ') {
                wide += "\" :";
                ++k;
            } else {
                wide += text[k];
            }
        }
        write(to, wide);
    }
    std::string valuesOf(const std::string& spec) const {
        const Answer answer = run("eval " + path(spec) + at);
        EXPECT_EQ(answer.code, 0) << spec << answer.err;
        return answer.out;
    }
    void makeMap(const std::string& more, const std::string& options) const {
        std::ofstream file(path("n.pfm"), std::ios::binary);
        file << "PF\n4 4\n-1.0\n";
        for (int k = 0; k < 48; ++k) {
            const float v = k % 3 == 2 ? 0.9F : 0.05F * static_cast<float>(k % 7);
            file.write(reinterpret_cast<const char*>(&v), sizeof v);
        }
        file.close();
        write("d.json",
              R"({"format": "hshfit-svbrdf", "version": 1, "model": "ggx", )" + more + "}");
        const Answer answer =
            run("svbrdf " + path("d.json") + " -o " + path("map") + " --force " + options);
        ASSERT_EQ(answer.code, 0) << answer.err;
    }
};

const std::pair<std::string, std::string> maps[] = {
    {R"("parameters": {"alpha": 0.3, "kd": 0.2}, )"
     R"("normal": {"map": "n.pfm", "lengths": "renormalise"})",
     "--form harmonics --harmonics 9 --checks 0"},
    {R"("parameters": {"alpha": 0.3, "kd": 0.2}, )"
     R"("normal": {"map": "n.pfm", "lengths": "renormalise"})",
     "--form ellipse --checks 0"},
    {R"("parameters": {"alpha": 0.3, "kd": {"map": "n.pfm"}})", "--form outgoing --checks 0"},
    {R"("parameters": {"alpha": 0.3, "kd": {"map": "n.pfm"}})", "--form low-rank --checks 0"},
    {R"("parameters": {"alpha": 0.3, "kd": {"map": "n.pfm"}})", "--form clusters --checks 0"},
    {R"("parameters": {"alpha": 0.3, "kd": {"map": "n.pfm"}})",
     "--form library --components 3 --checks 0"}};

TEST_F(RewrittenFiles, AreReadWithEveryForm) {
    ASSERT_EQ(run("project phong:exponent=5 --outgoing 64 --order 10 -o " + path("c.json")).code,
              0);
    ASSERT_EQ(run("project phong:exponent=5 --form halfway -o " + path("h.json")).code, 0);
    ASSERT_EQ(run("gaussians ggx:alpha=.4 -o " + path("g.json")).code, 0);
    ASSERT_EQ(run("export " + path("c.json") + " -o " + path("x") + " --target bin").code, 0);
    for (const std::string& name : {std::string("c.json"), std::string("h.json"),
                                    std::string("g.json"), std::string("x/c.hsh.json")}) {
        const std::string before = valuesOf(name);
        rewrite(name, name);
        EXPECT_EQ(valuesOf(name), before) << name;
    }
    ASSERT_EQ(run("light sky:type=12,elevation=40,radiance=1 -o " + path("l.json")).code, 0);
    rewrite("l.json", "l.json");
    EXPECT_EQ(run("rotate " + path("l.json") + " -o " + path("r.json") + " --axis 0,1,0,30").code,
              0);
}

TEST_F(RewrittenFiles, AreReadWithMapsOfEveryForm) {
    for (const auto& [description, options] : maps) {
        makeMap(description, options);
        rewrite("map/material.json", "map/again.json");
        for (const std::string texel : {":x=1,y=2,level=0", ":x=1,y=0,level=1"})
            EXPECT_EQ(valuesOf("map/again.json" + texel), valuesOf("map/material.json" + texel))
                << options;
    }
}

TEST_F(RewrittenFiles, WithNumbersWhoseProductsOverflowAreRefused) {
    for (const auto& [description, options] : maps) {
        makeMap(description, options);
        Json json = Json::parse(read(path("map/material.json")));
        for (const double value : {1e300, -1e300}) {
            if (json.contains("shapes")) json["shapes"][0][0] = value;
            if (json.contains("terms")) json["terms"][0]["scales"][0] = value;
            write("map/huge.json", json.dump());
            const Answer answer = run("eval " + path("map/huge.json:x=1,y=1") + at);
            const bool stated = json.contains("shapes") || json.contains("terms");
            EXPECT_EQ(answer.code, stated ? 3 : 0) << options << answer.out;
            EXPECT_EQ(answer.err.find("at most 1e+100") != std::string::npos, stated);
        }
    }
}

TEST_F(RewrittenFiles, SidecarsOfExportedMapsOpenTexelsAsTheMapDoes) {
    for (const auto& [description, options] : maps) {
        makeMap(description, options);
        const std::string out = " -o " + path("out") + " --force --target ";
        ASSERT_EQ(run("export " + path("map/material.json") + out + "ktx2").code, 0);
        for (const std::string texel : {":x=1,y=2,level=0", ":x=1,y=0,level=1"})
            EXPECT_EQ(valuesOf("out/material.hsh.json" + texel),
                      valuesOf("map/material.json" + texel))
                << options;
        EXPECT_TRUE(keepsSchema(
            read(path("out/material.hsh.json")),
            options.starts_with("--form harmonics") || options.starts_with("--form ellipse")
                ? "gpu_filtered_map"
            : options.starts_with("--form library") ? "gpu_library_map"
                                                    : "gpu_map"));
        std::filesystem::remove_all(path("out"));
        ASSERT_EQ(run("export " + path("map/material.json") + out + "exr-parts").code, 0);
        const Answer answer = run("eval " + path("out/material.hsh.json:x=1,y=1") + at);
        EXPECT_EQ(answer.code, 3);
        EXPECT_NE(answer.err.find("ktx2"), std::string::npos) << answer.err;
    }
}

}  // namespace
