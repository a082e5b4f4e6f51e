// `svbrdf --form library` as a user meets it: texels against the model at the same parameters.

#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <vector>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

constexpr int width = 8, height = 4;

double alphaAt(int x, int y) {
    return static_cast<double>(static_cast<float>(0.2 + 0.04 * x + 0.05 * y));
}
double diffuseAt(int x, int y) {
    return static_cast<double>(static_cast<float>(0.1 + 0.05 * ((x * 3 + y * 5) % 8)));
}

class SvbrdfLibrary : public Cli {
protected:
    void writeMap(const std::string& name, double (*value)(int, int)) const {
        std::ofstream file(path(name), std::ios::binary);
        file << "Pf\n" << width << ' ' << height << "\n-1.0\n";
        for (int y = height; y-- > 0;) {
            for (int x = 0; x < width; ++x) {
                const auto v = static_cast<float>(value(x, y));
                file.write(reinterpret_cast<const char*>(&v), sizeof v);
            }
        }
    }
    void describe() const {
        writeMap("alpha.pfm", alphaAt);
        writeMap("kd.pfm", diffuseAt);
        write("d.json", R"({"format": "hshfit-svbrdf", "version": 1, "model": "ggx",
            "parameters": {"alpha": {"map": "alpha.pfm"}, "kd": {"map": "kd.pfm"}, "F0": 0.04}})");
    }
    Json made(const std::string& more) const {
        const Answer answer =
            run("svbrdf " + path("d.json") + " --form library --json --force " + more);
        EXPECT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "svbrdf"));
        return Json::parse(answer.out);
    }
    /// ln(f + 0.001) in directions from the mirror to grazing ones.
    std::vector<double> logs(const std::string& spec) const {
        std::vector<double> all;
        for (const char* pair :
             {"--wi 30,180 --wo 30,0", "--wi 10,40 --wo 60,0", "--wi 0,0 --wo 0,0",
              "--wi 65,170 --wo 60,0", "--wi 80,20 --wo 40,0", "--wi 45,180 --wo 35,0"}) {
            const Answer answer = run("eval " + spec + " " + pair + " --json");
            EXPECT_EQ(answer.code, 0) << answer.err;
            const Json document = Json::parse(answer.out);
            for (const double f : document["values"]) all.push_back(std::log(f + 1e-3));
        }
        return all;
    }
    static std::string model(int x, int y) {
        return fmt::format("ggx:alpha={},kd={},F0=0.04", alphaAt(x, y), diffuseAt(x, y));
    }
    std::string bytes(const std::string& file) const {
        std::ifstream stream(path(file), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
};

double farthest(const std::vector<double>& a, const std::vector<double>& b) {
    EXPECT_EQ(a.size(), b.size());
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
    return most;
}

/// The terms of libraries are off by a few percent at single pairs; a wrong texel, whose kd or
/// alpha is another, by more than a fifth.
TEST_F(SvbrdfLibrary, TexelsAreTheModelAtTheirParameters) {
    describe();
    const Json answer = made("-o " + path("m"));
    EXPECT_EQ(answer["form"], "library");
    for (const auto& [x, y] : {std::pair{0, 0}, {7, 3}, {3, 1}, {5, 2}}) {
        const std::vector<double> found =
            logs(path("m/material.json") + fmt::format(":x={},y={}", x, y));
        EXPECT_LT(farthest(found, logs(model(x, y))), 0.1) << x << ' ' << y;
        EXPECT_GT(farthest(found, logs(model((x + 1) % width, y))), 0.1) << x << ' ' << y;
    }
    EXPECT_LT(answer["levels"][0]["error"]["maximum"], 0.1);
    EXPECT_LT(answer["library"]["flip"]["maximum"], 0.1);
    EXPECT_TRUE(answer["library"]["poor"].is_null());
}

/// A texel of a level reflects the mean of what the texels below it reflect.
TEST_F(SvbrdfLibrary, LevelsAreMeansOfReflectance) {
    describe();
    made("-o " + path("m") + " --checks 0");
    const std::string mean = fmt::format("'0.25 * {} + 0.25 * {} + 0.25 * {} + 0.25 * {}'",
                                         model(4, 2), model(5, 2), model(4, 3), model(5, 3));
    EXPECT_LT(farthest(logs(path("m/material.json:x=2,y=1,level=1")), logs(mean)), 0.1);
}

TEST_F(SvbrdfLibrary, AGivenLibraryServes) {
    describe();
    made("-o " + path("m") + " --checks 0 --components 5");
    const Json answer = made("-o " + path("n") + " --components 3 --checks 1 --library " +
                             path("m/material.library"));
    EXPECT_EQ(answer["count"], 3);
    EXPECT_EQ(answer["library"]["materials"], 0);
    EXPECT_EQ(answer["choices"][0]["bytes_per_texel"],
              8 * (1 + 1));  // grey: a bound, four functions
    EXPECT_LT(farthest(logs(path("n/material.json:x=3,y=1")), logs(model(3, 1))), 0.3);
    // Copied, so that a map needs no other file.
    std::filesystem::remove_all(path("m"));
    EXPECT_EQ(run("info " + path("n/material.json:x=3,y=1")).code, 0);
    // A library with another basis is refused.
    made("-o " + path("m") + " --checks 0 --components 2");
    std::filesystem::copy_file(path("m/material.library"), path("n/material.library"),
                               std::filesystem::copy_options::overwrite_existing);
    const Answer other = run("info " + path("n/material.json:x=3,y=1"));
    EXPECT_EQ(other.code, 3);
    EXPECT_NE(other.err.find("another basis"), std::string::npos) << other.err;
}

/// The map has the same bytes as by a call without the limit.
TEST_F(SvbrdfLibrary, SecondsEndTheMeasuring) {
    describe();
    for (const auto& [form, options] :
         {std::pair<std::string, std::string>{"library", "--components 3"},
          {"low-rank", ""},
          {"halfway", "--clusters 2 --halfway 3,2,1"}}) {
        const std::string base =
            "svbrdf " + path("d.json") + " --json --form " + form + " " + options;
        const Answer answer = run(base + " --seconds 0.01 -o " + path(form));
        ASSERT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "svbrdf")) << form;
        const Json done = Json::parse(answer.out);
        EXPECT_EQ(done.value("time_over", false), true) << form;
        EXPECT_FALSE(done["levels"][1].contains("against_brdfs")) << form;
        EXPECT_FALSE(done["levels"][1].contains("against_samples")) << form;
        EXPECT_NE(answer.err.find("the map is whole, but the time was over"), std::string::npos);
        ASSERT_EQ(run(base + " --checks 0 -o " + path(form + "-whole")).code, 0);
        EXPECT_TRUE(bytes(form + "/material.ktx2") == bytes(form + "-whole/material.ktx2"));
    }
}

TEST_F(SvbrdfLibrary, SpoiltFilesAreRefusedInOneLine) {
    describe();
    made("-o " + path("m") + " --checks 0 --components 3");
    const Json whole = Json::parse(bytes("m/material.json"));
    const auto refused = [&](const std::string& what) {
        const Answer answer = run("info " + path("m/material.json:x=1,y=1"));
        EXPECT_EQ(answer.code, 3) << what << answer.out;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
    };
    const std::pair<const char*, Json> spoilt[] = {
        {"/version", 2},
        {"/channels", {"R"}},
        {"/library/components", 7},
        {"/library/components", -1},
        {"/library/file", "../m/material.library"},
        {"/library/sha256", "0"},
        {"/texture/layers", 5},
        {"/texture/number", "unorm8"},
        {"/texture/levels", Json::array()},
        {"/texture/levels/0/width", 1 << 19},
        {"/texture/file", "d.json"},
    };
    for (const auto& [place, value] : spoilt) {
        Json json = whole;
        json[Json::json_pointer(place)] = value;
        write("m/material.json", json.dump());
        refused(place);
    }
    write("m/material.json", whole.dump());
    for (const char* file : {"m/material.ktx2", "m/material.library"}) {
        const std::string all = bytes(file);
        write(file, all.substr(0, all.size() / 2));
        refused(file);
        write(file, all);
    }
    EXPECT_EQ(run("info " + path("m/material.json:x=1,y=1")).code, 0);
    EXPECT_EQ(run("info " + path("m/material.json:x=8,y=1")).code, 2);
}

/// The library goes along once, whatever the textures are for.
TEST_F(SvbrdfLibrary, ExportsTexturesForOslBesideTheOthers) {
    describe();
    made("-o " + path("m") + " --checks 0 --components 3");
    const Answer answer = run("export " + path("m/material.json") + " -o " + path("out") +
                              " --target ktx2,exr-parts,osl");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const std::string sidecar = bytes("out/material.hsh.json");
    EXPECT_TRUE(keepsSchema(sidecar, "gpu_library_map"));
    std::vector<std::string> names;
    const Json document = Json::parse(sidecar);
    for (const Json& file : document["files"]) names.push_back(file["path"]);
    EXPECT_EQ(names, (std::vector<std::string>{"material.map.exr", "material.functions.exr",
                                               "material.map.ktx2", "material.functions.ktx2",
                                               "material.library"}));
    for (const std::string& name : names)
        EXPECT_TRUE(std::filesystem::exists(path("out/" + name))) << name;
    EXPECT_NE(bytes("out/material_hsh.osl").find("float fourth"), std::string::npos);
    const Answer dark = run("export " + path("m/material.json") + " -o " + path("dark") +
                            " --target viewer --light studio");
    EXPECT_EQ(dark.code, 2) << dark.err;
    EXPECT_NE(dark.err.find("take no light of an environment"), std::string::npos) << dark.err;
}

TEST_F(SvbrdfLibrary, BytesDoNotDependOnThreadsAndMemory) {
    describe();
    made("-o " + path("a") + " --checks 0 --threads 1");
    made("-o " + path("b") + " --checks 0 --threads 2 --memory 16");
    for (const char* file : {"material.ktx2", "material.library", "errors.png"})
        EXPECT_TRUE(bytes(std::string("a/") + file) == bytes(std::string("b/") + file)) << file;
}

TEST_F(SvbrdfLibrary, WhatDoesNotGoAlongIsRefusedInOneLine) {
    describe();
    const auto refused = [&](const std::string& options, int code, const char* words) {
        const Answer answer = run("svbrdf " + path("d.json") + " -o " + path("x") + " " + options);
        EXPECT_EQ(answer.code, code) << options;
        EXPECT_NE(answer.err.find(words), std::string::npos) << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
        EXPECT_FALSE(std::filesystem::exists(path("x"))) << options;
    };
    refused("--form library --order 5", 2, "--order is for --form outgoing");
    refused("--form library --clusters 5", 2, "--clusters is for --form clusters and halfway");
    refused("--form library --error 0.1", 2, "--error is for");
    refused("--clusters 5", 2, "not for outgoing");
    refused("--form outgoing --error 0.1", 2, "not for outgoing");
    refused("--form low-rank --clusters 5", 2, "not for low-rank");
    refused("--components 5", 2, "--components is for --form library");
    refused("--form library --library " + path("d.json"), 3, "is no library of materials");
    write("d.json", R"({"format": "hshfit-svbrdf", "version": 1, "model": "ward",
        "parameters": {"ax": {"map": "alpha.pfm"}, "ay": 0.1}})");
    refused("--form library", 3, "is anisotropic");
}

}  // namespace
