#include "runners.h"
#include "variants.h"

#include <gtest/gtest.h>

#include <functional>

namespace hshfit::shaders {
namespace {

using gpu::Language;

using Run = std::function<std::vector<float>(const ShaderJob&, const std::string&)>;

/// Where a language is checked.
struct Way {
    const char* name;
    Language language;
    Run run;
};

std::vector<Way> ways() {
    std::vector<Way> result;
    for (const gpu::LanguageEntry& entry : gpu::languages()) {
        result.push_back({entry.name.data(), entry.language,
                          [language = entry.language](const auto& job, const auto& source) {
                              return run(language, job, source);
                          }});
    }
    result.push_back({"glsl on OpenGL", Language::glsl, runOpenGl});
    return result;
}

ShaderJob job() {
    return makeJob(std::move(variants().front().payload), 3);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    return text;
}

std::string source(const Way& way, const ShaderJob& job, const std::string& from,
                   const std::string& to) {
    const std::string snippet =
        gpu::shaderSource(way.language, job.payload, {.environmentOrder = job.environment.order});
    return wrapped(way.language, job, replaced(snippet, from, to));
}

/// For every way that is here; those that are not are printed.
template <class Check>
void forEachWay(Check check) {
    for (const Way& way : ways()) {
        try {
            check(way);
        } catch (const Missing& reason) {
            std::cout << way.name << " not checked: " << reason.what() << '\n';
        }
    }
}

TEST(ShaderNegative, UndeclaredNamesAreRefused) {
    const ShaderJob once = job();
    forEachWay([&](const Way& way) {
        EXPECT_THROW(way.run(once, source(way, once, "= wi.z;", "= undeclaredName;")), Refused)
            << way.name;
    });
}

TEST(ShaderNegative, WrongTypesAreRefused) {
    const ShaderJob once = job();
    forEachWay([&](const Way& way) {
        if (way.language == Language::hlsl) return;  // where vectors shorten to numbers
        EXPECT_THROW(way.run(once, source(way, once, "= wi.z;", "= wi;")), Refused) << way.name;
    });
    try {
        EXPECT_THROW(validateFragment(source(ways().front(), once, "= wi.z;", "= wi;")), Refused);
    } catch (const Missing& reason) {
        std::cout << "fragment shader not checked: " << reason.what() << '\n';
    }
}

TEST(ShaderNegative, WrongSignsShow) {
    const ShaderJob once = job();
    const std::vector<double> expected = reference(once);
    forEachWay([&](const Way& way) {
        const Difference right =
            compare(once, expected, way.run(once, source(way, once, "uy = s *", "uy = s *")));
        EXPECT_LE(std::max(right.eval, right.shade), 2e-6) << way.name;
        const Difference eval =
            compare(once, expected, way.run(once, source(way, once, "uy = s *", "uy = -s *")));
        EXPECT_GT(eval.eval, 1e-2) << way.name;
        const Difference shade =
            compare(once, expected, way.run(once, source(way, once, " e1 = ", " e1 = -")));
        EXPECT_GT(shade.shade, 1e-2) << way.name;
        EXPECT_LE(shade.eval, 2e-6) << way.name;
    });
}

TEST(ShaderNegative, FlippedAndMisplacedTexelsShow) {
    ShaderJob once = job();
    const std::vector<double> expected = reference(once);
    forEachWay([&](const Way& way) {
        const auto differs = [&](const std::string& from, const std::string& to) {
            return compare(once, expected, way.run(once, source(way, once, from, to))).eval > 1e-3;
        };
        EXPECT_TRUE(differs("(uv, 1)", "(uv, 2)")) << way.name;
        // The inset of a quarter more texels: half a texel at the horizon.
        EXPECT_TRUE(differs("0.46875 *", "0.484375 *")) << way.name;
    });
    // Rows the other way round, as image loaders deliver them.
    auto& bytes = once.payload.coefficients.bytes;
    const std::size_t row = bytes.size() / (once.payload.coefficients.layers * 24);
    for (std::size_t layer = 0; layer < once.payload.coefficients.layers; ++layer) {
        for (std::size_t y = 0; y < 12; ++y) {
            const auto at = [&](std::size_t k) {
                return bytes.begin() + static_cast<std::ptrdiff_t>((layer * 24 + k) * row);
            };
            std::swap_ranges(at(y), at(y + 1), at(23 - y));
        }
    }
    forEachWay([&](const Way& way) {
        const std::string same = source(way, once, "uy = s *", "uy = s *");
        EXPECT_GT(compare(once, expected, way.run(once, same)).eval, 1e-2) << way.name;
    });
}

}  // namespace
}  // namespace hshfit::shaders
