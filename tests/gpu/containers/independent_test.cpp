// Exported files as others read them: OpenEXR's and OpenImageIO's tools, ktx-parse, JavaScript, a C
// compiler, and numpy by the documented layout. Each is skipped with a message if its tool is
// absent.

#include "container_samples.h"
#include "places.h"

#include <hshfit/files/checksum.h>

#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

namespace hshfit::gpu {
namespace {

using Json = nlohmann::json;
using samples::contentOf;
using samples::Folder;
using test::exportTo;
using test::Sample;
using test::samplePayloads;

const std::string here = test::sourceFolder() + "/tests/gpu/containers/";

struct Answer {
    int code = -1;
    std::string out;
};

Answer answerOf(const std::string& command) {
    Answer answer;
    std::FILE* pipe = ::popen(command.c_str(), "r");
    if (!pipe) return answer;
    char block[4096];
    while (const std::size_t n = std::fread(block, 1, sizeof block, pipe)) {
        answer.out.append(block, n);
    }
    answer.code = WEXITSTATUS(::pclose(pipe));
    return answer;
}

bool have(const std::string& command) {
    return answerOf(command + " >/dev/null 2>&1").code == 0;
}

std::string quoted(const std::string& path) {
    return fmt::format("'{}'", path);
}

std::string bytesOf(const Texels& texels) {
    return {reinterpret_cast<const char*>(texels.bytes.data()), texels.bytes.size()};
}

/// One container of every payload of a number type, in one folder.
struct Exported {
    Exported(const char* container, Number number) : samples(samplePayloads(number)) {
        for (std::size_t i = 0; i < samples.size(); ++i) {
            names.push_back(fmt::format("sample{}", i));
            const auto written =
                exportTo(folder.path(), samples[i].payload, {container}, {}, names.back());
            paths.push_back(folder / written[0].path);
        }
    }
    std::string arguments() const {
        std::string text;
        for (const std::string& path : paths) text += fmt::format(" '{}'", path);
        return text;
    }
    /// Whether PATH + suffix holds the texels, for each of the files.
    void expectTexelsIn(const std::string& suffix) const {
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const Texels& texels = samples[i].payload.coefficients;
            EXPECT_TRUE(contentOf(paths[i] + suffix) == bytesOf(texels)) << samples[i].what;
        }
    }

    Folder folder;
    std::vector<Sample> samples;
    std::vector<std::string> names, paths;
};

/// One JSON document a line.
std::vector<Json> documents(const std::string& text, std::size_t count) {
    std::vector<Json> result;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) result.push_back(Json::parse(line));
    EXPECT_EQ(result.size(), count);
    result.resize(count);
    return result;
}

TEST(IndependentReaders, NumpyEvaluatesTheTestsFromBinAndSidecar) {
    if (!have("/usr/bin/python3 -c 'import numpy'")) GTEST_SKIP() << "no python3-numpy";
    for (const Number number : test::numbers) {
        const Exported exported("bin", number);
        std::string sidecars;
        std::size_t count = 0;
        for (std::size_t i = 0; i < exported.samples.size(); ++i) {
            if (exported.samples[i].payload.head.basis != "hsh") continue;
            sidecars += fmt::format(" '{}'", exported.folder / (exported.names[i] + ".hsh.json"));
            ++count;
        }
        EXPECT_EQ(count, 5U);
        const Answer answer = answerOf("/usr/bin/python3 " + here + "read_sums.py" + sidecars);
        ASSERT_EQ(answer.code, 0);
        std::istringstream differences(answer.out);
        // Directions are unit vectors in single precision only: z and x^2 + y^2 tell 1 - z apart by
        // 6e-8, and the two programs take it from one or the other.
        for (double difference; differences >> difference; --count) EXPECT_LE(difference, 1e-6);
        EXPECT_EQ(count, 0U);
    }
}

TEST(IndependentReaders, NumpyReadsDdsAndTensorFiles) {
    if (!have("/usr/bin/python3 -c 'import numpy'")) GTEST_SKIP() << "no python3-numpy";
    for (const char* container : {"dds", "tensor"}) {
        for (const Number number : test::numbers) {
            SCOPED_TRACE(container + numberName(number));
            const Exported exported(container, number);
            EXPECT_TRUE(have("/usr/bin/python3 " + here + "read_raw.py " + container +
                             exported.arguments()));
            exported.expectTexelsIn(".raw");
        }
    }
}

TEST(IndependentReaders, OpenImageIoReadsEveryPixel) {
    if (!have("oiiotool --help")) GTEST_SKIP() << "no oiiotool (package openimageio-tools)";
    if (!have("/usr/bin/python3 -c 'import numpy'")) GTEST_SKIP() << "no python3-numpy";
    for (const char* container : {"exr", "exr-parts"}) {
        const Exported exported(container, Number::float16);
        // one after the other into one text
        const std::string text = exported.folder / "text";
        EXPECT_EQ(
            std::system(
                fmt::format("oiiotool -a --dumpdata{} >'{}'", exported.arguments(), text).c_str()),
            0);
        EXPECT_TRUE(have("/usr/bin/python3 " + here + "read_raw.py oiio " + quoted(text)));
        std::string wanted;
        for (const Sample& sample : exported.samples) {
            wanted += bytesOf(sample.payload.coefficients);
        }
        EXPECT_TRUE(contentOf(text + ".raw") == wanted) << container;
    }
}

TEST(IndependentReaders, ExrheaderSaysWhatWasWritten) {
    if (!have("command -v exrheader")) GTEST_SKIP() << "no exrheader (package openexr)";
    for (const auto& [number, type] :
         {std::pair{Number::float16, "16-bit"}, std::pair{Number::float32, "32-bit"}}) {
        const Payload payload = samplePayloads(number)[0].payload;
        const Texels& texels = payload.coefficients;
        const Folder folder;
        exportTo(folder.path(), payload, {"exr", "exr-parts"});
        const std::string strip =
            answerOf("exrheader " + quoted(folder / "sample.coef.strip.exr")).out;
        const auto window = "dataWindow (type box2i): (0 0) - (" +
                            std::to_string(texels.width - 1) + " " +
                            std::to_string(texels.layers * 8 - 1) + ")";
        for (const std::string& line :
             {window, std::string("R, ") + type + " floating-point, sampling 1 1",
              std::string("compression (type compression): zip"),
              std::string("hshfit:order (type string): \"4\"")}) {
            EXPECT_NE(strip.find(line), std::string::npos) << line << "\n" << strip.substr(0, 900);
        }
        const std::string parts =
            answerOf("exrheader " + quoted(folder / "sample.coef.parts.exr")).out;
        const std::string last = "part " + std::to_string(texels.layers - 1);
        EXPECT_NE(parts.find(last), std::string::npos) << parts.substr(0, 900);
    }
}

TEST(IndependentReaders, KtxParseReadsEveryKtx2) {
    if (!have("node --version")) GTEST_SKIP() << "no node (package nodejs)";
    if (!have("test -d " + test::sourceFolder() + "/tests/gpu/node_modules/ktx-parse")) {
        GTEST_SKIP() << "no ktx-parse (npm ci in tests/gpu)";
    }
    for (const Number number : test::numbers) {
        const Exported exported("ktx2", number);
        const Answer answer = answerOf("node " + here + "read_ktx2.mjs" + exported.arguments());
        ASSERT_EQ(answer.code, 0);
        exported.expectTexelsIn(".raw");
        const auto said = documents(answer.out, exported.samples.size());
        for (std::size_t i = 0; i < said.size(); ++i) {
            const Texels& texels = exported.samples[i].payload.coefficients;
            constexpr int vulkanFormats[] = {97, 109, 91, 37};  // Vulkan 1.3, VkFormat
            Json wanted = {{"vkFormat", vulkanFormats[static_cast<int>(number)]},
                           {"typeSize", numberBytes(number)},
                           {"pixelWidth", texels.width},
                           {"pixelHeight", texels.height},
                           {"pixelDepth", 0},
                           {"layerCount", texels.layers},
                           {"faceCount", 1},
                           {"levels", 1},
                           {"scheme", 0},
                           {"colorModel", 1},        // RGBSDA
                           {"colorPrimaries", 0},    // unspecified
                           {"transferFunction", 1},  // linear
                           {"bytesPlane0", 4 * numberBytes(number)},
                           {"samples", 4},
                           {"orientation", "rd"}};
            wanted["sidecar"] = said[i]["sidecar"];
            EXPECT_EQ(said[i], wanted);
            const Json sidecar = Json::parse(said[i]["sidecar"].get<std::string>());
            EXPECT_EQ(sidecar["data"]["sha256"], sha256(texels.bytes));
        }
    }
}

TEST(IndependentReaders, JavaScriptImportsTheModule) {
    if (!have("node --version")) GTEST_SKIP() << "no node (package nodejs)";
    constexpr const char* types[] = {"Uint16Array", "Float32Array", "Uint16Array", "Uint8Array"};
    for (const Number number : test::numbers) {
        const Exported exported("js", number);
        const Answer answer = answerOf("node " + here + "read_js.mjs" + exported.arguments());
        ASSERT_EQ(answer.code, 0);
        exported.expectTexelsIn(".raw");
        const auto said = documents(answer.out, exported.samples.size());
        for (std::size_t i = 0; i < said.size(); ++i) {
            EXPECT_EQ(said[i]["metadata"]["source"]["brdf"],
                      exported.samples[i].payload.head.source);
            EXPECT_EQ(said[i]["type"], types[static_cast<int>(number)]);
        }
    }
}

TEST(IndependentReaders, CompilersTakeTheHeader) {
    if (!have("cc --version") || !have("c++ --version")) GTEST_SKIP() << "no cc or c++";
    for (const Number number : test::numbers) {
        const Exported exported("h", number);
        std::string source = "#include <stdio.h>\n", body;
        for (std::size_t i = 0; i < exported.paths.size(); ++i) {
            const std::string array = exported.names[i] + "_coef";
            source += "#include \"" + exported.paths[i] + "\"\n";
            body += "  f = fopen(\"" + exported.paths[i] + ".raw\", \"wb\");\n  fwrite(" + array +
                    ", 1, sizeof " + array + ", f);\n  fclose(f);\n  layers += " + array +
                    "_layers;\n";
        }
        samples::put(exported.folder / "main.c", source +
                                                     "int main(void) {\n  int layers = 0;\n  "
                                                     "FILE* f;\n" +
                                                     body + "  return layers;\n}\n");
        std::size_t layers = 0;
        for (const Sample& sample : exported.samples) layers += sample.payload.coefficients.layers;
        ASSERT_LT(layers, 256U) << "an exit code";
        for (const char* compiler : {"cc -std=c99 -x c", "c++ -std=c++20 -x c++"}) {
            ASSERT_TRUE(have(std::string(compiler) +
                             " -Wall -Wextra -Werror -Wno-unused-variable "
                             "-Wno-unused-const-variable " +
                             quoted(exported.folder / "main.c") + " -o " +
                             quoted(exported.folder / "main")));
            EXPECT_EQ(answerOf(quoted(exported.folder / "main")).code, static_cast<int>(layers));
            exported.expectTexelsIn(".raw");
        }
    }
}

}  // namespace
}  // namespace hshfit::gpu
