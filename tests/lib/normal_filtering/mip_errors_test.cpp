// Filtered levels against the average of 1,024 base texels, beside ordinary mips.

#include <lib/normal_filtering/surfaces.h>

#include <hshfit/error.h>

#include <gtest/gtest.h>

namespace {

using namespace hshfit;

const MipError& find(const MipErrors& errors, const std::string& form, int order = 0) {
    for (const MipError& e : errors.forms)
        if (e.form == form && e.use.order == order) return e;
    throw std::runtime_error(form);
}

MipErrors errorsOf(const test::GgxSurface& ggx, int level, const MipErrorOptions& options = {}) {
    const auto table = ggx.table(33);
    const auto levels = filterNormals(ggx.size, ggx.size, ggx.texels, table,
                                      {.weights = 1, .albedos = 1, .order = 33});
    return measureMipLevel(ggx.surface(), level, levels[static_cast<std::size_t>(level - 1)],
                           *table, options);
}

TEST(MipErrors, AreFourTimesLowerThanOfParametersOnBumpyAndBrushedMaps) {
    const test::GgxSurface bumpy(test::SlopeMap::bumpy(0.3), 0.1, 0.1),
        brushed(test::SlopeMap::brushed(0.3, 0.05), 0.1, 0.1);
    for (const test::GgxSurface* map : {&bumpy, &brushed})
        for (const int level : {4, 6, 8}) {
            const MipErrors errors = errorsOf(*map, level);
            const MipError& parameters = find(errors, "parameters");
            EXPECT_GT(parameters.relative, 0.5);
            for (const MipError& form : {find(errors, "ellipse"), find(errors, "harmonics", 33)}) {
                EXPECT_LT(form.relative, parameters.relative / 4) << form.form << " " << level;
                EXPECT_LT(form.maximum, parameters.maximum) << form.form << " " << level;
                EXPECT_NEAR(form.albedo, 1, 0.02) << form.form << " " << level;
            }
        }
}

TEST(MipErrors, OfAFlatMapAreThoseOfTheTruncation) {
    const test::GgxSurface flat(test::SlopeMap{}, 0.3, 0.3, 16);
    const MipErrors errors = errorsOf(flat, 2, {.texels = 2});
    EXPECT_LT(find(errors, "parameters").relative, 1e-12);
    EXPECT_LT(find(errors, "ellipse").relative, 0.003);
    EXPECT_LT(find(errors, "harmonics", 33).relative, 0.003);
    EXPECT_EQ(cheapestForm(errors, 0.1).form, "parameters");
    EXPECT_EQ(errors.noise, 0);
}

TEST(MipErrors, OfTheMeanNormalAreLargerThanOfFacets) {
    const test::GgxSurface bumpy(test::SlopeMap::bumpy(0.3), 0.1, 0.1);
    const MipErrors errors = errorsOf(bumpy, 6, {.atMeanNormal = true});
    EXPECT_GT(find(errors, "ellipse at normal").relative, find(errors, "ellipse").relative);
    const MipError& cheapest = cheapestForm(errors, 0.3);
    EXPECT_LE(cheapest.relative, 0.3);
    for (const MipError& e : errors.forms)
        EXPECT_TRUE(e.relative > 0.3 || cheapest.numbers <= e.numbers) << e.form;
}

TEST(MipErrors, OfAnotherLevelAreRefused) {
    const test::GgxSurface flat(test::SlopeMap{}, 0.3, 0.3, 8);
    const auto table = flat.table(5);
    const auto levels =
        filterNormals(8, 8, flat.texels, table, {.weights = 1, .albedos = 1, .order = 5});
    EXPECT_THROW(measureMipLevel(flat.surface(), 2, levels[0], *table), UsageError);
    EXPECT_THROW(measureMipLevel(flat.surface(), 1, levels[0], *table, {.orders = {7}}),
                 UsageError);
    EXPECT_THROW(measureMipLevel(flat.surface(), 1, levels[0], *table, {.texels = 0}), UsageError);
}

}  // namespace
