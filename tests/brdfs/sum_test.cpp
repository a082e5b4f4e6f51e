// Sums of BRDFs: how they are written, and that they are what their terms are.

#include "models_grid.h"

#include <brdfs/catalog.h>
#include <brdfs/composed/sum.h>
#include <gtest/gtest.h>
#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>

#include <filesystem>
#include <fstream>

namespace hshfit::brdfs {
namespace {

namespace fs = std::filesystem;

const Direction wi = directionFromAngles(.6, .2), wo = directionFromAngles(.5, 3);

std::string errorOf(const std::string& spec) {
    try {
        return "opened as " + open(spec)->name();
    } catch (const UsageError& error) {
        return error.what();
    }
}

TEST(Sum, AddsWeightedValuesOfItsTerms) {
    const auto sum = open("lambert:kd=.1 + 0.5 * ggx:alpha=.2 + 3 * phong:exponent=9");
    const auto lambert = open("lambert:kd=.1"), ggx = open("ggx:alpha=.2"),
               phong = open("phong:exponent=9");
    for (const Pair& p : ordinaryPairs(51)) {
        const double expected = evaluate(*lambert, p.wi, p.wo)[0] +
                                .5 * evaluate(*ggx, p.wi, p.wo)[0] +
                                3 * evaluate(*phong, p.wi, p.wo)[0];
        EXPECT_DOUBLE_EQ(evaluate(*sum, p.wi, p.wo)[0], expected);
    }
}

TEST(Sum, GreyTermsCountForEveryChannel) {
    for (const std::string spec :
         {"lambert:kd=.1 + lambert:kd=.2/.4/.6", "lambert:kd=.2/.4/.6 + lambert:kd=.1"}) {
        const auto sum = open(spec);
        ASSERT_EQ(sum->channels().kind, Channels::Kind::rgb);
        const std::vector<double> f = evaluate(*sum, wi, wo);
        EXPECT_DOUBLE_EQ(f[0], .1 / pi + .2 / pi);
        EXPECT_DOUBLE_EQ(f[1], .1 / pi + .4 / pi);
        EXPECT_DOUBLE_EQ(f[2], .1 / pi + .6 / pi);
    }
}

TEST(Sum, NameIsItsCanonicalSpecification) {
    EXPECT_EQ(open("lambert:kd=0.10 + 0.50 * ggx:alpha=.2 + 1 * lambert")->name(),
              "lambert:kd=0.1 + 0.5 * ggx:alpha=0.2 + lambert");
    EXPECT_EQ(open("0.5 * lambert")->name(), "0.5 * lambert");
    EXPECT_EQ(open("1 * lambert")->name(), "lambert");
    EXPECT_EQ(open("1e-7 * lambert + preset:hsh-ward")->name(),
              "1e-07 * lambert + ward:ax=0.2,ay=0.5");
}

TEST(Sum, SpacesAroundSignsAreOptionalAndNumbersKeepTheirs) {
    const std::string name = open("lambert:kd=.1 + 0.5 * ggx:alpha=.2")->name();
    for (const std::string spec :
         {"lambert:kd=.1+0.5*ggx:alpha=.2", "lambert:kd=.1 + 0.5* ggx:alpha=.2",
          "1*lambert:kd=.1 + .5 *ggx:alpha=.2", "lambert:kd=.1+0.5 * ggx:alpha=.2",
          "lambert:kd=.1 +0.5 * ggx:alpha=.2", "lambert:kd=.1+  0.5 * ggx:alpha=.2",
          "lambert:kd=1e-1+5e-1 * ggx:alpha=2.e-1"})
        EXPECT_EQ(open(spec)->name(), name) << spec;
    EXPECT_EQ(open("phong:exponent=1e+2")->name(), open("phong:exponent=100")->name());
    EXPECT_EQ(open("phong:exponent=1e+2+lambert")->name(), "phong:exponent=100 + lambert");
    EXPECT_NE(errorOf("lambert++lambert").find("empty term"), std::string::npos);
}

// Each " + " may belong to a path, so that splitting would look at every pair of them.
TEST(Sum, TooManyTermsOrPrefixesAreRefused) {
    std::string spec = "lambert:kd=0";
    for (int k = 1; k < 2000; ++k) spec += " + lambert:kd=0";
    EXPECT_EQ(errorOf(spec).find("sum: 'lambert:kd=0 + "), 0u) << errorOf(spec).substr(0, 200);
    EXPECT_LT(errorOf(spec).size(), 200u);
    spec = "0.5 * lambert";
    for (std::size_t k = 1; k < mostTerms; ++k) spec += " + 0 * lambert";
    EXPECT_DOUBLE_EQ(evaluate(*open(spec), wi, wo)[0], .5 / pi);
    std::string nested;
    for (int k = 0; k < 20000; ++k) nested += k % 2 ? "grey:" : "rgb:";
    EXPECT_NE(errorOf(nested + "lambert").find("more than 4 prefixes"), std::string::npos);
    EXPECT_LT(errorOf(nested + "lambert").size(), 200u);
    EXPECT_EQ(open("grey:grey:grey:lambert")->channels().count(), 1u);
}

TEST(Sum, KeepsTheLawsThatAllTermsKeep) {
    const auto lawsOf = [](const std::string& spec) { return open(spec)->laws(); };
    EXPECT_TRUE(lawsOf("lambert + ggx:alpha=.2").isotropic);
    EXPECT_FALSE(lawsOf("lambert + ggx:ax=.2,ay=.3").isotropic);
    EXPECT_TRUE(lawsOf("lambert + ggx:ax=.2,ay=.3").reciprocal);
    EXPECT_FALSE(lawsOf("lambert + charlie:r=.3,terminator=soft").reciprocal);
    // Energy: weights of at most 1 in all, of terms that keep it.
    EXPECT_FALSE(lawsOf("lambert:kd=.1 + ggx:alpha=.2").energyConserving);
    EXPECT_TRUE(lawsOf("0.25 * lambert + 0.75 * ggx:alpha=.2").energyConserving);
    EXPECT_FALSE(lawsOf("0.25 * lambert + 0.76 * ggx:alpha=.2").energyConserving);
    EXPECT_FALSE(lawsOf("0.1 * lambert + 0.1 * ward:ax=.2,ay=.2").energyConserving);
    EXPECT_TRUE(lawsOf("lambert + 0 * ward:ax=.2,ay=.2").energyConserving);
}

TEST(Sum, AlbedoIsTheSumOfAlbedos) {
    const auto sum = open("0.5 * eon:roughness=.6 + ggx:alpha=.1,F0=.5 + sg:sharpness=100,ks=.1");
    for (const double theta : {0., 50., 80.}) {
        const Direction up = directionFromAngles(radians(theta), .3);
        const auto albedo = [&](const std::string& spec) {
            return directionalAlbedo(*open(spec), up)[0];
        };
        EXPECT_NEAR(directionalAlbedo(*sum, up)[0],
                    .5 * albedo("eon:roughness=.6") + albedo("ggx:alpha=.1,F0=.5") +
                        albedo("sg:sharpness=100,ks=.1"),
                    5e-4)
            << theta;
    }
}

/// A constant BRDF with whatever else a measured file may say.
class Stub : public Brdf {
public:
    Stub(std::string name, Channels channels, double first, double tolerance)
        : name_(std::move(name)),
          channels_(std::move(channels)),
          first_(first),
          tolerance_(tolerance) {}

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction&, DirectionBatch in, double* out) const override {
        for (std::size_t c = 0; c < channels_.count(); ++c)
            for (std::size_t k = 0; k < in.count; ++k)
                out[c * in.count + k] = first_ + static_cast<double>(c);
    }
    void coverage(const Direction&, DirectionBatch in, unsigned char* covered) const override {
        for (std::size_t k = 0; k < in.count; ++k) covered[k] = in.z[k] > first_ / 10;
    }
    std::vector<Lobe> lobes(const Direction&) const override { return {{.width = first_}}; }
    std::vector<double> kinks(const Direction&) const override { return {.5, first_ / 10}; }
    double defaultTolerance() const override { return tolerance_; }
    std::vector<Fact> facts() const override { return {{"invalid_cells", std::int64_t{7}}}; }
    void checkIntact() const override {
        if (tolerance_ > 1) throw InputError(name_ + ": shrank");
    }

private:
    std::string name_;
    Channels channels_;
    double first_, tolerance_;
    Laws laws_;
};

Sum sumOf(Stub first, Stub second) {
    std::vector<Sum::Term> terms;
    terms.push_back({2, std::make_unique<Stub>(std::move(first))});
    terms.push_back({1, std::make_unique<Stub>(std::move(second))});
    return Sum(std::move(terms));
}

TEST(Sum, CombinesChannelsLobesKinksAndCoverageOfItsTerms) {
    const Channels spectrum = Channels::spectral({400, 500, 600});
    const Sum sum = sumOf({"a", spectrum, 1, 1e-3}, {"b", Channels::grey(), 4, 1e-6});
    EXPECT_EQ(sum.channels().wavelengths, spectrum.wavelengths);
    EXPECT_EQ(evaluate(sum, wi, wo), (std::vector<double>{2 * 1 + 4, 2 * 2 + 4, 2 * 3 + 4}));
    ASSERT_EQ(sum.lobes(wo).size(), 2u);
    EXPECT_EQ(sum.lobes(wo)[1].width, 4);
    EXPECT_EQ(sum.kinks(wo), (std::vector<double>{.1, .4, .5}));
    EXPECT_EQ(sum.defaultTolerance(), 1e-3);
    // Covered where both are: above heights of 0.1 and 0.4.
    const double x[] = {.99, .98, .6}, y[] = {0, 0, 0}, z[] = {.05, .2, .8};
    unsigned char covered[3];
    sum.coverage(wo, {x, y, z, 3}, covered);
    EXPECT_EQ(covered[0], 0);
    EXPECT_EQ(covered[1], 0);
    EXPECT_EQ(covered[2], 1);
    int seen = 0;
    for (const auto& [name, value] : sum.facts()) {
        if (name == "terms") seen += std::get<std::int64_t>(value) == 2;
        if (name == "term_1") seen += std::get<std::string>(value) == "a";
        if (name == "term_1_weight") seen += std::get<double>(value) == 2;
        if (name == "term_2_invalid_cells") seen += std::get<std::int64_t>(value) == 7;
    }
    EXPECT_EQ(seen, 4);
    EXPECT_NO_THROW(sum.checkIntact());
    EXPECT_THROW(sumOf({"a", spectrum, 1, 1}, {"b", spectrum, 1, 2}).checkIntact(), InputError);
}

TEST(Sum, ChannelsThatDoNotMatchAreNamed) {
    const auto refused = [](Channels a, Channels b) {
        try {
            sumOf({"first.bsdf", std::move(a), 1, 1}, {"second.bsdf", std::move(b), 1, 1});
        } catch (const UsageError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    const std::string text = refused(Channels::spectral({400, 500}), Channels::rgb());
    EXPECT_NE(text.find("'first.bsdf' is 2 wavelengths from 400 to 500 nm"), text.npos) << text;
    EXPECT_NE(text.find("'second.bsdf' is rgb"), text.npos) << text;
    EXPECT_NE(refused(Channels::spectral({400, 500}), Channels::spectral({400, 510})), "accepted");
    EXPECT_EQ(refused(Channels::spectral({400, 500}), Channels::spectral({400, 500})), "accepted");
}

TEST(Sum, MistakesAreNamed) {
    for (const std::string spec : {"lambert + ", " + lambert", "lambert +  + lambert", " + "})
        EXPECT_NE(errorOf(spec).find("empty term"), std::string::npos) << errorOf(spec);
    for (const std::string weight : {"-1", "1e7", "nan", "inf", "1e999"}) {
        const std::string text = errorOf("lambert + " + weight + " * lambert");
        EXPECT_NE(text.find("weight " + weight), text.npos) << text;
        EXPECT_NE(text.find("valid: 0 to 1000000"), text.npos) << text;
    }
    EXPECT_NE(errorOf("lambert + gxx:alpha=.2").find("unknown model 'gxx'"), std::string::npos);
    EXPECT_NE(errorOf("lambert + ggx:alpha=9999").find("alpha=9999 is out of range"),
              std::string::npos);
    EXPECT_NE(errorOf("x * lambert").find("unknown model 'x * lambert'"), std::string::npos);
}

// A path that exists is never taken apart.
TEST(Sum, PathsWithPlusSigns) {
    const fs::path folder = fs::path(testing::TempDir()) / "hshfit_sum";
    fs::remove_all(folder);
    fs::create_directories(folder / "0.5 * x");
    const auto write = [&](const std::string& name, const std::string& kd) {
        std::ofstream(folder / name) << R"({"format":"hshfit-preset","version":1,"source":"here",)"
                                     << R"("model":"lambert","parameters":{"kd":)" << kd << "}}";
        return (folder / name).string();
    };
    const std::string odd = write("a + b.json", "0.5");
    const std::string plain = write("c.json", "0.25");
    const std::string product = write("0.5 * x/d.json", "0.125");
    EXPECT_EQ(open(odd)->name(), "lambert:kd=0.5");
    EXPECT_EQ(open(odd + " + " + plain)->name(), "lambert:kd=0.5 + lambert:kd=0.25");
    EXPECT_EQ(open(plain + " + 2 * " + odd + " + lambert")->name(),
              "lambert:kd=0.25 + 2 * lambert:kd=0.5 + lambert");
    EXPECT_EQ(open(product)->name(), "lambert:kd=0.125");
    EXPECT_EQ(open("0.5 * " + product)->name(), "0.5 * lambert:kd=0.125");
    EXPECT_EQ(open("lambert + " + product)->name(), "lambert + lambert:kd=0.125");
    EXPECT_THROW(open("lambert + " + folder.string() + "/absent.binary"), InputError);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace hshfit::brdfs
