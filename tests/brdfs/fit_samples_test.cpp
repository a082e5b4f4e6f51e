#include <brdfs/catalog.h>
#include <brdfs/fit/fit_samples.h>
#include <brdfs/measured/own_samples.h>
#include <brdfs/measured/scattered/astm.h>
#include <hshfit/error.h>

#include "places.h"

#include <brdfs/measured_files.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hshfit::brdfs {
namespace {

std::string shared(const std::string& name) {
    return test::sharedFolder() + "/data/" + name;
}

/// f = 1, as a table of three cells that no reader made: one below the horizon, one
/// not measured and one with a value that f has nowhere.
class ThreeCells : public Brdf, public HasCells {
public:
    explicit ThreeCells(bool byDefault) : byDefault_(byDefault) {}
    std::string name() const override { return "three cells"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction&, DirectionBatch wi, double* out) const override {
        std::fill_n(out, wi.count, 1.0);
    }
    void coverage(const Direction&, DirectionBatch wi, unsigned char* covered) const override {
        std::fill_n(covered, wi.count, 0);
    }
    void giveCells(CellReceiver& receiver) const override {
        receiver.reserve(1);
        receiver.belowHorizon();
        receiver.invalid();
        const double f[] = {7};
        receiver.add(pair, f, 0.25);
    }
    bool cellsAreDefault() const override { return byDefault_; }
    bool holdsBeyondCoverage() const override { return true; }

    DirectionPair pair{directionFromAngles(0.3, 0), directionFromAngles(0.5, 1)};

private:
    bool byDefault_;
    Channels channels_ = Channels::grey();
    Laws laws_{.isotropic = true};
};

/// A format needs no line in the fits: what it says of its cells decides where f is taken.
TEST(FitSamples, OfATableThatNoFitKnowsAreTheCellsThatItGives) {
    const ThreeCells ofCells(true), ofNodes(false);
    for (const FitSamples& samples :
         {gatherSamples(ofCells, {}), gatherSamples(ofNodes, {.places = SamplePlaces::cells})}) {
        EXPECT_EQ(samples.origin, SampleOrigin::cells);
        ASSERT_EQ(samples.size(), 1U);
        EXPECT_EQ(samples.wiX[0], ofCells.pair.wi.x);
        EXPECT_EQ(samples.wo[0].y, ofCells.pair.wo.y);
        EXPECT_EQ(samples.value(0, 0), 7);
        EXPECT_EQ(samples.masked.belowHorizon, 1U);
        EXPECT_EQ(samples.masked.invalid, 1U);
    }
    for (const FitSamples& samples :
         {gatherSamples(ofNodes, {}), gatherSamples(ofCells, {.places = SamplePlaces::nodes})}) {
        EXPECT_EQ(samples.origin, SampleOrigin::nodes);
        EXPECT_GT(samples.size(), 1000U);  // beyond the coverage, which is nothing
        EXPECT_EQ(samples.masked.invalid, 0U);
        EXPECT_EQ(samples.value(0, 0), 1);
    }
}

/// A table seen as grey has the mean of its channels at each of its cells.
TEST(FitSamples, OfAGreyTableAreItsCells) {
    const test::TemporaryFile file(
        test::merlFile([](int c, int h, int, int) { return h > 80 ? -1.0 : c + 1.0; }), ".binary");
    const auto colour = open(file.path()), grey = open("grey:" + file.path()),
               red = open("grey=1/0/0:" + file.path());
    const FitSamples all = gatherSamples(*colour, {}), mean = gatherSamples(*grey, {}),
                     first = gatherSamples(*red, {});
    EXPECT_EQ(all.origin, SampleOrigin::cells);
    EXPECT_EQ(mean.origin, SampleOrigin::cells);
    ASSERT_EQ(mean.size(), all.size());
    EXPECT_EQ(mean.masked.invalid, all.masked.invalid);
    EXPECT_GT(mean.masked.invalid, 0U);
    EXPECT_EQ(mean.wiX, all.wiX);
    EXPECT_EQ(mean.weights, all.weights);
    for (std::size_t k = 0; k < all.size(); k += 1001) {
        EXPECT_NEAR(mean.value(0, k), (all.value(0, k) + all.value(1, k) + all.value(2, k)) / 3,
                    1e-12);
        EXPECT_EQ(first.value(0, k), all.value(0, k));
    }
}

/// 1,439 measured pairs at 65 wavelengths: their colours are fitted, not an interpolant's.
TEST(FitSamples, OfASpectralFileSeenAsColourAreItsMeasurements) {
    const std::string path = shared("cornell/garnet_red.brdf");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data";
    const FitSamples samples = gatherSamples(*open("rgb:" + path), {});
    EXPECT_EQ(samples.origin, SampleOrigin::measured);
    EXPECT_FALSE(samples.solidAngles);
    const Masked& masked = samples.masked;
    EXPECT_EQ(samples.size() + masked.belowHorizon + masked.invalid + masked.notFinite, 1439U);
}

/// A file of one channel is the same with and without the prefix, through two of them as well.
TEST(FitSamples, OfAGreyFileDoNotChangeWithThePrefix) {
    const std::string path = shared("alta/retro-gray-tape.dat");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data";
    const FitSamples plain = gatherSamples(*open(path), {});
    EXPECT_EQ(plain.origin, SampleOrigin::measured);
    for (const char* prefix : {"grey:", "grey:grey:"}) {
        const FitSamples grey = gatherSamples(*open(prefix + path), {});
        ASSERT_EQ(grey.size(), plain.size());
        EXPECT_EQ(grey.wiX, plain.wiX);
        EXPECT_EQ(grey.weights, plain.weights);
        for (std::size_t k = 0; k < plain.size(); ++k) {
            double mean = 0;
            for (std::size_t c = 0; c < plain.channels.count(); ++c)
                mean += plain.value(c, k) / static_cast<double>(plain.channels.count());
            EXPECT_NEAR(grey.value(0, k), mean, 1e-12 * std::abs(mean));
        }
    }
}

// Columns about the values are no channels; a sample below the horizon takes its statement along.
TEST(AstmStatements, StandBesideTheValues) {
    const std::string angles = "VARS theta_i,phi_i,theta_s,phi_s,";
    const Samples one = readAstm(angles +
                                     "scan,BRDF,Sigma\n0.1,0,0.2,3,7,0.5,0.01\n"
                                     "0.1,0,1.5715,3,7,0.6,0.02\n0.1,0,0.3,3,8,0.7,0.03\n",
                                 "f");
    EXPECT_EQ(one.channels.kind, Channels::Kind::grey);
    EXPECT_EQ(one.values, (std::vector<double>{0.5, 0.7}));
    EXPECT_EQ(one.sigmas, (std::vector<double>{0.01, 0.03}));
    EXPECT_EQ(one.scans, (std::vector<double>{7, 8}));
    EXPECT_EQ(one.rows, (std::vector<std::size_t>{2, 4}));
    EXPECT_EQ(one.order, (std::vector<std::size_t>{0, 2}));
    EXPECT_EQ(one.read, 3u);
    const Samples spectral =
        readAstm(angles + "400nm,500nm,sigma_500nm,sigma_400nm\n0.1,0,0.2,3,1,2,0.02,0.01\n", "f");
    EXPECT_EQ(spectral.channels.wavelengths, (std::vector<double>{400, 500}));
    EXPECT_EQ(spectral.sigmas, (std::vector<double>{0.01, 0.02}));
    const Samples shared = readAstm(angles + "r,g,b,sigma\n0.1,0,0.2,3,1,2,3,0.1\n", "f");
    EXPECT_EQ(shared.sigmas, (std::vector<double>{0.1, 0.1, 0.1}));
    // Alone, any name is a value.
    EXPECT_EQ(readAstm(angles + "sigma\n0.1,0,0.2,3,4\n", "f").values, std::vector<double>{4});
    for (const char* rest : {
             "a,sigma\n0.1,0,0.2,3,1,0\n",
             "a,sigma\n0.1,0,0.2,3,1,-1\n",
             "a,sigma\n0.1,0,0.2,3,1,nan\n",
             "a,scan\n0.1,0,0.2,3,1,inf\n",
             "sigma,scan\n0.1,0,0.2,3,1,1\n",
             "400nm,500nm,sigma_400nm\n0.1,0,0.2,3,1,1,1\n",
             "a,sigma_b\n0.1,0,0.2,3,1,1\n",
             "a,sigma,sigma\n0.1,0,0.2,3,1,1,1\n",
         })
        EXPECT_THROW(readAstm(angles + rest, "f"), InputError) << rest;
}

}  // namespace
}  // namespace hshfit::brdfs
