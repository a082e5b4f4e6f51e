// The defaults of a form follow from the laws of the BRDF.

#include "lib/formula_brdf.h"

#include <hshfit/representation/forms/form.h>

#include <gtest/gtest.h>

#include <cmath>

namespace hshfit {
namespace {

std::unique_ptr<Brdf> openNothing(const std::string&) {
    return nullptr;
}

/// The cosine of the angle between the half vector and an axis of the surface, or the normal.
test::FormulaBrdf about(const Direction& axis, const Laws& laws) {
    return test::FormulaBrdf(
        [axis](const Direction& wi, const Direction& wo) {
            const Direction h{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
            return 1 + std::pow(dot(h, axis), 2) / dot(h, h);
        },
        {}, laws);
}

TEST(FormDefaults, OutgoingSetsFollowFromIsotropyUnlessNamed) {
    const Form form{.order = 2, .precision = Precision::float64};
    const auto isotropic = about({0, 0, 1}, {.isotropic = true});
    const auto brushed = about({1, 0, 0}, {.isotropic = false});
    const Representation turning = represent(isotropic, form, openNothing);
    EXPECT_EQ(turning.head.outgoing.spec(), "32");
    const Representation mapped = represent(brushed, form, openNothing);
    EXPECT_EQ(mapped.head.outgoing.spec(), "32x32");
    Form named = form;
    named.outgoing = "8x8";
    EXPECT_EQ(represent(isotropic, named, openNothing).head.outgoing.spec(), "8x8");
}

}  // namespace
}  // namespace hshfit
