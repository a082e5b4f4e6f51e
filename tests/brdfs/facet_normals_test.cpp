// The split of microfacet models into a smooth part and a lobe, against the models themselves.

#include <brdfs/analytic/facet_normals.h>
#include <brdfs/catalog.h>

#include <hshfit/brdf/uniform.h>
#include <hshfit/quadrature/quadrature.h>

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace hshfit;

class FacetNormalsOf : public testing::TestWithParam<const char*> {};

/// f_c = constant_c + sum of weight_{t,c} T_t.
TEST_P(FacetNormalsOf, TermsAddUpToTheModel) {
    const auto brdf = brdfs::openModel(GetParam());
    const auto* facets = dynamic_cast<const brdfs::HasFacetNormals*>(brdf.get());
    ASSERT_NE(facets, nullptr);
    const brdfs::TermWeights& weights = facets->facetNormals().weights;
    ASSERT_EQ(weights.terms.size(), facets->facetNormals().ofLobe.size());
    std::mt19937_64 random(1);
    for (int trial = 0; trial < 200; ++trial) {
        const auto drawn = [&] {
            return directionFromAngles(std::acos(0.01 + 0.99 * uniform(random)),
                                       2 * pi * uniform(random));
        };
        const Direction wi = drawn(), wo = drawn();
        const std::vector<double> f = evaluate(*brdf, wi, wo);
        double terms[brdfs::TermBatch::maxTerms] = {};
        facets->terms(wi, wo, terms);
        for (std::size_t c = 0; c < f.size(); ++c) {
            const auto at = [&](const brdfs::Colour& colour) {
                return colour[colour.size() == 1 ? 0 : c];
            };
            double sum = at(weights.constant);
            for (std::size_t t = 0; t < weights.terms.size(); ++t)
                sum += at(weights.terms[t]) * terms[t];
            EXPECT_NEAR(sum, f[c], 1e-12 * (1 + f[c]));
        }
    }
}

/// Projected areas of facets add up to that of the surface: the integral of D cos is 1. The slope
/// t = tan(theta) = scale s / (1 - s) covers the tail.
TEST_P(FacetNormalsOf, DistributionsAreNormalised) {
    const auto brdf = brdfs::openModel(GetParam());
    const auto& normals = dynamic_cast<const brdfs::HasFacetNormals&>(*brdf.get()).facetNormals();
    const GaussRule& rule = gaussLegendre(200);
    const double scale = std::sqrt(normals.widthX * normals.widthY);
    constexpr int azimuths = 400;
    double sum = 0;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double s = (1 + rule.nodes[k]) / 2, t = scale * s / (1 - s);
        const double slope = scale / ((1 - s) * (1 - s)) * rule.weights[k] / 2;
        const double cosine = 1 / std::sqrt(1 + t * t);
        for (int j = 0; j < azimuths; ++j) {
            const double phi = 2 * pi * (j + 0.5) / azimuths;
            const Direction h{t * cosine * std::cos(phi), t * cosine * std::sin(phi), cosine};
            // d omega = cos^3 t dt d phi
            sum += normals.density(h) * std::pow(cosine, 4) * t * slope * 2 * pi / azimuths;
        }
    }
    EXPECT_NEAR(sum, 1, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Models, FacetNormalsOf,
                         testing::Values("ggx:alpha=0.2,kd=0.3,F0=0.9/0.5/0.1,ks=0.8",
                                         "ggx:ax=0.1,ay=0.4,fresnel=conductor,ior=0.2/0.9/1.2,k=3",
                                         "beckmann:ax=0.3,ay=0.15,kd=0.1",
                                         "ward:ax=0.2,ay=0.3,kd=0.1/0.2/0.3,ks=0.5",
                                         "gltf-pbr:baseColorFactor=0.9/0.4/0.2,metallicFactor=0.3,"
                                         "roughnessFactor=0.5,anisotropyStrength=0.4,"
                                         "anisotropyRotation=1"));

TEST(FacetNormals, ModelsOfTwoLobesHaveNone) {
    for (const char* spec : {"gltf-pbr:clearcoatFactor=0.5", "gltf-pbr:sheenColorFactor=0.5"}) {
        const auto brdf = brdfs::openModel(spec);
        EXPECT_EQ(dynamic_cast<const brdfs::HasFacetNormals*>(brdf.get()), nullptr) << spec;
    }
}

}  // namespace
