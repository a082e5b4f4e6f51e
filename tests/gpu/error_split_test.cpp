#include "asymmetric.h"

#include <hshfit/error.h>
#include <hshfit/gpu/error_split.h>
#include <hshfit/projection/projection.h>

#include <brdfs/catalog.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

namespace hshfit::gpu {
namespace {

struct Exported {
    std::unique_ptr<Brdf> brdf;
    Coefficients coefficients;
    double captured = 0;  ///< share of the energy
};

Exported exported(const std::string& spec, const OutgoingSet& outgoing, int order,
                  Quantity quantity = Quantity::brdf) {
    Exported result{brdfs::open(spec), {}, 0};
    const auto basis = bases::make("hsh", order, {});
    const Basis* const one[] = {basis.get()};
    const Projection projection = project(*result.brdf, one, outgoing, {.quantity = quantity})[0];
    result.coefficients = projection.coefficients;
    result.captured = projection.captured.back() / projection.coefficients.energy.value;
    return result;
}

ErrorSplit split(const Exported& e, Number number) {
    return splitError(*e.brdf, e.coefficients, pack(e.coefficients, {.number = number}));
}

TEST(ErrorSplit, FunctionsWithinTheBasisHaveRoundingErrorsOnly) {
    const Exported e = exported("lambert:kd=0.37", OutgoingSet::parabolic(8, 8), 3);
    const ErrorSplit half = split(e, Number::float16);
    EXPECT_LE(half.truncation, 1e-9);
    EXPECT_LE(half.interpolation, 1e-9);
    EXPECT_GT(half.quantisation, 0);
    EXPECT_LE(half.quantisation, std::ldexp(1, -11));
    EXPECT_NEAR(half.total, half.quantisation, 1e-9);
}

TEST(ErrorSplit, TruncationIsTheEnergyNotCaptured) {
    // In the inner product of the basis, f cos(theta_i) loses what Eq. 15 says; at one outgoing
    // direction there is nothing else.
    for (const char* spec : {"phong:exponent=20,kd=0.2", "ward:ax=.3,ay=.5,kd=.1"}) {
        const Exported e =
            exported(spec, OutgoingSet::direction(0.7, 0.3), 5, Quantity::brdfCosine);
        const ErrorSplit s = split(e, Number::float32);
        EXPECT_NEAR(s.truncation, std::sqrt(1 - e.captured), 2e-3 * s.truncation) << spec;
        EXPECT_LE(s.interpolation, 1e-12);
        EXPECT_LE(s.quantisation, 1e-6);
    }
}

TEST(ErrorSplit, InterpolationFallsWithTheSpacing) {
    const std::string spec = "phong:exponent=10,kd=0.3";
    const double coarse =
        split(exported(spec, OutgoingSet::elevations(16), 4), Number::float32).interpolation;
    const double fine =
        split(exported(spec, OutgoingSet::elevations(64), 4), Number::float32).interpolation;
    // With its square in the map; the ring next to the horizon, which has no coefficients of its
    // own, falls with the spacing itself.
    EXPECT_GE(std::log2(coarse / fine), 2);
    EXPECT_LE(std::log2(coarse / fine), 4.5);
}

TEST(ErrorSplit, CausesAddUpToNoMoreThanTheirSum) {
    const Exported e = exported("ward:ax=.2,ay=.4,kd=.1", OutgoingSet::parabolic(16, 16), 5);
    const ErrorSplit s = split(e, Number::unorm8);
    EXPECT_LE(s.total, s.truncation + s.interpolation + s.quantisation);
    EXPECT_GE(s.total, s.truncation - s.interpolation - s.quantisation);
    EXPECT_GT(s.quantisation, split(e, Number::unorm16).quantisation * 50);
}

TEST(ErrorSplit, BlackHasNoRelativeError) {
    const Exported e = exported("lambert:kd=0", OutgoingSet::parabolic(8, 8), 2);
    EXPECT_THROW(split(e, Number::float16), NumericError);
}

TEST(ErrorSplit, BasisTexturesConverge) {
    const Coefficients c =
        samples::asymmetric("hsh", 7, OutgoingSet::parabolic(8, 8), Channels::grey(), 1);
    double before = 1e9;
    for (int size : {32, 64, 128, 256}) {
        const auto error =
            basisTextureError(pack(c, {.number = Number::float32, .basisSize = size}));
        ASSERT_TRUE(error);
        EXPECT_LT(error->largestAbove6, before / 2) << size;
        EXPECT_LE(error->rms, error->largest);
        before = error->largestAbove6;
    }
    EXPECT_FALSE(basisTextureError(pack(c, {})));
}

}  // namespace
}  // namespace hshfit::gpu
