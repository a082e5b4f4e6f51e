// Damaged RGL files end in one clear line that names the field.

#include <brdfs/catalog.h>
#include <brdfs/measured/rgl.h>
#include <hshfit/files/tensor_file.h>

#include <brdfs/measured_files.h>
#include <brdfs/tensor_writer.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hshfit {
namespace {

using brdfs::RglBrdf;
using test::expectInputError;
using test::RglShape;
using test::TemporaryFile;
using test::TensorField;

// A copy on the heap of exactly the size, so that a sanitizer sees one byte too many.
void open(const std::string& bytes) {
    const std::vector<unsigned char> copy(bytes.begin(), bytes.end());
    RglBrdf brdf({copy.data(), copy.size()}, "memory");
    evaluate(brdf, {0, 0.6, 0.8}, {0.6, 0, 0.8});
}

void expectRefused(const std::string& bytes, const std::vector<std::string>& parts) {
    expectInputError([&] { open(bytes); }, parts);
}

TensorField& named(std::vector<TensorField>& fields, const std::string& name) {
    for (TensorField& field : fields) {
        if (field.name == name) return field;
    }
    throw std::logic_error(name);
}

/// The synthetic file with one field changed.
std::string with(const std::string& name, const std::function<void(TensorField&)>& change,
                 const RglShape& shape = {}) {
    auto fields = test::rglFields(shape);
    change(named(fields, name));
    return test::tensorFile(fields);
}

void setFloat(TensorField& field, std::size_t index, float value) {
    std::memcpy(field.data.data() + 4 * index, &value, 4);
}

TEST(RglAttack, everyTruncationIsRefused) {
    const std::string whole = test::tensorFile(test::rglFields({}));
    EXPECT_NO_THROW(open(whole));
    for (std::size_t size = 1; size < whole.size(); ++size) {
        expectRefused(whole.substr(0, size), {"memory: "});
    }
    expectRefused("", {"ends at byte 0 within the magic word"});
}

TEST(RglAttack, magicAndVersionAreChecked) {
    std::string bytes = test::tensorFile(test::rglFields({}));
    bytes[3] = 'X';
    expectRefused(bytes, {"does not start with \"tensor_file\""});
    bytes[3] = 's';
    bytes[12] = 2;
    expectRefused(bytes, {"version 2.0, expected 1.0"});
}

TEST(RglAttack, fieldCountsAreNotTrusted) {
    std::string bytes = test::tensorFile(test::rglFields({}));
    for (const std::uint32_t count : {9u, 1000u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
        std::memcpy(bytes.data() + 14, &count, 4);
        expectRefused(bytes, {"memory: "});
    }
    const std::uint32_t none = 0;
    std::memcpy(bytes.data() + 14, &none, 4);
    expectRefused(bytes, {"has no field jacobian; it has: none"});
}

TEST(RglAttack, namesDimensionsAndTypesAreNotTrusted) {
    const std::string whole = test::tensorFile(test::rglFields({}));
    const std::size_t first = 18, length = std::string("description").size();
    const auto patched = [&whole]<class Value>(std::size_t offset, Value value) {
        std::string bytes = whole;
        std::memcpy(bytes.data() + offset, &value, sizeof value);
        return bytes;
    };
    expectRefused(patched(first, std::uint16_t{0}), {"name of field 0 (offset 18) is empty"});
    expectRefused(patched(first, std::uint16_t{0xffff}), {"name of field 0", "65535 characters"});
    expectRefused(patched(first + 2, '\n'), {"name of field 0", "not printable"});
    const std::size_t dimensions = first + 2 + length;
    expectRefused(patched(dimensions, std::uint16_t{0xffff}), {"description", "65535 dimensions"});
    for (const auto type : {std::uint8_t{0}, std::uint8_t{12}, std::uint8_t{255}}) {
        expectRefused(patched(dimensions + 2, type),
                      {"description", "type " + std::to_string(type)});
    }
}

TEST(RglAttack, sizesAndOffsetsAreNotTrusted) {
    const std::string whole = test::tensorFile(test::rglFields({}));
    const std::size_t offsetAt = 18 + 2 + std::string("description").size() + 3;
    constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
    for (const std::uint64_t offset : {std::uint64_t{0}, std::uint64_t{18}, whole.size() - 4,
                                       whole.size(), most, most - 4, most / 2 + 1}) {
        std::string bytes = whole;
        std::memcpy(bytes.data() + offsetAt, &offset, 8);
        expectRefused(bytes, {"field description (offset " + std::to_string(offset) + ")"});
    }
    // Products that wrap round to something small among them.
    for (const std::vector<std::uint64_t>& shape : {std::vector<std::uint64_t>{most},
                                                    {most, most},
                                                    {std::uint64_t{1} << 32, 1ULL << 32},
                                                    {1ULL << 63, 2},
                                                    {1ULL << 62, 4, 1},
                                                    {most, 0},
                                                    {1ULL << 62},
                                                    {0x4000000000000001ULL},
                                                    {1, 4, 7, 6, 1ULL << 40},
                                                    {1000000, 1000000}}) {
        expectRefused(with("vndf", [&](TensorField& f) { f.shape = shape; }), {"field vndf"});
    }
}

TEST(RglAttack, missingAndDoubledFieldsAreRefused) {
    for (const auto& field : test::rglFields({.channels = 4})) {
        if (field.name == "description") continue;
        auto fields = test::rglFields({.channels = 4});
        std::erase_if(fields, [&](const TensorField& f) { return f.name == field.name; });
        const std::string expected = field.name == "spectra" ? "rgb" : field.name;
        expectRefused(test::tensorFile(fields), {"has no field " + expected, "it has: "});
        fields = test::rglFields({.channels = 4});
        fields.push_back(field);
        expectRefused(test::tensorFile(fields), {"field " + field.name, "a second field"});
    }
}

TEST(RglAttack, typesAndShapesOfEveryUsedFieldAreChecked) {
    for (const auto& field : test::rglFields({.channels = 4})) {
        if (field.name == "description") continue;
        const RglShape shape{.channels = 4};
        const std::string where = "field " + field.name + " (offset ";
        expectRefused(with(
                          field.name, [](TensorField& f) { f.type = 5; }, shape),
                      {"field " + field.name});
        expectRefused(with(
                          field.name,
                          [](TensorField& f) {
                              f.shape.assign(f.shape.size(), 0);
                              f.data.clear();
                          },
                          shape),
                      {where});
        expectRefused(with(
                          field.name,
                          [](TensorField& f) {
                              f.shape.push_back(3);
                              f.data += f.data + f.data;
                          },
                          shape),
                      {where});
        // Larger grids are as good; what has to agree with other fields is not.
        if (field.name == "ndf" || field.name == "sigma") continue;
        const bool grid = field.name == "vndf" || field.name == "spectra";
        expectRefused(with(
                          field.name,
                          [grid](TensorField& f) {
                              f.shape[grid ? 1 : 0] += 1;
                              f.data += f.data;
                          },
                          shape),
                      {"field "});
    }
}

TEST(RglAttack, valuesThatAreNotFiniteAreRefusedInEveryUsedField) {
    const RglShape shape{.channels = 4};
    for (const auto& field : test::rglFields(shape)) {
        if (field.type != 10) continue;
        const std::size_t last = field.data.size() / 4 - 1;
        for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
            for (const std::size_t index : {std::size_t{0}, last}) {
                expectRefused(
                    with(
                        field.name, [&](TensorField& f) { setFloat(f, index, bad); }, shape),
                    {"field " + field.name + " (offset ", "value " + std::to_string(index)});
            }
        }
    }
}

TEST(RglAttack, valuesOutOfRangeAreRefused) {
    const auto changed = [](const std::string& name, std::size_t index, float value,
                            const RglShape& shape = {}) {
        return with(
            name, [&](TensorField& f) { setFloat(f, index, value); }, shape);
    };
    expectRefused(changed("theta_i", 1, 0), {"theta_i", "value 1 (0) is not above value 0 (0)"});
    expectRefused(changed("theta_i", 3, 3.2F), {"theta_i", "value 3 is 3.2, expected 0 to 1.570"});
    expectRefused(changed("theta_i", 0, -0.1F), {"theta_i", "value 0 is -0.1"});
    expectRefused(changed("phi_i", 0, 1e30F), {"phi_i", "value 0"});
    expectRefused(changed("sigma", 2, 0), {"sigma", "value 2", "is 0, expected at least"});
    expectRefused(changed("ndf", 2, -1), {"ndf", "value 2", "is -1"});
    expectRefused(changed("vndf", 2, -1), {"vndf", "value 2", "is -1"});
    expectRefused(changed("wavelengths", 1, 400, {.channels = 4}), {"wavelengths", "not above"});
    expectRefused(changed("wavelengths", 0, -400, {.channels = 4}), {"wavelengths", "-400"});
    // Azimuths that are no part of the circle.
    expectRefused(test::tensorFile(test::rglFields({.phi = {0, 1, 2}})), {"phi_i", "spans 114.6"});
    expectRefused(test::tensorFile(test::rglFields({.phi = {0.5F, 1.2F, 2.07F}})),
                  {"phi_i", "multiple of 90"});
    expectRefused(with("jacobian", [](TensorField& f) { f.data[0] = 2; }), {"jacobian", "0 or 1"});
}

TEST(RglAttack, distributionsThatCannotBeNormalisedAreRefused) {
    const std::size_t square = 7 * 6;
    expectRefused(with("vndf",
                       [&](TensorField& f) {
                           for (std::size_t i = 0; i < square; ++i) setFloat(f, square + i, 0);
                       }),
                  {"vndf", "slice 1 (offset ", "sums to 0"});
    expectRefused(with("vndf",
                       [&](TensorField& f) {
                           for (std::size_t i = 0; i < square; ++i) setFloat(f, i, 3e38F);
                       }),
                  {"vndf", "slice 0 (offset ", "cannot be normalised"});
    // A row without density is no error.
    const std::string bytes = with("vndf", [&](TensorField& f) {
        for (std::size_t i = 0; i < square - 6; ++i) setFloat(f, i, 0);
    });
    EXPECT_NO_THROW(open(bytes));
}

TEST(RglAttack, extremeFiniteValuesStayFinite) {
    auto fields = test::rglFields({});
    setFloat(named(fields, "ndf"), 0, std::numeric_limits<float>::max());
    setFloat(named(fields, "sigma"), 0, std::numeric_limits<float>::min());
    for (std::size_t i = 0; i < 60; ++i) {
        setFloat(named(fields, "rgb"), i, std::numeric_limits<float>::max());
    }
    const std::string bytes = test::tensorFile(fields);
    const RglBrdf brdf({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, "m");
    EXPECT_TRUE(std::isfinite(evaluate(brdf, {0, 0, 1}, {0, 0, 1})[0]));
    EXPECT_TRUE(std::isfinite(evaluate(brdf, {0, 0, 1}, {1, 0, 1e-300})[0]));
}

TEST(RglAttack, randomDamageNeverReadsOutOfBounds) {
    const std::string whole = test::tensorFile(test::rglFields({.channels = 4}));
    std::mt19937 random(12);
    int opened = 0, refused = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string bytes = whole;
        const int changes = 1 + static_cast<int>(random() % 3);
        for (int k = 0; k < changes; ++k) {
            // Mostly in the table of contents.
            const std::size_t range = random() % 4 == 0 ? bytes.size() : 450;
            bytes[random() % range] = static_cast<char>(random());
        }
        try {
            open(bytes);
            ++opened;
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(opened, 100);
    EXPECT_GT(refused, 10000);
}

TEST(RglAttack, unreadableFilesAreNamed) {
    const TemporaryFile empty("", ".bsdf");
    expectInputError([&] { RglBrdf::open(empty.path()); }, {empty.path(), "is empty"});
    expectInputError([] { RglBrdf::open("/tmp"); }, {"/tmp: is a directory"});
    expectInputError([] { RglBrdf::open("/no/such.bsdf"); }, {"/no/such.bsdf", "No such file"});
    const TemporaryFile junk("tensor_fil", ".bsdf");
    expectInputError([&] { brdfs::open(junk.path()); }, {junk.path(), "magic word"});
}

// Everything is copied when the file is opened.
TEST(RglAttack, aFileThatShrinksAfterwardsDoesNotMatter) {
    const TemporaryFile file(test::tensorFile(test::rglFields({})), ".bsdf");
    const auto brdf = brdfs::open(file.path());
    const auto before = evaluate(*brdf, {0, 0.6, 0.8}, {0.6, 0, 0.8});
    file.resize(0);
    EXPECT_EQ(evaluate(*brdf, {0, 0.6, 0.8}, {0.6, 0, 0.8}), before);
    EXPECT_NO_THROW(brdf->checkIntact());
}

}  // namespace
}  // namespace hshfit
