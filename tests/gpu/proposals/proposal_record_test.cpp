// The proposal of an export as JSON: what is written is read again, and what does not hold is
// refused.

#include "sample_cases.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace hshfit::gpu {
namespace {

using Json = nlohmann::json;

ProposalRecord someRecord() {
    Proposal proposal;
    for (int k = 0; k < 5; ++k) {
        const auto byte = [&](int value) { return static_cast<std::uint8_t>(value + k); };
        proposal.rows.push_back({ProposalLobe{byte(90), byte(120), byte(140), 0},
                                 ProposalLobe{byte(60), byte(200), byte(190), 1}});
    }
    Efficiency e{.wo = directionFromAngles(0.5, 0.2),
                 .samples = 100,
                 .variance = 0.25,
                 .largest = 3,
                 .wasted = 0.01,
                 .albedo = {0.5, 0.25, 0.125},
                 .albedoError = {0.01, 0.02, 0.03}};
    return {std::move(proposal), {{e, std::vector<double>{0.5, 0.25, 0.125}}, {e, {}}}};
}

std::string sidecarOf(const std::string& proposal) {
    return R"({"proposal": )" + proposal + "}";
}

TEST(ProposalRecord, IsReadAgainAsItWasWritten) {
    const ProposalRecord record = someRecord();
    const auto again = parseProposal(sidecarOf(proposalText(record)), "file");
    ASSERT_TRUE(again);
    EXPECT_EQ(again->proposal, record.proposal);
    ASSERT_EQ(again->rows.size(), 2u);
    EXPECT_EQ(again->rows[0].albedo, record.rows[0].albedo);
    EXPECT_FALSE(again->rows[1].albedo);
    EXPECT_EQ(again->rows[1].efficiency.variance, 0.25);
    EXPECT_EQ(again->rows[1].efficiency.albedoError, record.rows[1].efficiency.albedoError);
    EXPECT_FALSE(parseProposal(std::string("{}"), "file"));
}

/// The formulas that the JSON states, written out: an independent reader gets the stated densities.
TEST(ProposalRecord, TheStatedFormulasGiveTheStatedDensities) {
    const Json json = Json::parse(proposalText(someRecord()));
    const auto& rows = json["rows"];
    const double count = static_cast<double>(rows.size());
    for (const Json& test : json["tests"]) {
        const double wo[] = {test["wo"][0], test["wo"][1], test["wo"][2]};
        const double wi[] = {test["wi"][0], test["wi"][1], test["wi"][2]};
        const double theta = std::atan2(std::hypot(wo[0], wo[1]), wo[2]);
        double x = count * (1 - std::sqrt(1 - std::tan(theta / 2))) - 0.5;
        x = std::min(std::max(x, 0.0), count - 1);
        const auto low = static_cast<std::size_t>(std::min(std::floor(x), count - 2));
        const auto value = [&](std::size_t column, bool share) {
            const auto of = [&](std::size_t row) {
                const double code = rows[row][column].get<double>() / 255;
                return share ? code : 1e-4 * std::pow(20000, code);
            };
            return of(low) + (x - static_cast<double>(low)) * (of(low + 1) - of(low));
        };
        double left = 1, pdf = 0;
        for (std::size_t k = 0; k < 2; ++k) {
            const double share = value(3 * k, true), ax = value(3 * k + 1, false),
                         ay = value(3 * k + 2, false);
            const double side = json["lobes"][k] == "retro" ? -1 : 1;
            left -= share;
            for (const double up : {1., -1.}) {
                double h[] = {wo[0] + side * wi[0], wo[1] + side * wi[1], wo[2] + up * wi[2]};
                if (h[2] <= 0) continue;
                const double length = std::hypot(h[0], h[1], h[2]);
                for (double& v : h) v /= length;
                const double s =
                    std::pow(h[0] / ax, 2) + std::pow(h[1] / ay, 2) + std::pow(h[2], 2);
                const double seen = wo[2] + std::hypot(ax * wo[0], ay * wo[1], wo[2]);
                pdf += share / (2 * pi * ax * ay * s * s * seen);
            }
        }
        pdf += left * wi[2] / pi;
        EXPECT_NEAR(test["pdf"].get<double>() / pdf, 1, 1e-9);
    }
}

TEST(ProposalRecord, WhatIsNoProposalIsRefusedWithItsField) {
    const Json good = Json::parse(proposalText(someRecord()));
    const std::pair<const char*, std::function<void(Json&)>> changes[] = {
        {"version", [](Json& j) { j["version"] = 2; }},
        {"rows", [](Json& j) { j["rows"] = Json::array(); }},
        {"rows", [](Json& j) { j["rows"][1][2] = 256; }},
        {"rows", [](Json& j) { j["rows"][1][2] = 1.5; }},
        {"rows", [](Json& j) { j["rows"][1].erase(0); }},
        {"rows", [](Json& j) { j["rows"][0][0] = 240; }},
        {"lobes", [](Json& j) { j["lobes"][0] = "retro"; }},
        {"lobes", [](Json& j) { j["lobes"] = {"mirror"}; }},
        {"wi", [](Json& j) { j["rows"][2][1] = 5; }},
        {"wi", [](Json& j) { j["tests"][3]["wi"][0] = 0.5; }},
        {"wi", [](Json& j) { j["tests"][3]["pdf"] = 0.5; }},
        {"u",
         [](Json& j) {
             j["tests"][0]["u"] = {1, 2};
         }},
        {"wasted", [](Json& j) { j["efficiency"][0]["wasted"] = 2; }},
        {"variance", [](Json& j) { j["efficiency"][0].erase("variance"); }},
        {"proposal", [](Json& j) { j = 3; }},
    };
    for (const auto& [field, change] : changes) {
        Json bad = good;
        change(bad);
        try {
            parseProposal(sidecarOf(bad.dump()), "some.hsh.json");
            ADD_FAILURE() << "accepted: " << field;
        } catch (const InputError& error) {
            const std::string text = error.what();
            EXPECT_EQ(text.rfind("some.hsh.json", 0), 0u) << text;
            EXPECT_NE(text.find(field), std::string::npos) << text;
        }
    }
}

/// Every language names the same functions, under the prefix that is asked for.
TEST(ProposalShaderText, HasItsPrefixOnly) {
    for (const LanguageEntry& entry : languages()) {
        const std::string text = proposalSource(entry.language, someRecord(), {.prefix = "metal7"});
        EXPECT_NE(text.find("metal7_sample("), std::string::npos) << entry.name;
        EXPECT_NE(text.find("metal7_pdf("), std::string::npos) << entry.name;
        EXPECT_EQ(text.find("hsh_"), std::string::npos) << entry.name;
        EXPECT_EQ(text.find("{{"), std::string::npos) << entry.name;
    }
    EXPECT_THROW(proposalSource(Language::glsl, someRecord(), {.prefix = "gl_"}), UsageError);
}

}  // namespace
}  // namespace hshfit::gpu
