// Matrices and trees written here are read with the conventions of docs/reference/bsdf_xml.md,
// derived a second time.

#include <hshfit/bases/catalog.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/projection/projection.h>

#include "bsdf_xml_files.h"

namespace hshfit {
namespace {

using namespace test;
using brdfs::AngleBasis;
using brdfs::BsdfSide;
using brdfs::KlemsBrdf;
using brdfs::TreeBrdf;

constexpr BsdfSide sides[] = {BsdfSide::front, BsdfSide::back};

std::string reflectionOf(BsdfSide side) {
    return side == BsdfSide::front ? "Reflection Front" : "Reflection Back";
}

TEST(AngleBases, PatchesAddUpToPiAndHoldWhatTheyClaim) {
    int bases = 0;
    for (const char* name : {"LBNL/Klems Full", "lbnl/klems half", "LBNL/Klems Quarter"}) {
        for (const AngleBasis& basis : brdfs::standardAngleBases(name)) {
            SCOPED_TRACE(basis.name + " " + std::to_string(basis.patches()));
            ++bases;
            double sum = 0;
            for (std::size_t ring = 0; ring < basis.rings().size(); ++ring) {
                sum += basis.projectedSolidAngle(ring) *
                       static_cast<double>(basis.rings()[ring].azimuths);
            }
            EXPECT_NEAR(sum, pi, 1e-14);
            // Counting directions of equal projected solid angle.
            std::vector<int> counts(basis.patches());
            const std::vector<Direction> grid = projectedGrid(4000, 720);
            for (const Direction& d : grid) ++counts.at(basis.patchOf(d.x, d.y, d.z));
            for (std::size_t patch = 0; patch < counts.size(); ++patch) {
                const double expected = basis.projectedSolidAngle(basis.ringOf(patch)) / pi;
                EXPECT_NEAR(counts[patch] / static_cast<double>(grid.size()), expected,
                            0.03 * expected + 2e-5)
                    << patch;
            }
        }
    }
    EXPECT_EQ(bases, 5);
    EXPECT_TRUE(brdfs::standardAngleBases("LBNL/Klems").empty());
}

void expectMatrix(const std::string& structure, const std::string& name,
                  const std::vector<KlemsRing>& rings, bool carried, BsdfSide side) {
    SCOPED_TRACE(structure + " " + name + " " + std::to_string(rings.size()));
    const int n = patchesOf(rings);
    const auto value = [](int o, int i) { return 0.5 + o + i / 1000.0; };
    const std::string xml =
        bsdfXml(structure, carried ? basisXml(name, rings) : "",
                blockXml(reflectionOf(side), matrixText(n, value, structure == "Rows"), name) +
                    blockXml("Transmission Front", "nonsense", name));
    const auto brdf = openBytes(xml, side);
    std::mt19937 random(7);
    int checked = 0;
    for (int k = 0; k < 3000; ++k) {
        const Direction wi = randomDirection(random), wo = randomDirection(random);
        // The incident patch is where the light goes.
        const int i = patchAt(rings, -fileX(side, wi.x), -wi.y, wi.z);
        const int o = patchAt(rings, fileX(side, wo.x), wo.y, wo.z);
        ASSERT_GE(std::min(i, o), 0);
        checked += std::abs(valueOf(*brdf, wi, wo) - value(o, i)) < 1e-6;
    }
    EXPECT_GE(checked, 2998) << "of 3000";  // rounding on an edge
    EXPECT_FALSE(brdf->laws().reciprocal);
    EXPECT_FALSE(brdf->laws().isotropic);
    EXPECT_EQ(valueOf(*brdf, {0, 0.6, -0.8}, {0, 0, 1}), 0);
    EXPECT_EQ(valueOf(*brdf, {0, 0, 1}, {1, 0, 0}), 0);
}

TEST(Klems, BothDataOrdersBothSidesAllBases) {
    for (const BsdfSide side : sides) {
        for (const char* structure : {"Columns", "Rows"}) {
            for (const bool carried : {false, true}) {
                expectMatrix(structure, "LBNL/Klems Half", klemsHalf, carried, side);
                expectMatrix(structure, "LBNL/Klems Half", klemsOldHalf, carried, side);
                expectMatrix(structure, "LBNL/Klems Quarter", klemsQuarter, carried, side);
            }
        }
        expectMatrix("Columns", "LBNL/Klems Full", klemsFull, false, side);
        // The file's own basis goes before the one known by that name.
        expectMatrix("Columns", "LBNL/Klems Full", {{0, 30, 1}, {30, 90, 4}}, true, side);
        expectMatrix("Rows", "Ours", {{0, 20, 3}, {20, 47.5, 6}, {47.5, 90, 10}}, true, side);
    }
}

TEST(Klems, AMirrorFillsTheDiagonal) {
    const auto brdf = openBytes(
        bsdfXml("Columns", "",
                blockXml("Reflection Front", matrixText(145, [](int o, int i) { return o == i; }),
                         "LBNL/Klems Full")));
    std::mt19937 random(1);
    for (int k = 0; k < 500; ++k) {
        const Direction wi = randomDirection(random);
        EXPECT_EQ(valueOf(*brdf, wi, mirrored(wi)), 1);
        if (wi.z < 0.9) {
            EXPECT_EQ(valueOf(*brdf, wi, wi), 0);
        }
    }
    EXPECT_TRUE(brdf->laws().reciprocal);
    EXPECT_TRUE(brdf->laws().mirrorSymmetric);
    EXPECT_FALSE(brdf->laws().isotropic);
    EXPECT_TRUE(brdf->laws().energyConserving);
}

TEST(Klems, BeyondABasisThatEndsEarlyNothingIsCovered) {
    const auto brdf = openBytes(bsdfXml("Columns", basisXml("Cap", {{0, 40, 1}, {40, 60, 2}}),
                                        blockXml("Reflection Front", "1 2 3 4 5 6 7 8 9", "Cap")));
    const Direction inside = directionFromAngles(0.9, 1), beyond = directionFromAngles(1.1, 1);
    unsigned char covered = 2;
    brdf->coverage(inside, {&inside.x, &inside.y, &inside.z, 1}, &covered);
    EXPECT_EQ(covered, 1);
    brdf->coverage(inside, {&beyond.x, &beyond.y, &beyond.z, 1}, &covered);
    EXPECT_EQ(covered, 0);
    EXPECT_EQ(valueOf(*brdf, beyond, inside), 0);
    EXPECT_EQ(valueOf(*brdf, inside, beyond), 0);
    EXPECT_GT(valueOf(*brdf, inside, inside), 0);
}

/// Moments with 1, x, y and z and the integral of f^2, each a closed form on a patch.
struct PatchSums {
    double energy = 0, one = 0, x = 0, y = 0, z = 0;
};

PatchSums patchSums(const std::vector<KlemsRing>& rings, const Brdf& brdf, const Direction& wo) {
    PatchSums sums;
    for (const KlemsRing& ring : rings) {
        const double low = radians(ring.lower), up = radians(ring.upper);
        const double step = 2 * pi / ring.azimuths;
        const double one = std::cos(low) - std::cos(up);
        const double across = (up - low) / 2 - (std::sin(2 * up) - std::sin(2 * low)) / 4;
        const double high = (std::pow(std::sin(up), 2) - std::pow(std::sin(low), 2)) / 2;
        for (int j = 0; j < ring.azimuths; ++j) {
            const double phi = j * step;
            const double middle = ring.azimuths == 1 ? low : (low + up) / 2;
            const double f = valueOf(brdf, directionFromAngles(middle, phi), wo);
            sums.energy += f * f * one * step;
            sums.one += f * one * step;
            sums.x += f * across * (std::sin(phi + step / 2) - std::sin(phi - step / 2));
            sums.y += f * across * (std::cos(phi - step / 2) - std::cos(phi + step / 2));
            sums.z += f * high * step;
        }
    }
    return sums;
}

TEST(Klems, ProjectionsAreSumsOverPatches) {
    const auto basis = bases::make("sh", 2);
    const Basis* const one[] = {basis.get()};
    const auto lopsided = [](int o, int i) { return 0.1 + (o * 31 + i * 17) % 23 / 100.0; };
    const auto mirror = [](int o, int i) { return o == i ? 1.0 : 0.0; };
    const std::pair<const char*, std::vector<KlemsRing>> files[] = {
        {"LBNL/Klems Full", klemsFull}, {"Ours", {{0, 20, 3}, {20, 47.5, 6}, {47.5, 90, 10}}}};
    for (const auto& [name, rings] : files) {
        for (const bool symmetric : {false, true}) {
            if (symmetric && patchesOf(rings) != 145) continue;
            const int patches = patchesOf(rings);
            const auto brdf = openBytes(bsdfXml(
                "Columns", basisXml(name, rings),
                blockXml("Reflection Front",
                         symmetric ? matrixText(patches, mirror) : matrixText(patches, lopsided),
                         name)));
            for (const double phi : {0.0, 1.0}) {
                const Direction wo = directionFromAngles(radians(52), phi);
                const PatchSums exact = patchSums(rings, *brdf, wo);
                const Projection found =
                    project(*brdf, one, OutgoingSet::direction(radians(52), phi))[0];
                const Coefficients& c = found.coefficients;
                EXPECT_NEAR(c.energy.value, exact.energy, 1e-9 * exact.energy);
                const double first = std::sqrt(1 / (4 * pi)), second = std::sqrt(3 / (4 * pi));
                const double expected[] = {first * exact.one, second * exact.y, second * exact.z,
                                           second * exact.x};
                for (int k = 0; k < 4; ++k)
                    EXPECT_NEAR(c.values[static_cast<std::size_t>(k)], expected[k],
                                1e-9 * exact.one)
                        << name << " " << k << " at " << phi;
                // Three levels of nodes in each cell of the pattern of patches; a million without
                // cuts.
                EXPECT_LE(found.evaluations, 60000U);
            }
        }
    }
}

TEST(Klems, ColoursAndPartsOfTheSpectrumAreRead) {
    const auto block = [](const char* wavelength, double value) {
        return blockXml("Reflection Front", matrixText(41, [value](int, int) { return value; }),
                        "LBNL/Klems Quarter", wavelength);
    };
    const std::string grey = bsdfXml("Columns", "",
                                     block("CIE-X", 0.25) + block("Visible", 0.25) +
                                         block("CIE-Z", 0.25) + block("Solar", 0.125));
    auto brdf = openBytes(grey);
    ASSERT_EQ(brdf->channels().count(), 3u);
    for (const double f : evaluate(*brdf, {0, 0, 1}, {0, 0, 1})) EXPECT_NEAR(f, 0.25, 1e-6);
    EXPECT_EQ(brdf->census().values, 3u * 41 * 41);
    // The red primary: x = 0.64, y = 0.33.
    brdf = openBytes(bsdfXml("Columns", "",
                             block("CIE-X", 0.64) + block("Visible", 0.33) + block("CIE-Z", 0.03)));
    const std::vector<double> red = evaluate(*brdf, {0, 0, 1}, {0, 0, 1});
    EXPECT_GT(red[0], 0.9);
    EXPECT_NEAR(red[1], 0, 1e-12);
    EXPECT_NEAR(red[2], 0, 1e-12);
    brdf = openBytes(grey, BsdfSide::front, "solar");
    EXPECT_EQ(brdf->channels().count(), 1u);
    EXPECT_EQ(valueOf(*brdf, {0, 0, 1}, {0, 0, 1}), 0.125);
    EXPECT_EQ(brdf->name(), "memory:wavelength=solar");
    expectInputError([&] { openBytes(grey, BsdfSide::back); },
                     {"memory: ", "Reflection Back", "Reflection Front Solar"});
    expectInputError([&] { openBytes(grey, BsdfSide::front, "nir"); }, {"nir", "Visible"});
}

/// A random tree, its text and its value at a point.
struct Tree {
    int rank = 4, steps = 0;
    std::vector<Tree> branches;
    std::vector<double> grid;

    static Tree make(int rank, int depth, std::mt19937& random) {
        Tree tree;
        tree.rank = rank;
        if (depth > 0 && random() % 3 != 0) {
            for (int k = 0; k < 1 << rank; ++k)
                tree.branches.push_back(make(rank, depth - 1, random));
            return tree;
        }
        tree.steps = static_cast<int>(random() % 3);
        for (int k = 0; k < 1 << rank * tree.steps; ++k) {
            tree.grid.push_back(static_cast<double>(random() % 10000) / 16384);
        }
        return tree;
    }
    std::string text() const {
        std::string inside = "{";
        for (const Tree& branch : branches) inside += branch.text() + (rank == 3 ? "," : "\n");
        for (const double value : grid) {
            inside += ' ';
            inside += std::to_string(value);
        }
        inside += " }";
        return inside;
    }
    double at(std::vector<double> p) const {
        std::size_t index = 0;
        for (int i = 0; i < rank; ++i) {
            if (branches.empty()) {
                index = index * (1u << steps) + static_cast<std::size_t>(p[i] * (1 << steps));
            } else if (p[i] >= 0.5) {
                index += 1u << i;
            }
        }
        if (branches.empty()) return grid[index];
        for (double& x : p) x = x >= 0.5 ? 2 * x - 1 : 2 * x;
        return branches[index].at(p);
    }
    /// Integral over the cube, and over the slab of the first coordinate below 1/2.
    double integral() const {
        double sum = 0;
        for (const Tree& branch : branches) sum += branch.integral();
        for (const double value : grid) sum += std::stod(std::to_string(value));
        return sum / static_cast<double>(branches.size() + grid.size());
    }
};

TEST(TensorTrees, RandomTreesAreReadAtTheirPoints) {
    std::mt19937 random(11);
    for (int round = 0; round < 12; ++round) {
        const int rank = 3 + round % 2;
        const BsdfSide side = sides[round / 2 % 2];
        const Tree tree = Tree::make(rank, 3, random);
        const auto brdf =
            openBytes(bsdfXml("TensorTree" + std::to_string(rank), "",
                              blockXml(reflectionOf(side), tree.text(), "LBNL/Shirley-Chiu")),
                      side);
        EXPECT_EQ(brdf->laws().isotropic, rank == 3);
        int right = 0;
        for (int k = 0; k < 2000; ++k) {
            const Direction wi = randomDirection(random), wo = randomDirection(random);
            const double x = -fileX(side, wi.x), y = -wi.y;
            std::vector<double> point;
            if (rank == 4) {
                const auto [a, b] = shirleyChiu(x, y);
                const auto [c, d] = shirleyChiu(fileX(side, wo.x), wo.y);
                point = {a, b, c, d};
            } else {
                const double turn = -std::atan2(y, x);
                const Direction turned = rotateAboutZ({fileX(side, wo.x), wo.y, wo.z}, turn);
                const auto [c, d] = shirleyChiu(turned.x, turned.y);
                point = {0.5 - 0.5 * std::hypot(x, y), c, d};
            }
            right += std::abs(valueOf(*brdf, wi, wo) - tree.at(point)) < 1e-6;
        }
        EXPECT_GE(right, 1998) << "of 2000, rank " << rank;
    }
}

TEST(TensorTrees, DirectionalReflectancesAreSumsOverLeaves) {
    std::mt19937 random(3);
    for (int round = 0; round < 6; ++round) {
        const Tree tree = Tree::make(4, 2, random);
        const auto brdf = openBytes(bsdfXml(
            "TensorTree4", "", blockXml("Reflection Front", tree.text(), "LBNL/Shirley-Chiu")));
        const auto& read = dynamic_cast<const TreeBrdf&>(*brdf);
        double mean = 0;
        const std::vector<double> reflectances = read.directionalReflectances();
        for (const double r : reflectances) mean += r / static_cast<double>(reflectances.size());
        EXPECT_NEAR(mean, pi * tree.integral(), 1e-12);
        // By evaluation, for light that goes to the middle of a cell.
        const auto side = static_cast<std::size_t>(std::lround(std::sqrt(reflectances.size())));
        const std::vector<Direction> grid = projectedGrid(150, 240);
        for (int k = 0; k < 5; ++k) {
            const Direction wi = randomDirection(random);
            const auto [u, v] = shirleyChiu(wi.x, -wi.y);
            const std::size_t cell = static_cast<std::size_t>(u * static_cast<double>(side)) +
                                     side * static_cast<std::size_t>(v * static_cast<double>(side));
            EXPECT_NEAR(reflectanceFrom(*brdf, wi, grid), reflectances[cell],
                        0.02 * reflectances[cell] + 1e-4);
        }
    }
}

TEST(TensorTrees, ColoursOfNeutralTreesAreGrey) {
    const auto block = [](const char* wavelength, const char* data) {
        return blockXml("Reflection Front", data, "LBNL/Shirley-Chiu", wavelength);
    };
    // x = y = 1/3: u' = 4/19, v' = 9/19 (CIE 1976).
    const auto brdf =
        openBytes(bsdfXml("TensorTree4", "",
                          block("Visible", "{ 0.25 }") + block("CIE-u", "{ 0.21052631578947367 }") +
                              block("CIE-v", "{0.47368421052631576}")));
    for (const double f : evaluate(*brdf, {0, 0.6, 0.8}, {0, 0, 1})) EXPECT_NEAR(f, 0.25, 1e-12);
    EXPECT_EQ(brdf->channels().count(), 3u);
}

TEST(BsdfXml, BadValuesAreCountedAndRefusedOnlyWhenTheyAreUsed) {
    const auto brdf =
        openBytes(bsdfXml("Columns", basisXml("Two", {{0, 45, 1}, {45, 90, 1}}),
                          blockXml("Reflection Front", "nan 0.5\n-0.25\n0.75", "Two")));
    const brdfs::Census census = brdf->census();
    EXPECT_EQ(census.notANumber, 1u);
    EXPECT_EQ(census.negative, 1u);
    EXPECT_EQ(census.least, -0.25);
    EXPECT_EQ(census.greatest, 0.75);
    const Direction up, low = directionFromAngles(1.2, 0);
    EXPECT_EQ(valueOf(*brdf, up, up), 0);
    EXPECT_EQ(valueOf(*brdf, low, up), 0.5);
    EXPECT_EQ(valueOf(*brdf, up, low), 0);
    unsigned char covered[2] = {2, 2};
    const double x[] = {up.x, low.x}, y[] = {up.y, low.y}, z[] = {up.z, low.z};
    brdf->coverage(up, {x, y, z, 2}, covered);
    EXPECT_EQ(covered[0], 0);
    EXPECT_EQ(covered[1], 1);
    expectInputError([&] { brdf->checkIntact(); }, {"memory: line ", "NaN or infinite"});
    EXPECT_NO_THROW(brdf->checkReadable());
}

}  // namespace
}  // namespace hshfit
