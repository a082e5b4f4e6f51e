// One shader for the materials of a library, in every language, against the library's BRDFs.

#include "../shaders/runners.h"
#include "library_sums.h"

#include <hshfit/error.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace hshfit::shaders {
namespace {

namespace ml = material_library;
using gpu::Language;

/// Ten materials, grey ones among them, in a basis of six components.
const ml::Library& library() {
    static const ml::Library made = [] {
        const ml::LogSpace space;
        std::vector<ml::Measured> measured;
        for (const char* spec :
             {"lambert:kd=.3/.2/.1", "ggx:alpha=.2,F0=.9/.6/.3", "ggx:alpha=.1,F0=.05,kd=.4/.3/.1",
              "phong:exponent=40,ks=.3,kd=.2", "oren-nayar:sigma=.5", "ggx:alpha=.5,F0=.4",
              "beckmann:alpha=.3,F0=.9/.8/.7", "charlie:r=.4", "eon:roughness=.8",
              "lambert:kd=.02/.3/.02+ggx:alpha=.3,F0=.04"})
            measured.push_back(space.project(*brdfs::open(spec),
                                             fmt::format("m{}", measured.size()), spec, false));
        ml::LearnOptions options;
        options.components = 6;
        options.bytes = 60;
        return ml::learn(space, std::move(measured), {}, options,
                         {.log = 10, .maximum = 10, .flip = 10});
    }();
    return made;
}

gpu::SharedSums sums() {
    return constantSums(library());
}

const gpu::TabledLibrary& tabled() {
    static const gpu::TabledLibrary made = gpu::tabledWithin(sums(), 0.1);
    return made;
}

/// The evaluation that the runners call, of one material.
std::string evaluationOf(Language language, std::size_t material, bool table) {
    switch (language) {
        case Language::hlsl:
        case Language::slang:
            return fmt::format(
                "\nfloat3 hsh_eval(float3 wo, float3 wi) {{ return hsh_material({}, wo, wi); }}\n",
                material);
        case Language::wgsl:
            return fmt::format(
                "\nfn hsh_eval(wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {{ return "
                "hsh_material({}, wo, wi); }}\n",
                material);
        case Language::metal:
            return fmt::format(
                "\ninline float3 hsh_eval(texture2d_array<float> coefficients, {}float3 wo, float3 "
                "wi) {{ sampler linear; return hsh_material(coefficients, {}{}, wo, wi); }}\n",
                table ? "texture2d_array<float> basis, " : "", table ? "basis, linear, " : "",
                material);
        default:
            return fmt::format(
                "\nvec3 hsh_eval(vec3 wo, vec3 wi) {{ return hsh_material({}, wo, wi); }}\n",
                material);
    }
}

/// A unit vector whose components are floats.
Direction rounded(const Direction& d) {
    const double length = std::hypot(d.x, d.y, d.z);
    const auto part = [&](double x) { return double{static_cast<float>(x / length)}; };
    return {part(d.x), part(d.y), part(d.z)};
}

/// The pairs of directionPairs(), with changes to three of every four: one has mirror directions,
/// one is within a thousandth of a radian of these, and one has wi within a tenth of a degree of
/// the horizon.
Pairs pairsWithLobes() {
    Pairs pairs = directionPairs();
    for (std::size_t k = 0; k < pairs.wi.size(); ++k) {
        const Direction &wo = pairs.wo[k], &wi = pairs.wi[k];
        if (k % 4 == 1) pairs.wi[k] = {-wo.x, -wo.y, wo.z};
        if (k % 4 == 2) pairs.wi[k] = rounded({-wo.x + 7e-4, -wo.y, wo.z});
        if (k % 4 == 3) pairs.wi[k] = rounded({wi.x, wi.y, 1.5e-3 * std::hypot(wi.x, wi.y)});
    }
    return pairs;
}

/// f of the shader for one material, [pair][channel]; the runners give all values twice.
std::vector<float> shown(Language language, const gpu::SharedSums& all, std::size_t material,
                         const Pairs& pairs) {
    ShaderJob job{{}, pairs, {.order = 0, .colours = 0, .values = {}}};
    job.payload.head.channels = Channels::rgb();
    job.payload.coefficients = gpu::materialTexels(all);
    if (all.table) job.payload.basisTexels = all.table->texels();
    job.form = "texture";
    const std::string source = gpu::libraryShaderSource(language, all, "hsh") +
                               evaluationOf(language, material, all.table != nullptr);
    const std::vector<float> both = runnerOf(language)(job, wrapped(language, job, source));
    std::vector<float> found;
    for (std::size_t k = 0; k < pairs.wo.size(); ++k)
        found.insert(found.end(), &both[6 * k], &both[6 * k] + 3);
    return found;
}

std::vector<double> valuesOf(const Brdf& brdf, const Pairs& pairs) {
    std::vector<double> values;
    for (std::size_t k = 0; k < pairs.wo.size(); ++k) {
        std::vector<double> f = evaluate(brdf, pairs.wi[k], pairs.wo[k]);
        f.resize(3, f[0]);
        values.insert(values.end(), f.begin(), f.end());
    }
    return values;
}

/// Differences relative to f + 0.01.
Wanted wantedOf(const std::vector<double>& f) {
    Wanted wanted{f, {}};
    for (const double value : f) wanted.scales.push_back(value + 0.01);
    return wanted;
}

double largestShare(const std::vector<float>& g, const std::vector<double>& f) {
    return largestDifference(wantedOf(f), g);
}

/// Keeps the shader that ran last, which writes every value twice.
void keep(Language language, const std::string& name, const std::vector<double>& f,
          const Bounds& bounds) {
    std::vector<double> both;
    for (std::size_t k = 0; k < f.size(); k += 3)
        for (std::size_t i = 0; i < 6; ++i) both.push_back(f[k + i % 3]);
    keepLast("library", language, name, wantedOf(both), bounds);
}

/// The largest |ln((g + 0.001) / (f + 0.001))| where both directions are 0.06 degrees above the
/// horizon, as gpu::TableError states it.
double largestLog(const std::vector<float>& g, const std::vector<double>& f, const Pairs& pairs) {
    double largest = 0;
    for (std::size_t n = 0; n < f.size(); ++n) {
        if (std::min(pairs.wi[n / 3].z, pairs.wo[n / 3].z) < 1e-3) continue;
        largest = std::max(largest, std::abs(std::log((double{g[n]} + 1e-3) / (f[n] + 1e-3))));
    }
    return largest;
}

/// Keeps the shader of all materials to be timed on other machines.
void keepForTimes(int place, const std::string& name, const gpu::SharedSums& all) {
    using Kind = gpu::ComputeResource::Kind;
    std::vector<gpu::ComputeResource> resources{
        {.binding = 0, .kind = Kind::sampledTexture, .texels = gpu::materialTexels(all)}};
    if (all.table)
        resources.push_back(
            {.binding = 2, .kind = Kind::sampledTexture, .texels = all.table->texels()});
    keepTimed({.place = place,
               .name = name,
               .snippet = "#define HSH_BASIS_BINDING binding = 2\n" +
                          gpu::libraryShaderSource(Language::glsl, all, "hsh"),
               .call = "hsh_material(material, wo, wi)"},
              std::move(resources));
}

// Constants are exact; so is the shader of a table against the table, and the table is as far from
// the library as it states.
void prove(Language language) {
    const gpu::SharedSums constants = sums();
    const Pairs pairs = pairsWithLobes();
    const Bounds ofConstants{2e-4, 2e-4}, ofTable{2e-3, 5e-2};
    ASSERT_EQ(constants.count(), library().materials.size());
    for (const std::size_t n : {std::size_t{0}, std::size_t{3}, constants.count() - 1}) {
        const std::string& name = library().materials[n].name;
        const std::vector<double> f =
            valuesOf(*ml::open(library(), library().materials[n], name), pairs);
        try {
            const double constant = largestShare(shown(language, constants, n, pairs), f);
            keep(language, name + ", constants", f, ofConstants);
            const std::vector<float> found = shown(language, tabled().sums, n, pairs);
            const std::vector<double> looked = valuesOf(gpu::TabledBrdf(tabled().sums, n), pairs);
            keep(language, name + ", table", looked, ofTable);
            const double table = largestShare(found, looked), log = largestLog(found, f, pairs);
            std::cout << fmt::format("{} constants {:.1e}, table {:.1e}, from the library {:.2g}\n",
                                     name, constant, table, log);
            EXPECT_LE(constant, ofConstants.here()) << name;
            EXPECT_LE(table, ofTable.here()) << name;
            EXPECT_LE(log, tabled().error.largest) << name;
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << reason.what();
        }
    }
}

TEST(LibraryShader, GlslOnVulkan) {
    prove(Language::glsl);
    keepForTimes(20, "library, 6 components, constants", sums());
    keepForTimes(21, "library, 6 components, table", tabled().sums);
}
TEST(LibraryShader, HlslOnVulkan) {
    prove(Language::hlsl);
}
TEST(LibraryShader, SlangOnVulkan) {
    prove(Language::slang);
}
TEST(LibraryShader, WgslOnVulkan) {
    prove(Language::wgsl);
}
TEST(LibraryShader, GlslEsOnOpenGlEs) {
    prove(Language::glslEs);
}
TEST(LibraryShader, MetalAsCpp) {
    prove(Language::metal);
}
// The functions beyond the texels that a material states are not looked up.
TEST(LibraryShader, StopsWhereTheNumbersOfAMaterialEnd) {
    gpu::SharedSums less = sums();
    const std::size_t few = 3;
    for (std::size_t p = 0; p < less.parts.size(); ++p) {
        if (less.parts[p].function <= few) continue;
        std::fill_n(&less.materials[4 * p], 4, 0.0);
    }
    const gpu::TableSize size{24, 15, 9};
    const gpu::SharedSums all = gpu::tabledSums(sums(), size), first = gpu::tabledSums(less, size);
    ASSERT_EQ(all.table->groups(), 2u);
    EXPECT_EQ(all.materials[3], 2);
    EXPECT_EQ(first.materials[3], 1);
    EXPECT_EQ(first.materials[4 * first.stride() + 3], 2);
    gpu::SharedSums cut = all;
    cut.materials[3] = 1;
    const Pairs pairs = pairsWithLobes();
    const std::vector<double> f = valuesOf(gpu::TabledBrdf(first, 0), pairs);
    try {
        EXPECT_LE(largestShare(shown(Language::glsl, cut, 0, pairs), f), 2e-3);
        EXPECT_GT(largestShare(shown(Language::glsl, all, 0, pairs), f), 2e-2);
    } catch (const Missing& reason) {
        GTEST_SKIP() << reason.what();
    }
}

// The texture has 2048 rows a layer.
TEST(LibraryShader, FindsMaterialsInFurtherLayers) {
    const gpu::SharedSums few = gpu::tabledSums(sums(), {16, 9, 7});
    gpu::SharedSums many = few;
    while (many.count() <= 2048)
        many.materials.insert(many.materials.end(), few.materials.begin(), few.materials.end());
    const gpu::Texels texels = gpu::materialTexels(many);
    EXPECT_EQ(texels.height, 2048);
    EXPECT_EQ(texels.layers, 2u);
    const std::size_t last = many.count() - 1;
    ASSERT_GT(last, 2048u);
    const Pairs pairs = pairsWithLobes();
    try {
        const std::vector<float> found = shown(Language::glsl, many, last, pairs);
        EXPECT_EQ(found, shown(Language::glsl, few, few.count() - 1, pairs));
        EXPECT_NE(found, shown(Language::glsl, many, last - 2048, pairs));
    } catch (const Missing& reason) {
        GTEST_SKIP() << reason.what();
    }
}

TEST(LibraryShader, OslHasNone) {
    EXPECT_THROW(gpu::libraryShaderSource(Language::osl, sums(), "hsh"), UsageError);
}

// Components of more than 12 bits have two texels.
TEST(LibraryShader, TexelsHoldTheNumbersExactly) {
    const ml::Basis& basis = library().basis;
    EXPECT_GT(*std::ranges::max_element(basis.widths), 12);
    const std::vector<ml::TexelPart> parts = ml::texelParts(basis);
    const gpu::SharedSums all = sums();
    const std::vector<double> read = gpu::decode(gpu::materialTexels(all));
    for (std::size_t n = 0; n < all.count(); ++n) {
        const ml::Material& material = library().materials[n];
        for (std::size_t c = 0; c < material.channels; ++c) {
            const std::size_t bytes = basis.channelBytes();
            const ml::ChannelCode code =
                ml::unpack(basis, std::span(material.codes).subspan(c * bytes, bytes));
            std::vector<double> sum(basis.size(), 0.0);
            const std::size_t first = 4 * n * all.stride() + c;
            for (std::size_t p = 0; p < parts.size(); ++p)
                sum[parts[p].function - 1] += parts[p].scale * read[first + 4 * p];
            for (std::size_t k = 0; k < basis.size(); ++k)
                EXPECT_NEAR(sum[k], code.coordinates[k] / basis.step, 1e-6) << n << " " << k;
            EXPECT_NEAR(all.topFirst + all.topStep * read[first + 4 * parts.size()], code.top,
                        1e-12);
        }
    }
}

}  // namespace
}  // namespace hshfit::shaders
