#include <hshfit/brdf/colour.h>
#include <hshfit/error.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace hshfit {
namespace {

std::vector<double> range(double first, double last, double step) {
    std::vector<double> values;
    for (double v = first; v <= last + 1e-9; v += step) values.push_back(v);
    return values;
}

/// A spectrum that is the same for all directions.
class Flat : public Brdf {
public:
    Flat(std::vector<double> nanometres, std::vector<double> values)
        : channels_(Channels::spectral(std::move(nanometres))), values_(std::move(values)) {}
    std::string name() const override { return "flat"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction&, DirectionBatch wi, double* out) const override {
        for (std::size_t c = 0; c < values_.size(); ++c)
            std::fill_n(out + c * wi.count, wi.count, values_[c]);
    }

private:
    Channels channels_;
    std::vector<double> values_;
    Laws laws_{.reciprocal = true, .isotropic = true};
};

std::array<double, 2> chromaticity(const std::array<double, 3>& xyz) {
    const double sum = std::accumulate(xyz.begin(), xyz.end(), 0.0);
    return {xyz[0] / sum, xyz[1] / sum};
}

// ASTM E308-01 table 5.19, D65 and the 2-degree observer by 5 nm: 95.043, 100, 108.879.
TEST(Colour, whiteOfD65) {
    const std::vector<double> nm = range(400, 700, 10), one(nm.size(), 1.0);
    const auto xyz = tristimulus(nm, one);
    EXPECT_NEAR(xyz[0], 0.95043, 2e-5);
    EXPECT_NEAR(xyz[1], 1, 1e-12);
    EXPECT_NEAR(xyz[2], 1.08879, 2e-5);
    // CIE 15:2004, table T.3: x = 0.31272, y = 0.32903.
    EXPECT_NEAR(chromaticity(xyz)[0], 0.31272, 1e-5);
    EXPECT_NEAR(chromaticity(xyz)[1], 0.32903, 1e-5);
}

// A surface that turns D65 into illuminant A (Planck at 2856 K): x = 0.44758, y = 0.40745 (CIE 15).
TEST(Colour, whiteOfIlluminantA) {
    const std::vector<double> nm = range(380, 780, 10);
    // D65 at these wavelengths, CIE 15:2004 table T.1.
    const std::vector<double> d65 = {49.9755, 54.6482, 82.7549, 91.4860, 93.4318, 86.6823, 104.865,
                                     117.008, 117.812, 114.861, 115.923, 108.811, 109.354, 107.802,
                                     104.790, 107.689, 104.405, 104.046, 100.000, 96.3342, 95.7880,
                                     88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268,
                                     80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.3490, 61.6040,
                                     69.8856, 75.0870, 63.5927, 46.4182, 66.8054, 63.3828};
    ASSERT_EQ(d65.size(), nm.size());
    std::vector<double> f;
    for (std::size_t i = 0; i < nm.size(); ++i) {
        // CIE 15: 100 (560 / l)^5 (exp(1.435e7 / (2848 560)) - 1) / (exp(1.435e7 / (2848 l)) - 1)
        const double a = 100 * std::pow(560 / nm[i], 5) * std::expm1(1.435e7 / (2848 * 560)) /
                         std::expm1(1.435e7 / (2848 * nm[i]));
        f.push_back(a / d65[i]);
    }
    const auto xy = chromaticity(tristimulus(nm, f));
    EXPECT_NEAR(xy[0], 0.44758, 2e-4);  // f is linear between nodes 10 nm apart, A / D65 is not
    EXPECT_NEAR(xy[1], 0.40745, 2e-4);
}

TEST(Colour, spectrallyFlatSurfacesAreGrey) {
    for (const auto& nm : {range(400, 700, 10), range(420, 680, 65), range(380, 780, 1),
                           std::vector<double>{440, 500, 610, 650}, range(300, 2500, 100)}) {
        const RgbWeights weights = rgbWeights(nm);
        for (const auto& w : weights.weights)
            EXPECT_NEAR(std::accumulate(w.begin(), w.end(), 0.0), 1, 1e-12);
    }
}

// A reflectance of 1 at long wavelengths only is red; green and blue likewise.
TEST(Colour, primariesAreWhereTheyBelong) {
    const std::vector<double> nm = range(400, 700, 5);
    const RgbWeights weights = rgbWeights(nm);
    const auto rgb = [&](double from, double to) {
        std::array<double, 3> sum{};
        for (std::size_t i = 0; i < nm.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                if (nm[i] >= from && nm[i] < to) sum[c] += weights.weights[c][i];
        return sum;
    };
    const auto blue = rgb(400, 490), green = rgb(490, 580), red = rgb(580, 701);
    EXPECT_TRUE(red[0] > red[1] && red[0] > red[2]);
    EXPECT_TRUE(green[1] > green[0] && green[1] > green[2]);
    EXPECT_TRUE(blue[2] > blue[0] && blue[2] > blue[1]);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(red[c] + green[c] + blue[c], 1, 1e-12);
}

// Rec. ITU-R BT.709 item 3.2: luminance is 0.2126 R + 0.7152 G + 0.0722 B.
TEST(Colour, luminanceOfRgbIsY) {
    const std::vector<double> nm = range(400, 700, 10);
    const RgbWeights weights = rgbWeights(nm);
    for (std::size_t i = 0; i < nm.size(); ++i) {
        std::vector<double> f(nm.size(), 0.0);
        f[i] = 1;
        double y = 0, rounding = 0;
        constexpr double share[] = {0.2126, 0.7152, 0.0722};
        for (std::size_t c = 0; c < 3; ++c) {
            y += share[c] * weights.weights[c][i];
            rounding += 1e-4 * std::abs(weights.weights[c][i]);
        }
        EXPECT_NEAR(y, tristimulus(nm, f)[1], rounding);
    }
}

TEST(Colour, viewAppliesTheWeights) {
    const std::vector<double> nm = {420, 500, 560, 620, 700}, f = {0.1, 0.2, 0.7, 0.4, 0.3};
    const auto view = asRgb(std::make_unique<Flat>(nm, f));
    EXPECT_EQ(view->name(), "rgb:flat");
    EXPECT_EQ(view->channels().kind, Channels::Kind::rgb);
    EXPECT_TRUE(view->laws().reciprocal);
    const auto values = evaluate(*view, {0, 0, 1}, {0.6, 0, 0.8});
    const RgbWeights weights = rgbWeights(nm);
    for (std::size_t c = 0; c < 3; ++c) {
        double expected = 0;
        for (std::size_t i = 0; i < nm.size(); ++i) expected += weights.weights[c][i] * f[i];
        EXPECT_NEAR(values[c], expected, 1e-15);
    }
}

TEST(Colour, refusesWhatHasNoColour) {
    EXPECT_THROW(rgbWeights(std::vector<double>{450, 650}), UsageError);
    EXPECT_THROW(rgbWeights(range(550, 700, 10)), UsageError);
    EXPECT_THROW(rgbWeights(range(900, 1700, 100)), UsageError);
    class Grey : public Flat {
    public:
        Grey() : Flat({}, {1.0}) {}
        const Channels& channels() const override {
            static const Channels grey = Channels::grey();
            return grey;
        }
    };
    EXPECT_THROW(asRgb(std::make_unique<Grey>()), UsageError);
}

}  // namespace
}  // namespace hshfit
