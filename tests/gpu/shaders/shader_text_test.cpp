#include "../asymmetric.h"
#include "runners.h"
#include "variants.h"

#include <hshfit/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>

namespace hshfit::shaders {
namespace {

using gpu::Language;
using gpu::Number;
using gpu::pack;
using gpu::Payload;
using gpu::shaderSource;
using samples::asymmetric;

Coefficients coefficients(const char* basis, int order) {
    return asymmetric(basis, order, OutgoingSet::parabolic(8, 12), Channels::rgb(), 1);
}

Payload small(const char* basis = "hsh", int order = 3) {
    return pack(coefficients(basis, order), {});
}

std::size_t countOf(const std::string& text, const std::string& pattern) {
    const std::regex expression(pattern);
    return static_cast<std::size_t>(std::distance(
        std::sregex_iterator(text.begin(), text.end(), expression), std::sregex_iterator()));
}

/// From `name(` of a definition to the brace in the margin that ends it.
std::string bodyOf(const std::string& text, const std::string& name) {
    const std::size_t first = text.find(" " + name + "(");
    return text.substr(first, text.find("\n}\n", first) - first);
}

TEST(ShaderText, LanguagesAreListedOnce) {
    std::set<std::string_view> names;
    std::set<Language> languages;
    for (const gpu::LanguageEntry& entry : gpu::languages()) {
        names.insert(entry.name);
        languages.insert(entry.language);
        EXPECT_FALSE(entry.summary.empty() || entry.extension.empty());
    }
    EXPECT_EQ(names, (std::set<std::string_view>{"glsl", "glsl-es", "hlsl", "metal", "osl", "slang",
                                                 "wgsl"}));
    EXPECT_EQ(languages.size(), gpu::languages().size());
}

TEST(ShaderText, CountsInTheHeaderAreThoseOfTheText) {
    for (Variant& variant : variants()) {
        const std::string text =
            shaderSource(Language::glsl, variant.payload, {.environmentOrder = 4});
        for (const std::string name : {"eval", "shade"}) {
            const std::string body = bodyOf(text, name == "eval" ? "hsh_evalRaw" : "hsh_shade");
            const std::regex line(name + " +(\\d+) texture fetches, (\\d+) multiply-adds");
            std::smatch said;
            ASSERT_TRUE(std::regex_search(text, said, line)) << variant.name;
            EXPECT_EQ(std::stoul(said[1]), countOf(body, "HSH_(BASIS_)?TEXEL")) << variant.name;
            // Vectors stand for several multiplications: a lower bound, and at most four of each.
            const std::size_t products = countOf(body, " \\* ") + 4 * countOf(body, "dot\\(");
            EXPECT_GE(4 * products, std::stoul(said[2])) << variant.name;
            EXPECT_LE(countOf(body, "dot\\(") * 4, std::stoul(said[2])) << variant.name;
        }
    }
}

TEST(ShaderText, OnlyStoredFunctionsAreEvaluated) {
    const std::string zernike = shaderSource(Language::glslEs, small("zernike", 6), {});
    EXPECT_EQ(countOf(bodyOf(zernike, "hsh_evalRaw"), "float b\\d+ ="), 21U);
    Coefficients c = asymmetric("hsh", 6, OutgoingSet::elevations(8), Channels::grey(), 1);
    c.bilateral = true;
    for (std::size_t p = 0; p < c.outgoing.size(); ++p)
        for (int l = 0; l < 6; ++l)
            for (int m = 1; m <= l; ++m) c.at(p, 0)[slotOf(l, -m)] = 0;
    const std::string cosines = shaderSource(Language::glslEs, pack(c, {}), {});
    EXPECT_EQ(countOf(bodyOf(cosines, "hsh_evalRaw"), "float b\\d+ ="), 21U);
}

TEST(ShaderText, NoShadeWithoutAnEnvironment) {
    for (const gpu::LanguageEntry& entry : gpu::languages()) {
        EXPECT_EQ(shaderSource(entry.language, small(), {.environmentOrder = 0}).find("_shade"),
                  std::string::npos)
            << entry.name;
    }
}

TEST(ShaderText, PrefixesKeepSnippetsApart) {
    for (const gpu::LanguageEntry& entry : gpu::languages()) {
        const std::string text = shaderSource(entry.language, small(), {.prefix = "gold7_b"});
        EXPECT_EQ(countOf(text, "\\b(hsh|HSH)_"), 0U) << entry.name;
        EXPECT_NE(text.find("gold7_b_eval("), std::string::npos) << entry.name;
    }
    for (const char* bad :
         {"", "7up", "a-b", "a__b", "a_", "gl_a", "_a", "a b", "\xc3\xa4", "a;"}) {
        EXPECT_THROW(shaderSource(Language::glsl, small(), {.prefix = bad}), UsageError) << bad;
    }
}

TEST(ShaderText, NamesFromFilesCannotLeaveTheComment) {
    Payload payload = small();
    payload.head.source = "a\nint broken;\r\n\\\n*/ \xe2\x80\xa8 end \\";
    payload.head.generator = "x\\\ny";
    for (const gpu::LanguageEntry& entry : gpu::languages()) {
        const std::string text = shaderSource(entry.language, payload, {});
        const std::string first = text.substr(0, text.find('\n'));
        EXPECT_EQ(first.substr(0, 3), "// ") << entry.name;
        EXPECT_NE(first.find("broken"), std::string::npos) << entry.name;
        EXPECT_EQ(countOf(first, "\\\\"), 0U) << entry.name;
        for (const char c : first) EXPECT_TRUE(c >= 32 && c < 127) << entry.name;
        EXPECT_EQ(text.find("broken", first.size()), std::string::npos) << entry.name;
    }
}

TEST(ShaderText, UnsupportedPayloadsAndOrdersAreRefused) {
    const Coefficients c = coefficients("hsh", 3);
    EXPECT_THROW(shaderSource(Language::osl, pack(c, {.number = Number::unorm8}), {}), UsageError);
    EXPECT_THROW(shaderSource(Language::osl, pack(c, {.basisSize = 16}), {}), UsageError);
    EXPECT_THROW(shaderSource(Language::glsl, small(), {.environmentOrder = 17}), UsageError);
    EXPECT_THROW(shaderSource(Language::glsl, small(), {.environmentOrder = -1}), UsageError);
}

TEST(ShaderText, SourceIsTheSameOnASecondRun) {
    for (const gpu::LanguageEntry& entry : gpu::languages())
        EXPECT_EQ(shaderSource(entry.language, small(), {}),
                  shaderSource(entry.language, small(), {}));
}

TEST(ShaderText, FragmentShadersAreValid) {
    for (Variant& variant : variants()) {
        const ShaderJob job = makeJob(std::move(variant.payload), variant.environmentOrder);
        const std::string snippet = shaderSource(Language::glslEs, job.payload,
                                                 {.environmentOrder = job.environment.order});
        try {
            validateFragment(wrapped(Language::glslEs, job, snippet));
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            ADD_FAILURE() << variant.name << ": " << reason.what();
        }
    }
}

}  // namespace
}  // namespace hshfit::shaders
