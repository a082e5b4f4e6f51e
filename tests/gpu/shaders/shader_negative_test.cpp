#include "runners.h"
#include "variants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>

namespace hshfit::shaders {
namespace {

using gpu::Language;

/// A way to check a language; its tests have the name.
struct Way {
    std::string name;
    Language language;
    Run run;
};

std::vector<Way> ways() {
    std::vector<Way> result;
    for (const gpu::LanguageEntry& entry : gpu::languages()) {
        std::string name(entry.name);
        std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
        result.push_back({std::move(name), entry.language, runnerOf(entry.language)});
    }
    result.push_back({"glslOnOpenGl", Language::glsl, runOpenGl});
    return result;
}

ShaderJob job() {
    return makeJob(std::move(variants().front().payload), 3);
}

std::string source(const Way& way, const ShaderJob& job, const std::string& from,
                   const std::string& to) {
    const std::string snippet =
        gpu::shaderSource(way.language, job.payload, {.environmentOrder = job.environment.order});
    return wrapped(way.language, job, withFault(snippet, from, to));
}

/// Each way is a test of its own, so that one with a missing tool is skipped with a message.
class ShaderNegative : public testing::TestWithParam<Way> {
protected:
    /// The check, skipped with its reason where a tool or a device is missing.
    template <class Check>
    void onItsWay(Check check) {
        try {
            check(GetParam());
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        }
    }
};

/// Holds that a compiler or validator refuses; Missing goes on to the caller.
template <class Compile>
void expectRefused(Compile compile) {
    try {
        compile();
    } catch (const Refused&) {
        return;
    }
    ADD_FAILURE() << "accepted";
}

TEST_P(ShaderNegative, UndeclaredNamesAreRefused) {
    const ShaderJob once = job();
    onItsWay([&](const Way& way) {
        expectRefused([&] { way.run(once, source(way, once, "= wi.z;", "= undeclaredName;")); });
    });
}

TEST_P(ShaderNegative, WrongTypesAreRefused) {
    // HLSL shortens vectors to numbers.
    const Language language = GetParam().language;
    if (language == Language::hlsl || language == Language::slang) return;
    const ShaderJob once = job();
    onItsWay([&](const Way& way) {
        expectRefused([&] { way.run(once, source(way, once, "= wi.z;", "= wi;")); });
    });
}

TEST(ShaderNegativeFragment, WrongTypesAreRefused) {
    const ShaderJob once = job();
    try {
        expectRefused([&] { validateFragment(source(ways().front(), once, "= wi.z;", "= wi;")); });
    } catch (const Missing& reason) {
        GTEST_SKIP() << reason.what();
    }
}

TEST_P(ShaderNegative, WrongSignsShow) {
    const ShaderJob once = job();
    const std::vector<double> expected = reference(once);
    onItsWay([&](const Way& way) {
        const Difference right =
            compare(once, expected, way.run(once, source(way, once, "uy = s *", "uy = s *")));
        EXPECT_LE(std::max(right.eval, right.shade), 2e-6);
        const Difference eval =
            compare(once, expected, way.run(once, source(way, once, "uy = s *", "uy = -s *")));
        EXPECT_GT(eval.eval, 1e-2);
        const Difference shade =
            compare(once, expected, way.run(once, source(way, once, " e1 = ", " e1 = -")));
        EXPECT_GT(shade.shade, 1e-2);
        EXPECT_LE(shade.eval, 2e-6);
    });
}

TEST_P(ShaderNegative, MisplacedTexelsShow) {
    const ShaderJob once = job();
    const std::vector<double> expected = reference(once);
    onItsWay([&](const Way& way) {
        const auto differs = [&](const std::string& from, const std::string& to) {
            return compare(once, expected, way.run(once, source(way, once, from, to))).eval > 1e-3;
        };
        EXPECT_TRUE(differs("(uv, 1)", "(uv, 2)"));
        // The inset of a quarter more texels: half a texel at the horizon.
        EXPECT_TRUE(differs("0.46875 *", "0.484375 *"));
    });
}

/// Rows the other way round, as image loaders deliver them.
void flipRows(gpu::Texels& texels) {
    const std::size_t row = texels.bytes.size() / (texels.layers * 24);
    for (std::size_t layer = 0; layer < texels.layers; ++layer) {
        for (std::size_t y = 0; y < 12; ++y) {
            const auto at = [&](std::size_t k) {
                return texels.bytes.begin() + static_cast<std::ptrdiff_t>((layer * 24 + k) * row);
            };
            std::swap_ranges(at(y), at(y + 1), at(23 - y));
        }
    }
}

TEST_P(ShaderNegative, FlippedRowsShow) {
    ShaderJob once = job();
    const std::vector<double> expected = reference(once);
    flipRows(once.payload.coefficients);
    onItsWay([&](const Way& way) {
        const std::string same = source(way, once, "uy = s *", "uy = s *");
        EXPECT_GT(compare(once, expected, way.run(once, same)).eval, 1e-2);
    });
}

INSTANTIATE_TEST_SUITE_P(Languages, ShaderNegative, testing::ValuesIn(ways()),
                         [](const auto& entry) { return entry.param.name; });

}  // namespace
}  // namespace hshfit::shaders
