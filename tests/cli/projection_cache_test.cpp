// Projections that plan, tradeoff and choose keep from run to run.

#include "program.h"

#include <nlohmann/json.hpp>

#include <map>

namespace hshfit::test {
namespace {

using nlohmann::json;

class ProjectionCacheCommand : public Cli {
protected:
    static std::string preset(const char* alpha) {
        return std::string("{\"format\":\"hshfit-preset\",\"version\":1,\"spec\":\"ggx:alpha=") +
               alpha + "\"}";
    }
    /// The rows of a small sweep of material.json.
    json trade(const std::string& more, std::string* remarks = nullptr) const {
        const Answer answer = run("tradeoff " + path("material.json") +
                                  " --bases hsh --orders 3,4 --outgoing 8 --halfway 5,3,2 --ranks 0"
                                  " --precisions float32,unorm8 --pair-count 2048 --no-timing"
                                  " --formulas none --quiet --json " +
                                  more);
        EXPECT_EQ(answer.code, 0) << answer.err;
        if (remarks) *remarks = answer.err;
        return json::parse(answer.out);
    }
    std::string cache() const { return "--cache " + path("cache"); }
    /// The bytes of all projections: a new one states other seconds.
    std::map<std::string, std::string> kept() const {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::directory_iterator(path("cache")))
            files[entry.path().filename()] = read(entry.path());
        return files;
    }
};

TEST_F(ProjectionCacheCommand, TradeoffTakesWhatItMadeBefore) {
    write("material.json", preset(".4"));
    const json without = trade("");
    EXPECT_EQ(trade(cache()), without);
    const auto files = kept();
    // By outgoing direction, both directions whole and symmetric, and the halfway form.
    EXPECT_EQ(files.size(), 4U);
    EXPECT_EQ(trade(cache()), without);
    EXPECT_EQ(kept(), files);
}

TEST_F(ProjectionCacheCommand, AChangedMaterialIsMadeAnew) {
    write("material.json", preset(".4"));
    trade(cache());
    const auto files = kept();
    write("material.json", preset(".5"));
    EXPECT_EQ(trade(cache()), trade(""));
    EXPECT_EQ(kept().size(), 2 * files.size());
}

TEST_F(ProjectionCacheCommand, ADamagedFileIsToldAndMadeAnew) {
    write("material.json", preset(".4"));
    const json rows = trade(cache());
    const auto files = kept();
    const std::string &cut = files.begin()->first, &turned = files.rbegin()->first;
    write("cache/" + cut, files.at(cut).substr(0, files.at(cut).size() / 2));
    std::string other = files.at(turned);
    const std::size_t digit = other.find("\"seconds\": ") + 11;
    other[digit] = other[digit] == '9' ? '8' : '9';
    write("cache/" + turned, other);
    const Answer answer =
        run("tradeoff " + path("material.json") +
            " --bases hsh --orders 3,4 --outgoing 8 --halfway 5,3,2 --ranks 0"
            " --precisions float32,unorm8 --pair-count 2048 --no-timing --formulas none --json " +
            cache());
    EXPECT_EQ(json::parse(answer.out), rows);
    for (const std::string& name : {cut, turned})
        EXPECT_NE(answer.err.find(name + ": not as it was written"), std::string::npos)
            << answer.err;
    std::string remarks;
    EXPECT_EQ(trade(cache(), &remarks), rows);
    EXPECT_EQ(remarks, "");
}

TEST_F(ProjectionCacheCommand, PlanTakesWhatItMadeBeforeAndTradeoffWhatChooseMade) {
    write("material.json", preset(".4"));
    write("scene.json", R"({"format": "hshfit-scene", "version": 1,
        "materials": [{"name": "metal", "brdf": ")" +
                            path("material.json") + R"("}],
        "lights": [{"kind": "sky", "model": "overcast", "radiance": 1}],
        "budget": {"metric": "relative_l2", "error": 0.05}})");
    const auto plan = [&](const std::string& more) {
        const Answer answer = run("plan " + path("scene.json") + " -o " + path("plan") +
                                  " --max-order 5 --formulas none --force --json " + more);
        EXPECT_EQ(answer.code, 0) << answer.err;
        return answer.out;
    };
    const std::string without = plan("");
    EXPECT_EQ(plan(cache()), without);
    const auto files = kept();
    EXPECT_EQ(plan(cache()), without);
    EXPECT_EQ(kept(), files);
    // The halfway form 5,4,3 is one for choose and tradeoff.
    const auto countAfter = [&](const std::string& command) {
        const Answer answer = run(command + " --json " + cache());
        EXPECT_EQ(answer.code, 0) << answer.err;
        return kept().size();
    };
    const std::string material = path("material.json");
    const std::size_t chosen = countAfter("choose " + material + " --kinds halfway --seconds 4");
    EXPECT_EQ(countAfter("tradeoff " + material +
                         " --forms halfway --halfway 5,4,3 --no-timing --formulas none"),
              chosen);
}

TEST_F(ProjectionCacheCommand, AFileIsNoFolder) {
    write("cache", "");
    write("material.json", preset(".4"));
    expectError("tradeoff " + path("material.json") + " --json " + cache(), 5, "cannot make", 2);
}

}  // namespace
}  // namespace hshfit::test
