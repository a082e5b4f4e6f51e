// A tensor of measured texels through `svbrdf`: samples of published models, of which the stated
// error and the coefficients are known.

#include <cli/program.h>

#include <hshfit/files/tensor_file_writer.h>

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace {

using hshfit::TensorFileWriter;
using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

struct Tensor {
    std::vector<float> incoming, outgoing, reflectance;
    std::uint64_t width = 4, height = 4, channels = 1, columns = 0;

    /// Directions on rings; f of texel and cosines of both directions.
    explicit Tensor(auto f) {
        constexpr double pi = std::numbers::pi;
        const auto add = [](std::vector<float>& to, double theta, double phi) {
            for (const double v : {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                   std::cos(theta)})
                to.push_back(static_cast<float>(v));
        };
        for (int t = 0; t < 8; ++t)
            for (int p = 0; p < 12; ++p)
                add(incoming, (t + 0.5) * pi / 16, (p + 0.5 * (t % 2)) * pi / 6);
        for (int t = 0; t < 6; ++t) add(outgoing, t * pi / 13, 0);
        for (std::uint64_t texel = 0; texel < width * height; ++texel)
            for (std::size_t o = 2; o < outgoing.size(); o += 3)
                for (std::size_t i = 2; i < incoming.size(); i += 3)
                    reflectance.push_back(static_cast<float>(
                        f(texel, static_cast<double>(incoming[i]), static_cast<double>(outgoing[o]),
                          static_cast<double>(incoming[i - 2]))));
        columns = incoming.size() / 3;
    }
    void write(const std::string& path) const {
        TensorFileWriter writer;
        writer.add("incoming", {incoming.size() / 3, 3}, incoming);
        writer.add("outgoing", {outgoing.size() / 3, 3}, outgoing);
        writer.add("reflectance", {height, width, outgoing.size() / 3, columns, channels},
                   reflectance);
        writer.write(path, hshfit::AtomicFile::Existing::replace);
    }
};

class MeasuredTexels : public Cli {
protected:
    Answer made(const std::string& more) const {
        std::ofstream(path("d.json")) << Json{{"format", "hshfit-svbrdf"},
                                              {"version", 1},
                                              {"texels", "texels.tensor"},
                                              {"isotropic", true}};
        return run("svbrdf " + path("d.json") + " --json -o " + path("out") + " " + more);
    }
    double value(const std::string& texel, double theta, double phi) const {
        const Answer answer = run("eval " + path("out/material.json") + texel + " --wi " +
                                  fmt::format("{},{}", theta, phi) + " --wo 20,0 --json");
        EXPECT_EQ(answer.code, 0) << answer.err;
        return Json::parse(answer.out)["values"][0];
    }
};

/// Lambert's f of albedo k / 16, which order 3 holds up to what the horizon's slope costs: here f
/// is a polynomial of the basis itself, 1 and cos(theta_i).
TEST_F(MeasuredTexels, PolynomialsComeBack) {
    const auto f = [](std::uint64_t texel, double cosine) {
        return 0.1 + 0.05 * static_cast<double>(texel) + 0.2 * cosine;
    };
    Tensor([&](std::uint64_t texel, double i, double, double) {
        return f(texel, i);
    }).write(path("texels.tensor"));
    const Answer answer = made("--order 3 --outgoing 4 --precision float32");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "svbrdf"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["model"], "measured");
    EXPECT_EQ(json["fit"]["texels"], 16);
    EXPECT_LT(json["fit"]["maximum"], 1e-4);
    for (const auto& [theta, phi] : {std::pair(10.0, 0.0), std::pair(55.0, 200.0)}) {
        const double cosine = std::cos(theta * std::numbers::pi / 180);
        EXPECT_NEAR(value(":x=1,y=2", theta, phi), f(9, cosine), 1e-3);
        // The mean of texels 10, 11, 14 and 15.
        EXPECT_NEAR(value(":x=1,y=1,level=1", theta, phi), f(12, cosine) + 0.025, 1e-3);
    }
}

/// A lobe that three bands do not hold is off by more than half of its norm, and one of more bands
/// by less.
TEST_F(MeasuredTexels, TheStatedErrorFallsWithTheOrder) {
    Tensor([](std::uint64_t texel, double i, double o, double x) {
        const double mirror = i * o - x * std::sqrt(1 - o * o);
        return 0.1 + (texel == 5 ? 4.0 : 1.0) * std::pow(std::max(0.0, mirror), 20);
    }).write(path("texels.tensor"));
    double before = 1;
    for (const int order : {2, 4, 6}) {
        const Answer answer = made(fmt::format("--order {} --outgoing 6 --force", order));
        ASSERT_EQ(answer.code, 0) << answer.err;
        const Json fit = Json::parse(answer.out)["fit"];
        EXPECT_LT(fit["mean"], before);
        before = fit["mean"];
        EXPECT_EQ(fit["column"], 1);
        EXPECT_EQ(fit["row"], 1);
    }
    for (const char* form : {"low-rank", "clusters --clusters 4"}) {
        const Answer answer = made(std::string("--force --form ") + form);
        EXPECT_EQ(answer.code, 0) << answer.err;
    }
}

TEST_F(MeasuredTexels, BrokenTensorsEndBeforeAnyWork) {
    const Tensor good([](std::uint64_t, double, double, double) { return 0.3; });
    const auto refused = [&](const std::string& part) {
        const Answer answer = made("--order 3 --outgoing 4");
        EXPECT_EQ(answer.code, 3) << answer.err;
        EXPECT_NE(answer.err.find(part), std::string::npos) << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
        EXPECT_FALSE(std::filesystem::exists(path("out")));
    };
    refused("texels.tensor");
    Tensor bad = good;
    const std::size_t texel = 96 * 6;
    bad.reflectance[6 * texel + 2 * 96 + 5] = NAN;
    bad.write(path("texels.tensor"));
    refused("texel (2, 1): reflectance of outgoing direction 2, incoming direction 5 is nan");
    bad.reflectance[6 * texel + 2 * 96 + 5] = -1;
    bad.write(path("texels.tensor"));
    refused("at least 0");
    bad = good;
    bad.channels = 2;
    bad.height = 2;
    bad.write(path("texels.tensor"));
    refused("has 2 channels; 1 or 3 are possible");
    bad = good;
    bad.incoming.resize(95 * 3);
    bad.write(path("texels.tensor"));
    refused("field reflectance");
    bad = good;
    bad.outgoing[2] = -1;
    bad.write(path("texels.tensor"));
    refused("field outgoing");
    good.write(path("texels.tensor"));
    std::filesystem::resize_file(path("texels.tensor"),
                                 std::filesystem::file_size(path("texels.tensor")) - 100);
    refused("field reflectance");
}

}  // namespace
