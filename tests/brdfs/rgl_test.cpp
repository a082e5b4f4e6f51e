#include "places.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/rgl.h>

#include <brdfs/measured_files.h>
#include <brdfs/tensor_writer.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

namespace hshfit {
namespace {

using brdfs::RglBrdf;
using test::RglShape;

RglBrdf fromBytes(const std::string& bytes) {
    return RglBrdf({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, "memory");
}
RglBrdf synthetic(const RglShape& shape) {
    return fromBytes(test::tensorFile(test::rglFields(shape)));
}

// The formulas of Dupuy & Jakob 2018 again, slowly: distributions are integrated where they are
// asked for. Between its vertices a row is linear, and so are integrals over rows in the other
// direction: the midpoint rule over pieces that end at vertices is exact.
class Reference {
public:
    explicit Reference(const RglShape& shape) : shape_(shape) {
        for (const auto& field : test::rglFields(shape)) {
            if (field.type != 10) continue;
            std::vector<float> values(field.data.size() / 4);
            std::memcpy(values.data(), field.data.data(), field.data.size());
            fields_[field.name] = {field.shape, values};
        }
    }

    /// f cos(theta_o) per channel.
    std::vector<double> value(const Direction& wi, const Direction& wo) const {
        const double thetaIncident = polarAngle(wi), phiIncident = azimuth(wi);
        const Direction sum{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
        const bool isotropic = shape_.phi.size() <= 2;
        const double turned = azimuth(sum) - (isotropic ? phiIncident : 0);
        const double u = std::sqrt(2 * polarAngle(sum) / pi), v = wrapped(turned / (2 * pi) + 0.5);
        const auto density = [&](double a, double b) {
            return interpolate("vndf", phiIncident, thetaIncident, 0, a, b, true);
        };
        const double row =
            integral(u, shape_.normalColumns, [&](double a) { return density(a, v); });
        const double wholeRow =
            integral(1, shape_.normalColumns, [&](double a) { return density(a, v); });
        const double x = row / wholeRow;
        const double y = integral(v, shape_.normalRows, [&](double b) {
            return integral(1, shape_.normalColumns, [&](double a) { return density(a, b); });
        });
        std::vector<double> result(shape_.channels);
        const double factor =
            !shape_.jacobian
                ? 1
                : plane("ndf", u, v) / (4 * plane("sigma", std::sqrt(2 * thetaIncident / pi),
                                                  wrapped(phiIncident / (2 * pi) + 0.5)));
        for (std::size_t c = 0; c < result.size(); ++c) {
            result[c] = factor * interpolate(shape_.channels == 3 ? "rgb" : "spectra", phiIncident,
                                             thetaIncident, c, x, y, false);
        }
        return result;
    }

private:
    struct Values {
        std::vector<std::uint64_t> shape;
        std::vector<float> values;
    };

    static double wrapped(double v) { return v - std::floor(v); }

    template <class Function>
    static double integral(double end, std::uint64_t vertices, const Function& f) {
        double sum = 0;
        const double step = 1.0 / static_cast<double>(vertices - 1);
        for (std::uint64_t i = 0; i + 1 < vertices; ++i) {
            const double from = static_cast<double>(i) * step, to = std::min(end, from + step);
            if (to > from) sum += (to - from) * f((from + to) / 2);
        }
        return sum;
    }

    static double bilinear(const float* table, std::uint64_t rows, std::uint64_t columns, double u,
                           double v) {
        double sum = 0;
        for (std::uint64_t r = 0; r < rows; ++r)
            for (std::uint64_t c = 0; c < columns; ++c) {
                const double a =
                    std::fabs(u * static_cast<double>(columns - 1) - static_cast<double>(c));
                const double b =
                    std::fabs(v * static_cast<double>(rows - 1) - static_cast<double>(r));
                sum += table[r * columns + c] * std::max(0.0, 1 - a) * std::max(0.0, 1 - b);
            }
        return sum;
    }

    double plane(const std::string& name, double u, double v) const {
        const Values& field = fields_.at(name);
        return bilinear(field.values.data(), field.shape[0], field.shape[1], u, v);
    }

    /// Hat functions about every measured incident direction.
    static double hat(const std::vector<float>& nodes, std::size_t i, double at) {
        const double value = std::clamp<double>(at, nodes.front(), nodes.back());
        if (i > 0 && value < nodes[i]) {
            return std::max(0.0, (value - nodes[i - 1]) / (nodes[i] - nodes[i - 1]));
        }
        if (i + 1 < nodes.size() && value > nodes[i]) {
            return std::max(0.0, (nodes[i + 1] - value) / (nodes[i + 1] - nodes[i]));
        }
        return value == nodes[i] ? 1 : 0;
    }

    double interpolate(const std::string& name, double phi, double theta, std::size_t channel,
                       double u, double v, bool normalise) const {
        const Values& field = fields_.at(name);
        const std::uint64_t rows = field.shape[field.shape.size() - 2];
        const std::uint64_t columns = field.shape.back();
        const std::uint64_t channels = field.shape.size() == 5 ? field.shape[2] : 1;
        double sum = 0;
        for (std::size_t p = 0; p < shape_.phi.size(); ++p)
            for (std::size_t t = 0; t < shape_.theta.size(); ++t) {
                const double weight = hat(shape_.phi, p, phi) * hat(shape_.theta, t, theta);
                if (weight == 0) continue;
                const float* table =
                    field.values.data() +
                    ((p * shape_.theta.size() + t) * channels + channel) * rows * columns;
                double total = 1;
                if (normalise) {
                    total = integral(1, rows, [&](double b) {
                        return integral(1, columns, [&](double a) {
                            return bilinear(table, rows, columns, a, b);
                        });
                    });
                }
                sum += weight * bilinear(table, rows, columns, u, v) / total;
            }
        return sum;
    }

    RglShape shape_;
    std::map<std::string, Values> fields_;
};

std::vector<float> azimuths(double from, double to, int count) {
    std::vector<float> phi;
    for (int i = 0; i < count; ++i) {
        phi.push_back(static_cast<float>(radians(from + (to - from) * i / (count - 1))));
    }
    return phi;
}

void expectReference(const RglShape& shape, double lowestPhi, double highestPhi) {
    const RglBrdf brdf = synthetic(shape);
    const Reference reference(shape);
    std::mt19937 random(3);
    std::uniform_real_distribution<> phi(radians(lowestPhi), radians(highestPhi));
    std::uniform_real_distribution<> theta(0.01, 1.55);
    for (int i = 0; i < 100; ++i) {
        const Direction wi = directionFromAngles(theta(random), phi(random));
        const Direction wo = test::randomDirection(random);
        const std::vector<double> expected = reference.value(wi, wo), f = evaluate(brdf, wi, wo);
        ASSERT_EQ(f.size(), expected.size());
        for (std::size_t c = 0; c < f.size(); ++c) {
            EXPECT_NEAR(f[c] * wo.z, expected[c], 2e-6 * expected[c]);
        }
    }
}

TEST(Rgl, followsThePaperOnSyntheticTables) {
    expectReference({}, -180, 180);
    expectReference({.jacobian = false}, -180, 180);
    expectReference({.channels = 7}, -180, 180);
    expectReference({.channels = 70}, -180, 180);
    expectReference({.theta = {0.3F}}, -180, 180);
    expectReference({.phi = azimuths(-180, 180, 9)}, -180, 180);
    expectReference({.phi = azimuths(-180, 0, 5), .channels = 4}, -179.9, -0.1);
    expectReference({.phi = azimuths(-180, -90, 4)}, -179.9, -90.1);
    expectReference({.phi = azimuths(0, 90, 4)}, 0.1, 89.9);
}

TEST(Rgl, symmetriesCompleteTheCircle) {
    const RglBrdf half = synthetic({.phi = azimuths(-180, 0, 5)});
    const RglBrdf quarter = synthetic({.phi = azimuths(-180, -90, 4)});
    EXPECT_FALSE(half.laws().isotropic || half.laws().mirrorSymmetric);
    EXPECT_TRUE(quarter.laws().mirrorSymmetric);
    std::mt19937 random(4);
    double mirrorDefect = 0;
    for (int i = 0; i < 300; ++i) {
        const Direction wi = test::randomDirection(random), wo = test::randomDirection(random);
        const double f = evaluate(half, wi, wo)[0], g = evaluate(quarter, wi, wo)[0];
        EXPECT_NEAR(evaluate(half, mirrored(wi), mirrored(wo))[0], f, 1e-9 * f);
        EXPECT_NEAR(evaluate(quarter, mirrored(wi), mirrored(wo))[0], g, 1e-9 * g);
        const Direction mi{wi.x, -wi.y, wi.z}, mo{wo.x, -wo.y, wo.z};
        EXPECT_NEAR(evaluate(quarter, mi, mo)[0], g, 1e-9 * g);
        mirrorDefect = std::max(mirrorDefect, std::fabs(evaluate(half, mi, mo)[0] - f) / f);
    }
    EXPECT_GT(mirrorDefect, 0.1);  // and so it is not claimed
}

TEST(Rgl, isotropyIsClaimedOnlyWhereTheTablesHaveIt) {
    EXPECT_TRUE(synthetic({}).laws().isotropic);
    EXPECT_FALSE(synthetic({.phi = azimuths(-180, 180, 9)}).laws().isotropic);
    EXPECT_FALSE(synthetic({.phi = {0, 1}}).laws().isotropic);  // two azimuths that differ
    auto fields = test::rglFields({});
    for (auto& field : fields) {
        if (field.name == "sigma") field.data[0] ^= 1;
    }
    EXPECT_FALSE(fromBytes(test::tensorFile(fields)).laws().isotropic);
}

TEST(Rgl, keepsItsLaws) {
    const RglBrdf brdf = synthetic({});
    std::mt19937 random(5);
    for (int i = 0; i < 1000; ++i) {
        const Direction wi = test::randomDirection(random), wo = test::randomDirection(random);
        const double f = evaluate(brdf, wi, wo)[0], turn = 0.1 + i;
        EXPECT_GE(f, 0);
        EXPECT_NEAR(evaluate(brdf, rotateAboutZ(wi, turn), rotateAboutZ(wo, turn))[0], f, 1e-9 * f);
    }
}

TEST(Rgl, valuesAreFiniteUpToTheHorizonAndZeroBelow) {
    const RglBrdf brdf = synthetic({});
    for (const double z : {1e-3, 1e-8, 1e-15, 1e-300, 5e-324}) {
        const Direction low{std::sqrt(1 - z * z), 0, z};
        EXPECT_TRUE(std::isfinite(evaluate(brdf, {0, 0.6, 0.8}, low)[0]));
        EXPECT_TRUE(std::isfinite(evaluate(brdf, low, {0, 0.6, 0.8})[0]));
        EXPECT_TRUE(std::isfinite(evaluate(brdf, low, low)[0]));
        EXPECT_TRUE(std::isfinite(evaluate(brdf, mirrored(low), low)[0]));
    }
    EXPECT_EQ(evaluate(brdf, {0.6, 0, -0.8}, {0, 0, 1}), std::vector<double>(3, 0.0));
    EXPECT_EQ(evaluate(brdf, {0, 0, 1}, {1, 0, 0}), std::vector<double>(3, 0.0));
    EXPECT_TRUE(std::isfinite(evaluate(brdf, {0, 0, 1}, {0, 0, 1})[0]));
}

TEST(Rgl, batchesEqualSingleEvaluations) {
    for (const RglShape& shape :
         {RglShape{}, RglShape{.phi = azimuths(-180, 0, 5), .channels = 40}}) {
        const RglBrdf brdf = synthetic(shape);
        std::mt19937 random(6);
        const std::size_t count = 150, channels = shape.channels;
        std::vector<double> x, y, z, out(channels * count);
        for (std::size_t k = 0; k < count; ++k) {
            const Direction wi = test::randomDirection(random, -0.5);
            x.push_back(wi.x), y.push_back(wi.y), z.push_back(wi.z);
        }
        const Direction wo = test::randomDirection(random);
        brdf.eval(wo, {x.data(), y.data(), z.data(), count}, out.data());
        for (std::size_t k = 0; k < count; ++k) {
            const auto single = evaluate(brdf, {x[k], y[k], z[k]}, wo);
            for (std::size_t c = 0; c < channels; ++c) EXPECT_EQ(out[c * count + k], single[c]);
        }
    }
}

TEST(Rgl, spectralFilesHaveTheirWavelengths) {
    const RglBrdf brdf = synthetic({.channels = 4});
    EXPECT_EQ(brdf.channels().kind, Channels::Kind::spectral);
    EXPECT_EQ(brdf.channels().wavelengths, (std::vector<double>{400, 450, 500, 550}));
}

TEST(Rgl, negativeColoursBecomeZeroAfterInterpolation) {
    auto fields = test::rglFields({});
    for (auto& field : fields) {
        if (field.name != "rgb") continue;
        const std::vector<float> values(field.data.size() / 4, -0.5F);
        field.data = test::octetsOf(values);
    }
    EXPECT_EQ(evaluate(fromBytes(test::tensorFile(fields)), {0, 0, 1}, {0.6, 0, 0.8}),
              std::vector<double>(3, 0.0));
}

struct OracleRow {
    std::string file;
    Direction wi, wo;
    double value[3];
};

std::vector<OracleRow> oracleRows() {
    std::ifstream file(test::sharedFolder() + "/oracles/rgl_eval.csv");
    std::vector<OracleRow> rows;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::ranges::replace(line, ',', ' ');
        std::istringstream text(line);
        OracleRow row;
        text >> row.file >> row.wi.x >> row.wi.y >> row.wi.z >> row.wo.x >> row.wo.y >> row.wo.z >>
            row.value[0] >> row.value[1] >> row.value[2];
        EXPECT_TRUE(text) << line;
        rows.push_back(row);
    }
    return rows;
}

// The reference loader's values are f cos(theta_o), with its wi as the incident direction of the
// tables. It computes with 32-bit floats: all 160 rows agree to 1e-4, none has to be explained.
TEST(Rgl, agreesWithTheReferenceLoaderOnMeasuredFiles) {
    const std::string folder = test::sharedFolder() + "/data/rgl/";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
    const std::vector<OracleRow> rows = oracleRows();
    ASSERT_EQ(rows.size(), 160u);
    std::map<std::string, double> greatest;
    for (const OracleRow& row : rows) {
        greatest[row.file] = std::max(greatest[row.file], *std::ranges::max_element(row.value));
    }
    EXPECT_EQ(greatest.size(), 4u);
    double worst = 0;
    for (const auto& [name, most] : greatest) {
        const auto brdf = brdfs::open(folder + name);
        EXPECT_TRUE(brdf->laws().isotropic) << name;
        for (const OracleRow& row : rows) {
            if (row.file != name) continue;
            const std::vector<double> f = evaluate(*brdf, row.wi, row.wo);
            for (int c = 0; c < 3; ++c) {
                const double error = std::fabs(f[c] * row.wo.z - row.value[c]);
                EXPECT_LE(error, 1e-4 * row.value[c] + 1e-6 * most) << name << " channel " << c;
                if (row.value[c] > 1e-3 * most) worst = std::max(worst, error / row.value[c]);
            }
        }
    }
    EXPECT_LE(worst, 1e-4);
    std::cout << "worst relative difference where f > 1e-3 of the greatest: " << worst << "\n";
}

TEST(Rgl, polarimetricFilesAreRefusedByName) {
    const std::string path = test::sharedFolder() + "/data/rgl/spectralon_lowres.pbsdf";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    test::expectInputError([&] { RglBrdf::open(path); },
                           {path, "field M", "Mueller", "22 x 9 x 9 x 5 x 4 x 4"});
}

}  // namespace
}  // namespace hshfit
