#include <hshfit/gpu/shader_data.h>
#include <hshfit/rotation/sh_rotation.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::embedded {
extern const std::string_view shader_shade_world;
}  // namespace hshfit::embedded

namespace hshfit::gpu {
namespace {

using kainjow::mustache::data;

struct Term {
    double sign = 1;
    std::string factor, of;
};

data termsData(const std::vector<Term>& terms) {
    data rows = list();
    for (const Term& term : terms) {
        data row;
        const bool first = &term == &terms.front();
        row.set("sign", term.sign < 0 ? (first ? "-" : " - ") : (first ? "" : " + "));
        row.set("factor", term.factor.empty() ? data(false) : data(term.factor));
        row.set("of", term.of);
        rows.push_back(row);
    }
    return rows;
}

/// Columns of the exchange of y and z, as it acts on coefficients: that turn about x which takes y
/// to z, then the mirror image in y, which changes the sign of the functions of negative m.
std::vector<std::vector<double>> exchange(int order) {
    const ShRotation rotation(order);
    const Rotation quarter = Rotation::fromMatrix({1, 0, 0, 0, 0, -1, 0, 1, 0});
    const auto slots = static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
    std::vector<std::vector<double>> columns;
    for (std::size_t j = 0; j < slots; ++j) {
        std::vector<double> unit(slots, 0.0);
        unit[j] = 1;
        columns.push_back(rotation.rotate(quarter, unit));
        for (std::size_t i = 0; i < slots; ++i)
            if (bandOf(static_cast<int>(i)).m < 0) columns.back()[i] *= -1;
    }
    return columns;
}

/// Sines and cosines of m times an angle, on the functions of m and -m.
std::vector<Term> turn(const std::string& angle, double direction, int slot,
                       const std::string& of) {
    const auto [l, m] = bandOf(slot);
    const int zonal = l * (l + 1);
    const auto name = [&](int k) { return fmt::format("{}{}", of, zonal + k); };
    if (m == 0) return {{1, "", name(0)}};
    const int k = std::abs(m);
    return {{1, fmt::format("{}c{}", angle, k), name(m)},
            {m > 0 ? -direction : direction, fmt::format("{}s{}", angle, k), name(-m)}};
}

std::vector<Term> exchanged(const std::vector<std::vector<double>>& columns, int slot,
                            const std::string& of) {
    const int l = bandOf(slot).l;
    std::vector<Term> terms;
    for (int j = l * l; j < (l + 1) * (l + 1); ++j) {
        const double value = columns[static_cast<std::size_t>(j)][static_cast<std::size_t>(slot)];
        if (std::abs(value) < 1e-12) continue;
        terms.push_back(
            {value < 0 ? -1.0 : 1.0, shaderNumber(std::abs(value)), fmt::format("{}{}", of, j)});
    }
    return terms;
}

}  // namespace

void setFrameTurn(const Payload& payload, int environmentOrder, bool flat, data& page,
                  ShaderCost& cost) {
    const bool colours = payload.head.channels.kind != Channels::Kind::spectral;
    const std::size_t lights = colours ? 3 : payload.head.channels.count();
    const auto columns = exchange(environmentOrder);
    const int slots = environmentOrder * environmentOrder;
    // With the Condon-Shortley sign, functions equal the ones without it about axes turned by pi
    // about z.
    page.set("gammaCosine", payload.head.condonShortley ? "+" : "-");
    page.set("gammaSine", payload.head.condonShortley ? "0.0 - " : "");
    data turns = list();
    for (const char* angle : {"a", "b", "g"}) {
        for (int m = 2; m < environmentOrder; ++m) {
            data row;
            row.set("angle", angle);
            row.set("m", std::to_string(m));
            row.set("before", std::to_string(m - 1));
            turns.push_back(row);
            cost.products += 4;
        }
    }
    page.set("frameTurns", turns);
    data passes = list();
    for (std::size_t first = 0; first < lights; first += colours ? 3 : 1) {
        data given = list(), steps = list(), turned = list();
        const auto place = [&](int slot) {
            const bool apart = flat && !colours;
            return std::to_string(apart ? static_cast<std::size_t>(slot) * lights + first
                                        : static_cast<std::size_t>(slot));
        };
        const auto count = [&](const std::vector<Term>& terms) {
            for (const Term& term : terms)
                cost.products += term.factor.empty() ? 0 : colours ? 3 : 1;
            return termsData(terms);
        };
        for (int slot = 0; slot < slots; ++slot) {
            data row;
            row.set("slot", std::to_string(slot));
            row.set("place", place(slot));
            given.push_back(row);
        }
        const auto step = [&](const char* name, auto&& terms) {
            for (int slot = 0; slot < slots; ++slot) {
                data row;
                row.set("name", fmt::format("{}{}", name, slot));
                row.set("terms", count(terms(slot)));
                steps.push_back(row);
            }
        };
        step("x", [&](int slot) { return turn("g", 1, slot, "l"); });
        step("y", [&](int slot) { return exchanged(columns, slot, "x"); });
        step("z", [&](int slot) { return turn("b", -1, slot, "y"); });
        step("w", [&](int slot) { return exchanged(columns, slot, "z"); });
        for (int slot = 0; slot < slots; ++slot) {
            data row;
            row.set("place", place(slot));
            row.set("terms", count(turn("a", 1, slot, "w")));
            turned.push_back(row);
        }
        data pass;
        pass.set("element", colours || flat ? "" : fmt::format(".v[{}]", first));
        pass.set("given", given);
        pass.set("steps", steps);
        pass.set("turned", turned);
        passes.push_back(pass);
    }
    page.set("framePasses", passes);
}

void setFrameTurn(int environmentOrder, data& page) {
    Payload payload;
    payload.head.channels = Channels::rgb();
    ShaderCost cost;
    setFrameTurn(payload, environmentOrder, false, page, cost);
    page.set("letLight", wordOf(page, "let3"));
    setPartials({{"worldBody", embedded::shader_shade_world}}, page);
}

}  // namespace hshfit::gpu
