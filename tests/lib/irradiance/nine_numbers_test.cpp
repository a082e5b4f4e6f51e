#include <hshfit/error.h>
#include <hshfit/irradiance/nine_numbers.h>

#include <gtest/gtest.h>

#include <cmath>

namespace hshfit {
namespace {

const Convention& named(std::string_view name) {
    return *selectConventions(name).front();
}

/// Light of which E / pi is 2 + 0.75 z in our world: c00 = 2 sqrt(4 pi), and of the linear part
/// E = (2 pi / 3) c10 sqrt(3 / (4 pi)) z.
constexpr double constant = 2, slope = 0.75;
NineRgb expectedLight() {
    NineRgb nine{};
    nine[0].fill(constant * std::sqrt(4 * pi));
    nine[2].fill(slope * 1.5 / std::sqrt(3 / (4 * pi)));
    return nine;
}

void expectLight(const NineRgb& nine, const std::string& name) {
    const NineRgb expected = expectedLight();
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(nine[k][c], expected[k][c], 1e-12) << name << " slot " << k;
}

/// Nine triples with the constant at place 0 and up at place `up`.
std::vector<double> triples(double first, double upwards, std::size_t up) {
    std::vector<double> numbers(27, 0.0);
    for (std::size_t c = 0; c < 3; ++c) numbers[c] = first, numbers[3 * up + c] = upwards;
    return numbers;
}

TEST(NineNumbers, NumbersThatEnginesShadeWithGiveTheLight) {
    // Up is +y, slot 1, in the right-handed worlds of filament, three and godot.
    expectLight(radianceFromEngine(named("filament"), triples(constant, slope, 1), "f"),
                "filament");
    const double dc = constant * std::sqrt(4 * pi), linear = slope * 1.5 / std::sqrt(3 / (4 * pi));
    expectLight(radianceFromEngine(named("three"), triples(dc, linear, 1), "t"), "three");
    expectLight(radianceFromEngine(named("godot"), triples(dc / pi, linear / pi, 1), "g"), "godot");
    // Vectors of (x, y, z, 1); up is +y in Unity and +z in Unreal.
    for (const auto& [name, up] : {std::pair{"unity", 1U}, {"unreal", 2U}}) {
        std::vector<double> numbers(28, 0.0);
        for (std::size_t c = 0; c < 3; ++c)
            numbers[4 * c + up] = slope, numbers[4 * c + 3] = constant;
        numbers[27] = 0.5;  // not looked at
        expectLight(radianceFromEngine(named(name), numbers, name), name);
    }
}

TEST(NineNumbers, EveryConventionIsUndone) {
    NineRgb nine{};
    for (std::size_t k = 0; k < 27; ++k)
        nine[k / 3][k % 3] = std::sin(1.7 * static_cast<double>(k));
    for (const Convention& each : conventions()) {
        std::vector<double> numbers;
        for (const auto& row : engineValues(each, nine))
            numbers.insert(numbers.end(), row.begin(), row.end());
        const NineRgb back = radianceFromEngine(each, numbers, "n");
        for (std::size_t k = 0; k < 27; ++k)
            EXPECT_NEAR(back[k / 3][k % 3],
                        static_cast<int>(k / 3) < each.bands * each.bands ? nine[k / 3][k % 3] : 0,
                        1e-12)
                << each.name;
        numbers.pop_back();
        EXPECT_THROW(radianceFromEngine(each, numbers, "n"), InputError);
    }
}

TEST(NineNumbers, TextsOfCmgenTablesAndArraysAreRead) {
    std::vector<double> expected;
    std::string cmgen, csv = "l,m,r,g,b\n", json = "[";
    for (int k = 0; k < 9; ++k) {
        const int l = k == 0 ? 0 : k < 4 ? 1 : 2, m = k - l * (l + 1);
        const double r = 0.5 - 0.125 * k, g = 1e-3 * k, b = -2;
        expected.insert(expected.end(), {r, g, b});
        const std::string three =
            std::to_string(r) + ", " + std::to_string(g) + ", " + std::to_string(b);
        cmgen += "( " + three + "); // L" + std::to_string(l) + std::to_string(m) +
                 ", irradiance, pre-scaled base\n";
        csv += std::to_string(l) + "," + std::to_string(m) + "," + three + "\r\n";
        json += std::string(k > 0 ? "," : "") + "[" + three + "]";
    }
    EXPECT_EQ(numbersOfText(cmgen, "c"), expected);
    EXPECT_EQ(numbersOfText(csv, "c"), expected);
    EXPECT_EQ(numbersOfText(json + "]", "c"), expected);
    EXPECT_EQ(conventionOfText(cmgen), "filament");
    EXPECT_EQ(conventionOfText(csv), "");
    EXPECT_THROW(numbersOfText("1 2 x", "c"), InputError);
    EXPECT_THROW(numbersOfText("1 nan 3", "c"), InputError);
    EXPECT_THROW(
        numbersOfText(std::string(200, '1').replace(1, 1, " ") + std::string(200, '7') + "e999",
                      "c"),
        InputError);
    std::string many;
    for (int k = 0; k < 65; ++k) many += "1 ";
    EXPECT_THROW(numbersOfText(many, "c"), InputError);
}

}  // namespace
}  // namespace hshfit
