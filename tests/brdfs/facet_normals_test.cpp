// The split of microfacet models into a smooth part and a lobe, against the models themselves.

#include <brdfs/analytic/facet_normals.h>
#include <brdfs/catalog.h>

#include <hshfit/brdf/uniform.h>
#include <hshfit/quadrature/quadrature.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

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

/// Projected areas of facets add up to the surface's: the integral of D cos is 1. The slope
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

/// A facet model at one setting, with one parameter at a value of its own.
struct Setting {
    std::string model;
    std::vector<std::pair<std::string, std::string>> values;

    explicit Setting(const std::string& spec) : model(spec.substr(0, spec.find(':'))) {
        for (std::size_t from = model.size() + 1; from < spec.size();) {
            const std::size_t equals = spec.find('=', from);
            const std::size_t comma = std::min(spec.find(',', equals), spec.size());
            values.emplace_back(spec.substr(from, equals - from),
                                spec.substr(equals + 1, comma - equals - 1));
            from = comma + 1;
        }
    }
    std::unique_ptr<Brdf> with(std::string_view name, double value) const {
        std::string spec = model + ":" + std::string(name) + "=" + std::to_string(value);
        for (const auto& [key, stated] : values)
            if (key != name) spec += "," + key + "=" + stated;
        return brdfs::openModel(spec);
    }
};

const brdfs::FacetNormals& normalsOf(const Brdf& brdf) {
    return dynamic_cast<const brdfs::HasFacetNormals&>(brdf).facetNormals();
}

/// Weights of all terms, then the constant, of the first channel.
std::vector<double> weightsOf(const Brdf& brdf) {
    const brdfs::TermWeights& weights = normalsOf(brdf).weights;
    std::vector<double> all;
    for (const brdfs::Colour& term : weights.terms) all.push_back(term[0]);
    all.push_back(weights.constant[0]);
    return all;
}

/// The densities of normals and the terms in many directions.
std::vector<double> shapeOf(const Brdf& brdf) {
    std::mt19937_64 random(1);
    std::vector<double> all;
    for (int trial = 0; trial < 30; ++trial) {
        const auto drawn = [&] {
            return directionFromAngles(std::acos(0.05 + 0.95 * uniform(random)),
                                       2 * pi * uniform(random));
        };
        const Direction wi = drawn(), wo = drawn();
        double terms[brdfs::TermBatch::maxTerms] = {};
        dynamic_cast<const brdfs::HasFacetNormals&>(brdf).terms(wi, wo, terms);
        all.insert(all.end(), terms, terms + normalsOf(brdf).ofLobe.size());
        all.push_back(normalsOf(brdf).density(wi));
    }
    return all;
}

bool differ(const std::vector<double>& a, const std::vector<double>& b) {
    return !std::ranges::equal(
        a, b, [](double x, double y) { return std::abs(x - y) <= 1e-9 * (1e-9 + std::abs(x)); });
}

/// Parameter::role of each number and colour that the setting states.
TEST_P(FacetNormalsOf, ParametersChangeWhatTheirRolesSay) {
    using enum Parameter::Role;
    const Setting setting{GetParam()};
    const brdfs::Model* model = brdfs::findModel(setting.model);
    ASSERT_NE(model, nullptr);
    for (const auto& [name, stated] : setting.values) {
        const auto row = std::ranges::find(model->parameters, name, &Parameter::name);
        ASSERT_NE(row, model->parameters.end()) << name;
        if (row->kind == Parameter::Kind::choice) continue;
        const double low = std::max(row->min, 0.0), most = std::min(row->max, low + 1);
        const auto at = [&](double share) {
            return setting.with(name, low + share * (most - low));
        };
        const auto a = at(0.3), b = at(0.5), c = at(0.7);
        const bool turns = normalsOf(*a).turn != normalsOf(*c).turn;
        const bool terms = differ(shapeOf(*a), shapeOf(*c));
        const std::vector<double> first = weightsOf(*a), middle = weightsOf(*b);
        const std::vector<double> last = weightsOf(*c);
        EXPECT_EQ(turns, row->role == turn) << name;
        EXPECT_EQ(terms, row->role != weight) << name;
        EXPECT_EQ(differ(first, last), row->role == weight || row->role == both) << name;
        if (row->role != weight) continue;
        for (std::size_t t = 0; t < first.size(); ++t)
            EXPECT_NEAR(middle[t], (first[t] + last[t]) / 2, 1e-12) << name << ", term " << t;
    }
}

INSTANTIATE_TEST_SUITE_P(Models, FacetNormalsOf,
                         testing::Values("ggx:alpha=0.2,kd=0.3,F0=0.9/0.5/0.1,ks=0.8",
                                         "ggx:ax=0.1,ay=0.4,fresnel=conductor,ior=0.2/0.9/1.2,k=3",
                                         "beckmann:ax=0.3,ay=0.15,kd=0.1",
                                         "ward:ax=0.2,ay=0.3,kd=0.1/0.2/0.3,ks=0.5",
                                         "gltf-pbr:baseColorFactor=0.9/0.4/0.2,metallicFactor=0.3,"
                                         "roughnessFactor=0.5,anisotropyStrength=0.4,"
                                         "anisotropyRotation=1",
                                         "gltf-pbr:baseColorFactor=0.9,metallicFactor=0.3,"
                                         "roughnessFactor=0.6,ior=1.4,specularFactor=0.7,"
                                         "specularColorFactor=0.8"));

TEST(FacetNormals, ModelsOfTwoLobesHaveNone) {
    for (const char* spec : {"gltf-pbr:clearcoatFactor=0.5", "gltf-pbr:sheenColorFactor=0.5"}) {
        const auto brdf = brdfs::openModel(spec);
        EXPECT_EQ(dynamic_cast<const brdfs::HasFacetNormals*>(brdf.get()), nullptr) << spec;
    }
}

}  // namespace
