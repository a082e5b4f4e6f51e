// Libraries that are learned with their materials on a disk.

#include <hshfit/error.h>
#include <hshfit/files/scratch_file.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/internal/vector_file.h>
#include <hshfit/material_library/learning.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/library_writer.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/material_library/material_store.h>
#include <temporary_file.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <utility>

namespace hshfit::material_library {
namespace {

const LogSpace& space() {
    static const LogSpace one;
    return one;
}

/// Grey, or in colours, with the numbers of `exponents` and others that nothing is made of.
Measured measured(const std::string& name, std::vector<float> exponents) {
    Measured one{
        .name = name, .source = "made " + name, .exponents = std::move(exponents), .tops = {}};
    const std::size_t channels = one.exponents.size() / logTerms().size();
    for (std::size_t c = 0; c < channels; ++c) one.tops.push_back(static_cast<float>(c) + 1.5F);
    one.error = {.meanLog = 0.01, .logError = 0.02, .largest = 1, .flip = 0.03};
    for (std::size_t n = 0; n < restRows; ++n) one.rest.push_back(static_cast<float>(n) / 100);
    return one;
}

Material ownForm(const std::string& name) {
    return {.name = name,
            .source = "own " + name,
            .kind = Kind::halfway,
            .channels = 3,
            .halfway = "{\"form\": \"" + name + "\"}",
            .bytes = 77,
            .fallback = "is anisotropic",
            .error = {.logError = 0.3, .flip = 0.2}};
}

std::vector<float> randomNumbers(std::size_t channels, std::mt19937& random) {
    std::normal_distribution<float> number(0, 0.1F);
    std::vector<float> numbers(channels * logTerms().size());
    for (float& one : numbers) one = number(random);
    return numbers;
}

TEST(MaterialStore, GivesBackMaterialsInTheOrderOfTheirNames) {
    std::mt19937 random(1);
    MaterialStore store(".");
    const Measured b = measured("b", randomNumbers(3, random)),
                   a = measured("a", randomNumbers(1, random));
    store.add(b);
    store.add(ownForm("d"));
    store.add(a);
    store.add(ownForm("aa"));
    store.sort();
    ASSERT_EQ(store.size(), 2u);
    ASSERT_EQ(store.ownForms(), 2u);
    EXPECT_EQ(store.channels(1), 3u);
    const Measured found = store.measured(1);
    EXPECT_EQ(store.measured(0).name, "a");
    EXPECT_EQ(found.source, "made b");
    EXPECT_EQ(found.exponents, b.exponents);
    EXPECT_EQ(found.tops, b.tops);
    EXPECT_EQ(found.rest, b.rest);
    EXPECT_EQ(found.error.flip, b.error.flip);
    const Material own = store.own(0);
    EXPECT_EQ(own.name, "aa");
    EXPECT_EQ(own.halfway, ownForm("aa").halfway);
    EXPECT_EQ(own.bytes, 77u);
    EXPECT_EQ(own.fallback, "is anisotropic");
    EXPECT_EQ(own.error.flip, 0.2);
}

/// Kilobytes of this process without mapped files.
long ownKilobytes() {
    std::ifstream status("/proc/self/status");
    std::string word;
    long value = -1;
    while (status >> word)
        if (word == "RssAnon:") status >> value;
    return value;
}

// 40,000 materials have 34 MB of numbers.
TEST(MaterialStore, HoldsNamesAloneInMemory) {
    std::mt19937 random(5);
    Measured one = measured("", randomNumbers(1, random));
    MaterialStore store(".");
    const long before = ownKilobytes();
    for (int n = 0; n < 40000; ++n) {
        one.name = fmt::format("m{:05}", n);
        one.tops[0] = static_cast<float>(n);
        store.add(one);
    }
    store.sort();
    EXPECT_LT(ownKilobytes() - before, 12000);
    EXPECT_EQ(store.measured(31234).tops[0], 31234.0F);
}

TEST(MaterialStore, RefusesTwoMaterialsOfOneName) {
    std::mt19937 random(2);
    for (int kind = 0; kind < 3; ++kind) {
        MaterialStore store(".");
        for (int n = 0; n < 2; ++n) {
            if (kind + n < 2)
                store.add(measured("twin", randomNumbers(1, random)));
            else
                store.add(ownForm("twin"));
        }
        EXPECT_THROW(store.sort(), UsageError) << kind;
    }
}

/// Terms that materials of the first, second and third block have, each block one of its own.
constexpr std::array<std::size_t, 3> termOfBlock{30, 60, 90};

// Every block has a direction of its own, which is no component if the block is left out, and the
// mean counts each material once.
TEST(Learning, SeesTheMaterialsOfEveryBlockOnce) {
    const std::size_t terms = logTerms().size(), count = 2 * materialsInBlock + 900;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> number(0, 1);
    MaterialStore store(".");
    std::vector<double> mean(terms, 0.0);
    for (std::size_t m = 0; m < count; ++m) {
        std::vector<float> numbers(terms, 0.0F);
        float& own = numbers[termOfBlock[m / materialsInBlock]];
        own = number(random);
        mean[termOfBlock[m / materialsInBlock]] +=
            static_cast<double>(own) / static_cast<double>(count);
        store.add(measured(fmt::format("m{:05}", m), numbers));
    }
    store.sort();
    // Numbers of one material in five, by other blocks, decide on nothing here.
    const Basis basis = learnBasis(space(), store, {.components = 3, .bytes = 30}).basis;
    ASSERT_EQ(basis.size(), 3u);
    for (std::size_t t = 0; t < terms; ++t) EXPECT_NEAR(basis.mean[t], mean[t], 1e-5) << t;
    const Eigen::Map<const Eigen::MatrixXd> components(basis.components.data(),
                                                       static_cast<Eigen::Index>(terms), 3);
    const Eigen::MatrixXd upper = space().samples().lower.transpose(), found = upper * components;
    for (const std::size_t term : termOfBlock) {
        const Eigen::VectorXd one = upper.col(static_cast<Eigen::Index>(term));
        const double rest =
            (one - found * (found.transpose() * found).ldlt().solve(found.transpose() * one))
                .norm();
        EXPECT_LT(rest, 0.01 * one.norm()) << term;
    }
}

std::string contentOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

// Forty materials in colours and own forms between them, through a disk and in memory.
TEST(LibraryWriter, WritesTheFileOfALibraryInMemory) {
    std::mt19937 random(4);
    std::vector<Measured> all;
    std::vector<Material> own;
    for (int n = 0; n < 40; ++n)
        all.push_back(
            measured(fmt::format("m{:02}", n), randomNumbers(n % 4 == 0 ? 1 : 3, random)));
    for (const char* name : {"a", "m07x", "m30x", "z"}) own.push_back(ownForm(name));
    const LearnOptions options{.components = 4, .bytes = 24};
    // Random numbers are far from a basis of four: some fall back.
    const Limits limits{.log = 0.8, .maximum = 10, .flip = 1};
    MaterialStore store(".");
    for (const Material& one : own) store.add(one);
    for (const Measured& one : all) store.add(one);
    store.sort();
    LibraryWriter writer(".");
    std::vector<std::string> names;
    const Library head = learn(space(), store, options, limits, [&](const Material& material) {
        writer.add(material);
        names.push_back(material.name);
    });
    EXPECT_EQ(names.size(), 44u);
    EXPECT_TRUE(std::ranges::is_sorted(names));
    const test::TemporaryFile streamed, whole;
    AtomicFile to(streamed.path());
    writer.write(head, {store.size(), [&](std::size_t k) { return store.measured(k); }}, to);
    to.commit();

    // The library as it was read is written again, from memory.
    const Library read = readLibrary(streamed.path());
    ASSERT_EQ(read.materials.size(), 44u);
    ASSERT_EQ(read.measured.size(), 40u);
    for (std::size_t n = 0; n < 40; ++n) {
        EXPECT_EQ(read.measured[n].exponents, all[n].exponents) << n;
        EXPECT_EQ(read.measured[n].rest, all[n].rest) << n;
    }
    EXPECT_EQ(find(read, "m30x")->halfway, ownForm("m30x").halfway);
    const auto polynomials = std::ranges::count(read.materials, Kind::polynomial, &Material::kind);
    EXPECT_GT(polynomials, 0);
    EXPECT_LT(polynomials, 40);
    AtomicFile again(whole.path());
    writeLibrary(read, again);
    again.commit();
    EXPECT_EQ(contentOf(whole.path()), contentOf(streamed.path()));
}

}  // namespace
}  // namespace hshfit::material_library
