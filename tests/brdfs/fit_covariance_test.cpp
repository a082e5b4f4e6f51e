// Generalised least squares by a stated covariance: against dense algebra, against the chi-square
// distribution, and files of correlations with mistakes.

#include "temporary_file.h"

#include <brdfs/campaigns.h>
#include <brdfs/catalog.h>
#include <brdfs/fit/contributions.h>
#include <brdfs/fit/fit.h>
#include <brdfs/instrument_scans.h>
#include <brdfs/random_draws.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double angleLength = 20, wavelengthLength = 80;  // degrees, nm

FitSamples noisyScans() {
    FitSamples samples = test::exactSweeps({20, 45}, {500, 560, 600});
    std::mt19937_64 random(46);
    for (std::size_t v = 0; v < samples.values.size(); ++v)
        samples.values[v] += samples.sigmas[v] * test::normal(random);
    return samples;
}

/// C, value by value, as docs/fit.md states it.
Matrix covarianceByHand(const FitSamples& samples) {
    const std::size_t count = samples.size();
    const auto n = static_cast<Eigen::Index>(samples.values.size());
    Matrix c(n, n);
    for (std::size_t v = 0; v < samples.values.size(); ++v)
        for (std::size_t w = 0; w < samples.values.size(); ++w) {
            const std::size_t j = v % count, k = w % count;
            // acos of 1 less its rounding is 1e-8.
            const double apart =
                j == k ? 0 : std::acos(std::clamp(dot(samples.wo[j], samples.wo[k]), -1.0, 1.0));
            const auto& nm = samples.channels.wavelengths;
            const double r = std::exp(-apart / radians(angleLength)) *
                             std::exp(-std::abs(nm[v / count] - nm[w / count]) / wavelengthLength);
            c(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(w)) =
                samples.scans[j] == samples.scans[k] ? samples.sigmas[v] * samples.sigmas[w] * r
                                                     : 0;
        }
    return c;
}

/// f of a colour of 1 for each coefficient, kd and then ks of each wavelength.
Matrix designOf(const FitSamples& samples) {
    const std::size_t count = samples.size(), channels = samples.channels.count();
    Matrix x = Matrix::Zero(static_cast<Eigen::Index>(samples.values.size()),
                            static_cast<Eigen::Index>(2 * channels));
    for (std::size_t term = 0; term < 2; ++term) {
        const auto own =
            valuesOf(*open(term == 0 ? "lambert:kd=1" : "ggx:ks=1,F0=.9,alpha=.15"), samples);
        for (std::size_t v = 0; v < own.size(); ++v)
            x(static_cast<Eigen::Index>(v),
              static_cast<Eigen::Index>(term * channels + v / count)) = own[v];
    }
    return x;
}

FitOptions linearFit() {
    FitOptions options{.model = "lambert + ggx:F0=.9,alpha=.15", .loss = Loss::Kind::l2};
    options.uncertainty.report = true;
    return options;
}

std::string rowText(const Matrix& matrix, Eigen::Index i) {
    const Vector row = matrix.row(i);
    return fmt::format("[{}]", fmt::join(row.data(), row.data() + row.size(), ","));
}

std::string blockText(const std::vector<double>& nodes, double length) {
    const auto n = static_cast<Eigen::Index>(nodes.size());
    Matrix matrix(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)  // a variance of 4
            matrix(i, j) = 4 * std::exp(-std::abs(nodes[static_cast<std::size_t>(i)] -
                                                  nodes[static_cast<std::size_t>(j)]) /
                                        length);
    std::vector<std::string> rows;
    for (Eigen::Index i = 0; i < n; ++i) rows.push_back(rowText(matrix, i));
    return fmt::format(R"({{"nodes": [{}], "matrix": [{}]}})", fmt::join(nodes, ","),
                       fmt::join(rows, ","));
}

std::string fileText(const std::string& blocks) {
    return R"({"format": "hshfit-covariance", "version": 1, )" + blocks + "}";
}

const std::vector<double>& polarAngles() {
    static const std::vector<double> angles = [] {
        std::vector<double> result;
        for (int theta = -70; theta <= 70; theta += 5) result.push_back(theta);
        return result;
    }();
    return angles;
}

void expectDense(const FitSamples& samples, const FitResult& result) {
    const Matrix c = covarianceByHand(samples), x = designOf(samples);
    const Vector y = Eigen::Map<const Vector>(samples.values.data(), c.rows());
    const Matrix weights = c.inverse(), covariance = (x.transpose() * weights * x).inverse();
    const Vector expected = covariance * x.transpose() * weights * y, left = y - x * expected;
    ASSERT_EQ(result.parameters.size(), 6u);
    for (Eigen::Index i = 0; i < 6; ++i) {
        const auto p = static_cast<std::size_t>(i);
        const double error = std::sqrt(covariance(i, i));
        EXPECT_NEAR(result.parameters[p].value, expected(i), 1e-8 * expected(i));
        EXPECT_NEAR(*result.parameters[p].standardError, error, 1e-8 * error);
        for (Eigen::Index j = 0; j < 6; ++j)
            EXPECT_NEAR(result.correlations[p * 6 + static_cast<std::size_t>(j)],
                        covariance(i, j) / error / std::sqrt(covariance(j, j)), 1e-8);
    }
    const double chiSquare = left.dot(weights * left);
    EXPECT_NEAR(result.uncertainty->chiSquare, chiSquare, 1e-8 * chiSquare);
    EXPECT_EQ(result.uncertainty->degreesOfFreedom, samples.values.size() - 6);
    EXPECT_TRUE(result.uncertainty->probability);
    EXPECT_NEAR(result.aic, chiSquare + 12, 1e-8 * chiSquare);
}

TEST(GeneralisedLeastSquares, AgreesWithDenseAlgebra) {
    FitSamples samples = noisyScans();
    samples.correlation = parseSigma(fmt::format("1%,correlation:angle={},wavelength={}",
                                                 angleLength, wavelengthLength))
                              .correlation;
    FitOptions options = linearFit();
    options.contributions = {parseCalibration("0.8%")};
    const FitResult result = fit(samples, options);
    // A change of the scale changes each coefficient by as much, whatever the weights.
    for (const ParameterBudget& own : result.budget->parameters)
        EXPECT_NEAR(own.rows[1].sensitivity, own.value, 1e-8 * own.value);
    options.contributions.clear();
    expectDense(samples, fit(samples, options));
    const FitResult independent = fit(noisyScans(), options);
    // The weights matter: by far more than the agreement with algebra.
    EXPECT_GT(std::abs(result.parameters[0].value - independent.parameters[0].value),
              1e-5 * result.parameters[0].value);
}

TEST(GeneralisedLeastSquares, TakesAFileOfCovariances) {
    const FitSamples noisy = noisyScans();
    const std::string wavelengths =
        R"("wavelength": )" + blockText({450, 500, 560, 600}, wavelengthLength);
    const std::string angles = R"("angle": )" + blockText(polarAngles(), angleLength);
    FitSamples samples = noisy;
    for (std::size_t k = 0; k < samples.size(); ++k)
        samples.scanPlaces.push_back(k % polarAngles().size());
    std::string rows = R"("scan": )" + blockText(polarAngles(), angleLength);
    const std::size_t nodes = rows.find(R"("nodes")");
    rows.erase(nodes, rows.find(R"("matrix")") - nodes);
    for (const std::string& along : {angles, rows}) {
        const test::TemporaryFile file(fileText(wavelengths + "," + along), ".json");
        samples.correlation = parseSigma("1%,covariance=" + file.path()).correlation;
        expectDense(samples, fit(samples, linearFit()));
    }
}

// Probabilities of the right model are even over 0 to 1: the Kolmogorov-Smirnov distance of 400 is
// below 1.95 / sqrt(400) in 999 of 1000 cases.
TEST(GeneralisedLeastSquares, HasAChiSquareOfItsDistribution) {
    const auto all = test::campaigns();
    for (const char* name : {"correlated angles", "correlated wavelengths"}) {
        const auto own = std::ranges::find(all, name, &test::Campaign::name);
        ASSERT_NE(own, all.end());
        constexpr std::size_t repeats = 400;
        std::vector<double> probabilities(repeats);
        tbb::parallel_for(std::size_t{0}, repeats, [&](std::size_t r) {
            const FitResult result = fit(own->measured(9000 + r), own->options);
            probabilities[r] = *result.uncertainty->probability;
        });
        std::ranges::sort(probabilities);
        double distance = 0;
        for (std::size_t r = 0; r < repeats; ++r)
            for (const double share : {double(r) / repeats, double(r + 1) / repeats})
                distance = std::max(distance, std::abs(probabilities[r] - share));
        EXPECT_LT(distance, 1.95 / std::sqrt(double(repeats))) << name;
    }
}

void expectRefused(const std::string& text, const std::vector<std::string>& parts) {
    const test::TemporaryFile file(text, ".json");
    std::vector<std::string> all = parts;
    all.push_back(file.path());
    test::expectInputError([&] { parseSigma("1%,covariance=" + file.path()); }, all);
}

TEST(CovarianceFile, NamesBlockAndRowOfAMistake) {
    const auto wavelength = [](const std::string& nodes, const std::string& matrix) {
        return fileText(
            fmt::format(R"("wavelength": {{"nodes": {}, "matrix": {}}})", nodes, matrix));
    };
    expectRefused(wavelength("[500,600]", "[[1,0.5],[0.4,1]]"), {"wavelength", "row 1", "0.4"});
    expectRefused(wavelength("[500,600]", "[[1,0.5]]"), {"wavelength", "matrix"});
    expectRefused(wavelength("[500,600]", "[[1,0.5],[0.5]]"), {"wavelength", "matrix"});
    expectRefused(wavelength("[500,600]", "[[1,1],[1,1]]"), {"row 2", "not positive definite"});
    expectRefused(wavelength("[500,600]", "[[1,0],[0,0]]"), {"row 2", "diagonal"});
    expectRefused(wavelength("[600,500]", "[[1,0],[0,1]]"), {"nodes", "ascending"});
    expectRefused(wavelength("[500]", "[[\"x\"]]"), {"matrix"});
    expectRefused(fileText(R"("wavelengths": {})"), {"wavelengths", "unknown", "angle"});
    expectRefused(
        fileText(R"("angle": {"nodes": [0], "matrix": [[1]]}, "scan": {"matrix": [[1]]})"),
        {"scan", "angle"});
    expectRefused(R"({"format": "hshfit-covariance", "version": 1})", {"no block"});
    expectRefused("{", {});
    EXPECT_THROW(parseSigma("1%,covariance="), UsageError);
    EXPECT_THROW(parseSigma(",covariance=x.json"), UsageError);
    try {
        parseSigma("1%,covarance=x.json");
        ADD_FAILURE() << "a misspelt key was taken";
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("',covariance=FILE'"), std::string::npos);
    }
}

TEST(CovarianceFile, HasToMatchTheData) {
    FitSamples samples = noisyScans();
    for (std::size_t k = 0; k < samples.size(); ++k)
        samples.scanPlaces.push_back(k % polarAngles().size());
    const auto refused = [&](const std::string& blocks, const std::vector<std::string>& parts) {
        const test::TemporaryFile file(fileText(blocks), ".json");
        samples.correlation = parseSigma("1%,covariance=" + file.path()).correlation;
        test::expectInputError([&] { fit(samples, linearFit()); }, parts);
    };
    refused(R"("wavelength": )" + blockText({500, 560}, 20), {"wavelength", "600 nm"});
    refused(R"("angle": )" + blockText({-70, 0, 70}, 20), {"angle", "-65 degrees", "sample 2"});
    refused(R"("scan": {"matrix": [[1]]})", {"scan", "1 rows", "scan 1 has 29"});
}

TEST(GeneralisedLeastSquares, RefusesErrorsThatDetermineEachOther) {
    FitSamples samples = noisyScans();
    std::ranges::fill(samples.scans, 0);  // both scans have the same outgoing directions
    samples.correlation = {.angle = 0.1};
    EXPECT_THROW(fit(samples, linearFit()), UsageError);
}

}  // namespace
}  // namespace hshfit::brdfs
