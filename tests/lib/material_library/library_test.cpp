// A library against materials that are sums of its terms, so that what it has to find is known.

#include <hshfit/error.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/library.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/log_terms.h>
#include <temporary_file.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <utility>

namespace hshfit::material_library {
namespace {

/// The limits of a library but for FLIP, whose pictures take most of the time.
constexpr Limits noPictures{.flip = 1};

const LogSpace& space() {
    static const LogSpace one;
    return one;
}

/// A material whose exponents are a fixed part and `numbers` times single terms.
LogBrdf madeOf(const std::vector<double>& numbers, double level = -2) {
    LogMaterial material{std::vector<double>(logTerms().size(), 0.0), {3.0}};
    for (std::size_t t = 0; t < logTerms().size(); ++t)
        if (t >= 40 && t < 40 + numbers.size()) material.exponents[t] = numbers[t - 40];
    // The constant is the only term that is the same everywhere.
    std::vector<double> here(logTerms().size()), there(logTerms().size());
    logTerms().evaluate({0, 0, 1}, {0, 0, 1}, here.data());
    const Direction low = directionFromAngles(1.4, 2);
    logTerms().evaluate(low, directionFromAngles(0.9, 0), there.data());
    for (std::size_t t = 0; t < logTerms().size(); ++t)
        if (here[t] == 1 && there[t] == 1) material.exponents[t] = level;
    return LogBrdf(std::move(material), "made");
}

/// Members of a family of two numbers.
std::vector<Measured> family(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-0.4, 0.4);
    std::vector<Measured> all;
    for (std::size_t n = 0; n < count; ++n) {
        const double a = number(random), b = number(random);
        all.push_back(space().project(madeOf({a, b}), fmt::format("m{}", 1000 + n), "made"));
    }
    return all;
}

std::string bytesOf(const Library& library, const std::string& path) {
    AtomicFile file(path);
    writeLibrary(library, file);
    file.commit();
    std::ifstream in(path, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

TEST(LogSpace, ProjectionOfSumsOfTermsIsExact) {
    const LogBrdf brdf = madeOf({0.3, -0.2});
    const Measured measured = space().project(brdf, "a", "made");
    EXPECT_LT(measured.error.logError, 1e-4);
    EXPECT_LT(measured.error.maximum, 1e-3);
}

TEST(Codes, RoundToHalfAStepAndKeepTheBoundAboveTheGreatestValue) {
    Basis basis{.mean = {0}, .components = {1, 1, 1}, .widths = {2, 5, 16}, .step = 0.25};
    const std::vector<double> coordinates{0.26, -3.6, 1000.1};
    const std::vector<std::uint8_t> code = pack(basis, coordinates, 1.234);
    EXPECT_EQ(code.size(), 1u + 3u);  // 23 bits
    const ChannelCode back = unpack(basis, code);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(back.coordinates[k], coordinates[k], 0.125 + 1e-12);
    EXPECT_GE(back.top, 1.234);
    EXPECT_LE(back.top, 1.234 + 1.0 / 12);
    // Beyond the width the nearest number is taken.
    EXPECT_EQ(unpack(basis, pack(basis, std::vector<double>{9, 9, 0}, 0)).coordinates[0], 0.25);
}

TEST(Codes, HaveScalesOfTheirOwn) {
    const std::vector<double> scales{0.5, 0.75, 1, 1.5};
    ASSERT_EQ(scales.size(), scaleCodes);
    EXPECT_EQ(scales[plainScale], 1);
    const Basis basis{
        .mean = {0}, .components = {1, 1, 1}, .widths = {2, 5, 16}, .step = 0.25, .scaled = true};
    EXPECT_EQ(basis.channelBytes(), 1u + 4u);  // 2 and 23 bits
    for (unsigned code = 0; code < scaleCodes; ++code) {
        const double step = 0.25 * scales[code];
        const std::vector<double> coordinates{-step, 15 * step, 4000.4 * step};
        const ChannelCode back = unpack(basis, pack(basis, coordinates, 1.2, code));
        EXPECT_EQ(back.scale, code);
        EXPECT_EQ(back.coordinates[0], -step);
        EXPECT_EQ(back.coordinates[1], 15 * step);
        EXPECT_NEAR(back.coordinates[2], 4000 * step, 1e-9);
    }
}

/// A material of twelve normal numbers of falling spread.
LogBrdf ofTwelve(std::mt19937& random) {
    std::normal_distribution<double> number;
    LogMaterial material = madeOf({}).material();
    for (std::size_t n = 0; n < 12; ++n)
        material.exponents[20 + 11 * n] += 0.4 * number(random) / static_cast<double>(n + 1);
    return LogBrdf(std::move(material), "made");
}

/// The cost that codes are made for, over all pairs: of errors d of the exponents of a grey
/// material.
double costOf(const LogMaterial& material, const Eigen::VectorXd& d) {
    const LogSamples& samples = space().samples();
    const Eigen::Map<const Eigen::VectorXd> exponents(material.exponents.data(), d.size());
    const Eigen::VectorXd logs = samples.terms * exponents, errors = samples.terms * d;
    double peaks = 0, weight = 0;
    for (std::size_t n = 0; n < samples.pairs.size(); ++n) {
        const auto k = static_cast<Eigen::Index>(n);
        const double f = std::exp(std::min(logs[k], material.tops[0])) - logOffset;
        const double u = samples.pairs.weights[n] * std::pow(f * samples.pairs.z[n], 2);
        peaks += u * errors[k] * errors[k];
        weight += u;
    }
    const Eigen::VectorXd seen = (samples.seen.terms * d).cwiseAbs2();
    const Eigen::MatrixXd lit = samples.seen.logs(material);
    return d.dot(samples.metric * d) + peaks / weight +
           2 * samples.seen.weights(lit).col(0).dot(seen) +
           48 * samples.seen.colours(lit).col(0).dot(seen);
}

TEST(Codes, AreTheBestOfTheirNeighbours) {
    std::mt19937 random(8);
    std::vector<Measured> all;
    for (int n = 0; n < 12; ++n)
        all.push_back(space().project(ofTwelve(random), fmt::format("m{}", 100 + n), "made"));
    const Library library = learn(space(), std::move(all), {}, {.components = 3, .bytes = 9},
                                  {.log = 10, .maximum = 10, .flip = 1});
    const Basis& basis = library.basis;
    ASSERT_EQ(basis.size(), 3u);
    for (int trial = 0; trial < 4; ++trial) {
        const LogMaterial material = space().project(ofTwelve(random), "x", "made").material();
        const std::vector<std::uint8_t> code = Encoder(basis, space()).encode(material, 3);
        const ChannelCode channel = unpack(basis, code);
        const std::vector<double>& found = channel.coordinates;
        const double step = stepScale(channel.scale) * basis.step;
        double least = 0, ours = 0;
        for (int n = 0; n < 27; ++n) {
            std::vector<double> near = found;
            for (int k = 0, rest = n; k < 3; ++k, rest /= 3)
                near[static_cast<std::size_t>(k)] += step * (rest % 3 - 1);
            const LogMaterial decoded =
                decode(basis, pack(basis, near, material.tops[0], channel.scale));
            Eigen::VectorXd d(static_cast<Eigen::Index>(logTerms().size()));
            for (std::size_t t = 0; t < logTerms().size(); ++t)
                d[static_cast<Eigen::Index>(t)] = decoded.exponents[t] - material.exponents[t];
            const double cost = costOf(material, d);
            least = n == 0 ? cost : std::min(least, cost);
            if (n == 13) ours = cost;
        }
        EXPECT_LE(ours, 1.02 * least) << trial;
    }
}

TEST(Codes, ScalesServeMaterialsNearTheMeanAndBeyondTheOthers) {
    const Library library = learn(space(), family(24, 11), {}, {.components = 2, .bytes = 9},
                                  {.log = 10, .maximum = 10, .flip = 1});
    ASSERT_TRUE(library.basis.scaled);
    Basis plain = library.basis;
    plain.scaled = false;
    const Encoder encoder(library.basis, space()), withoutScales(plain, space());
    // Numbers of the family are up to 0.4.
    for (const double size : {0.06, 0.6}) {
        double error = 0, errorWithout = 0, scales = 0;
        for (int n = 0; n < 8; ++n) {
            const double angle = 0.3 + n * pi / 4;
            const LogMaterial material =
                space()
                    .project(madeOf({size * std::cos(angle), size * std::sin(angle)}), "x", "made")
                    .material();
            const std::vector<std::uint8_t> code = encoder.encode(material, 2);
            scales += stepScale(unpack(library.basis, code).scale) / 8;
            error += distance(space(), material, decode(library.basis, code));
            errorWithout +=
                distance(space(), material, decode(plain, withoutScales.encode(material, 2)));
        }
        EXPECT_LT(error, 0.9 * errorWithout) << size;
        if (size < 0.4)
            EXPECT_LT(scales, 0.9);
        else
            EXPECT_GT(scales, 1.1);
    }
}

TEST(Learning, FindsTheTwoNumbersOfAFamily) {
    const std::vector<Measured> all = family(24, 1);
    LearnedBasis learned;
    const Library library = learn(space(), all, {}, {.bytes = 30}, noPictures, &learned);
    EXPECT_LE(library.basis.size(), 20u);
    for (const Material& material : library.materials) {
        EXPECT_EQ(material.kind, Kind::coded);
        EXPECT_EQ(material.bytes, library.basis.channelBytes());
        EXPECT_LE(material.bytes, 10u);
        EXPECT_LT(material.error.logError, 0.02) << material.name;
    }
    // A member that took no part, against its own values.
    const LogBrdf fresh = madeOf({0.15, -0.33});
    const Material encoded =
        encode(library, space(), space().project(fresh, "x", "made"), 512, &fresh);
    EXPECT_EQ(encoded.kind, Kind::coded);
    EXPECT_LT(encoded.error.logError, 0.02);
    const auto brdf = open(library, encoded, "x");
    const Direction wi = directionFromAngles(0.7, 1), wo = directionFromAngles(0.4, 3);
    const double f = evaluate(fresh, wi, wo)[0];
    EXPECT_NEAR(evaluate(*brdf, wi, wo)[0], f, 0.05 * (f + logOffset));
}

TEST(Learning, OneStrangerAmongManyChangesLittle) {
    std::vector<Measured> all = family(24, 2);
    const Library before = learn(space(), all, {}, {.components = 2, .bytes = 30}, noPictures);
    LogBrdf stranger = madeOf({0, 0, 0, 0, 0, 0, 0, 2.5, -2}, 0);
    all.push_back(space().project(stranger, "stranger", "made"));
    LearnedBasis learned;
    const Library after =
        learn(space(), all, {}, {.components = 2, .bytes = 30}, noPictures, &learned);
    EXPECT_EQ(learned.doubted, 1u);
    for (const Material& material : before.materials) {
        const Material* again = find(after, material.name);
        ASSERT_NE(again, nullptr);
        EXPECT_LT(again->error.logError, material.error.logError + 0.02) << material.name;
    }
    EXPECT_EQ(find(after, "stranger")->kind, Kind::polynomial);
}

TEST(Limits, TheFirstThatIsExceededIsNamed) {
    const FormError error{.logError = 0.1, .maximum = 2, .largest = 10, .flip = 0.05};
    EXPECT_DOUBLE_EQ(error.maximumShare(), 0.2);
    EXPECT_EQ(FormError{}.maximumShare(), 0);
    EXPECT_EQ(beyond(error, {.log = 0.1, .maximum = 0.2, .flip = 0.05}), "");
    EXPECT_NE(beyond(error, {.log = 0.09}).find("ln(f + 0.001) of 0.1, limit 0.09"),
              std::string::npos);
    EXPECT_NE(beyond(error, {.maximum = 0.19}).find("f cos, of 0.2, limit 0.19"),
              std::string::npos);
    EXPECT_NE(beyond(error, {.flip = 0.04}).find("FLIP of 0.05, limit 0.04"), std::string::npos);
    FormError slight = error;
    slight.flip = 0.100021;
    EXPECT_NE(beyond(slight, {.flip = 0.1}).find("FLIP of 0.10002, limit 0.1"), std::string::npos);
}

TEST(Limits, MaterialsBeyondOneKeepTheirOwnFormAndSayWhy) {
    const std::vector<Measured> all = family(4, 8);
    const std::vector<std::pair<Limits, std::string>> each{
        {{.log = 0, .flip = 1}, "ln(f + 0.001)"},
        {{.log = 10, .maximum = 0, .flip = 1}, "largest f cos"},
        {{.log = 10, .maximum = 10, .flip = 0}, "FLIP"}};
    for (const auto& [limits, word] : each) {
        const Library library = learn(space(), all, {}, {.components = 1, .bytes = 6}, limits);
        for (const Material& material : library.materials) {
            EXPECT_EQ(material.kind, Kind::polynomial) << word;
            EXPECT_NE(material.fallback.find(word), std::string::npos) << material.fallback;
        }
        const test::TemporaryFile file("");
        bytesOf(library, file.path());
        const Library again = readLibrary(file.path());
        EXPECT_EQ(again.limits, limits);
        EXPECT_EQ(again.materials[2].fallback, library.materials[2].fallback);
    }
}

TEST(Learning, StatesThePictureErrorOfMaterialsThatTookNoPart) {
    LearnedBasis learned;
    // Four bits of two numbers are seen, and sixteen are not.
    learn(space(), family(10, 9), {}, {.components = 2, .bytes = 30}, {}, &learned);
    EXPECT_GT(learned.unseenFlip, 0);
    EXPECT_LT(learned.unseenFlip, 0.01);
    const double fine = learned.unseenFlip;
    learn(space(), family(10, 9), {}, {.components = 2, .bytes = 6}, {}, &learned);
    EXPECT_GT(learned.unseenFlip, 2 * fine);
    learn(space(), family(10, 9), {}, {.components = 2, .bytes = 6}, noPictures, &learned);
    EXPECT_EQ(learned.unseenFlip, 0);
}

TEST(Learning, OrderOfTheMaterialsChangesNoByte) {
    std::vector<Measured> all = family(12, 3);
    const test::TemporaryFile one(""), two("");
    const std::string first = bytesOf(learn(space(), all, {}, {}, noPictures), one.path());
    std::ranges::reverse(all);
    EXPECT_EQ(bytesOf(learn(space(), all, {}, {}, noPictures), two.path()), first);
}

TEST(Learning, RefusesTwoMaterialsOfOneNameAndTooFewBytes) {
    std::vector<Measured> all = family(3, 4);
    all[2].name = all[0].name;
    EXPECT_THROW(learn(space(), all, {}, {}, noPictures), UsageError);
    EXPECT_THROW(learn(space(), family(3, 4), {}, {.bytes = 5}, noPictures), UsageError);
    EXPECT_THROW(learn(space(), family(1, 4), {}, {}, noPictures), UsageError);
    for (const char* name : {"", "a:b", "a,b", "a+b", "a\nb"})
        EXPECT_THROW(requireName(name), UsageError) << name;
}

TEST(Forms, AreNeitherNegativeNorAboveTheirBounds) {
    const Library library = learn(space(), family(12, 5), {}, {}, noPictures);
    for (const Material& material : library.materials) {
        const auto brdf = open(library, material, material.name);
        const double top = std::exp(logMaterial(library, material)->tops[0]) - logOffset;
        for (const double f : evaluateOn(*brdf, errorPairs())) {
            ASSERT_GE(f, 0);
            ASSERT_LE(f, top * (1 + 1e-12));
        }
    }
}

class LibraryFile : public testing::Test {
protected:
    static std::string file() {
        static const std::string bytes = [] {
            std::vector<Measured> all = family(6, 6);
            LogBrdf stranger = madeOf({0, 0, 0, 0, 0, 0, 0, 2.5, -2}, 0);
            all.push_back(space().project(stranger, "stranger", "made"));
            const test::TemporaryFile at("");
            return bytesOf(learn(space(), all, {}, {.components = 2, .bytes = 12}, noPictures),
                           at.path());
        }();
        return bytes;
    }
    static Library parsed(const std::string& bytes) {
        return parseLibrary(
            {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, "input",
            [](const std::string& name) -> Basis { throw InputError(name + ": is not there"); });
    }
};

TEST_F(LibraryFile, ReadingGivesWhatWasWritten) {
    const Library library = parsed(file());
    const test::TemporaryFile again("");
    EXPECT_EQ(bytesOf(library, again.path()), file());
    EXPECT_EQ(library.measured.size(), 7u);
    EXPECT_EQ(library.materials.size(), 7u);
}

TEST_F(LibraryFile, WithoutScalesHasVersion1) {
    Library library = parsed(file());
    EXPECT_TRUE(library.basis.scaled);
    EXPECT_NE(file().find("\"version\":2"), std::string::npos);
    const std::string scaledSum = checksum(library.basis);
    library.basis.scaled = false;
    EXPECT_NE(checksum(library.basis), scaledSum);
    const Encoder encoder(library.basis, space());
    for (std::size_t n = 0; n < library.materials.size(); ++n)
        if (library.materials[n].kind == Kind::coded)
            library.materials[n].codes = encoder.encode(library.measured[n].material(), 2);
    const test::TemporaryFile at("");
    std::string bytes = bytesOf(library, at.path());
    EXPECT_NE(bytes.find("\"version\":1"), std::string::npos);
    const Library read = parsed(bytes);
    EXPECT_FALSE(read.basis.scaled);
    for (const Material& material : library.materials)
        EXPECT_EQ(find(read, material.name)->codes, material.codes);
    // A version that is not known is refused.
    bytes[bytes.find("\"version\":1") + 10] = '3';
    EXPECT_THROW(parsed(bytes), InputError);
}

TEST_F(LibraryFile, TheRestBeyondTheTermsIsKeptAndMayBeAbsent) {
    Library library = parsed(file());
    EXPECT_EQ(library.measured.front().rest, family(6, 6).front().rest);
    ASSERT_FALSE(library.measured.front().rest.empty());
    for (Measured& one : library.measured) one.rest.clear();
    const test::TemporaryFile again("");
    EXPECT_TRUE(parsed(bytesOf(library, again.path())).measured.front().rest.empty());
}

TEST_F(LibraryFile, CutFilesAreRefused) {
    const std::string whole = file();
    for (std::size_t n = 0; n < whole.size(); n += 1 + n / 40)
        EXPECT_THROW(parsed(whole.substr(0, n)), InputError) << n;
}

TEST_F(LibraryFile, ChangedBytesAreReadOrRefused) {
    std::mt19937 random(7);
    for (int trial = 0; trial < 300; ++trial) {
        std::string bytes = file();
        for (int k = 0; k < 3; ++k) {
            const std::size_t most = trial % 2 == 0 ? 4000 : bytes.size();
            bytes[random() % std::min(most, bytes.size())] = static_cast<char>(random());
        }
        try {
            const Library library = parsed(bytes);
            for (const Material& material : library.materials) {
                const auto brdf = open(library, material, "input");
                const double f = evaluate(*brdf, {0.6, 0, 0.8}, {0, 0.6, 0.8})[0];
                ASSERT_TRUE(f >= 0 && std::isfinite(f));
            }
        } catch (const InputError&) {
        }
    }
}

}  // namespace
}  // namespace hshfit::material_library
