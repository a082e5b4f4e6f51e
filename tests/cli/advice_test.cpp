// Advice about poor results ends: its last call makes a result that is not poor, or the answer says
// that no form is known to do better.

#include "program.h"
#include "skip_without.h"

#include <nlohmann/json.hpp>

#include <string>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

class AdviceAboutPoorResults : public Cli {
protected:
    /// The answer of the program. Its text says the same advice, once.
    Json answerOf(const std::string& arguments) const {
        const Answer answer = run(arguments + " --json");
        EXPECT_EQ(answer.code, 0) << arguments << "\n" << answer.err;
        Json document = Json::parse(answer.out);
        const bool poor = document.contains("poor");
        EXPECT_EQ(answer.err.find("poor: ") != std::string::npos, poor) << answer.err;
        if (poor) {
            const auto says = [&](const std::string& text) {
                return answer.err.find(text) != std::string::npos;
            };
            const std::string better = document["poor"]["better"];
            const std::string toTry = document["poor"].value("to_try", "");
            EXPECT_TRUE(better.empty() || toTry.empty()) << answer.err;
            EXPECT_EQ(says("; better: " + better + "\n"), !better.empty()) << answer.err;
            EXPECT_EQ(says("; to try: " + toTry + "\n"), !toTry.empty()) << answer.err;
            EXPECT_EQ(says("; no form is known to do better\n"), better.empty() && toTry.empty());
        }
        return document;
    }

    /// Follows the advice from this call to its end. A call after "better:" is not poor, and at
    /// most one call after "to try:" is. Returns the last answer.
    Json followed(const std::string& start) const {
        SCOPED_TRACE(start);
        std::string call = start;
        for (int tries = 0;; ++tries) {
            Json document = answerOf(call);
            if (!document.contains("poor")) return document;
            const std::string better = document["poor"]["better"];
            if (!better.empty()) {
                Json last = answerOf(better.substr(7));
                EXPECT_FALSE(last.contains("poor")) << "after " << call << "\n" << better;
                return last;
            }
            call = document["poor"].value("to_try", "");
            if (!call.starts_with("hshfit ")) return document;
            EXPECT_EQ(tries, 0) << "a second call to try: " << call;
            if (tries > 0) return document;
            call = call.substr(7);
        }
    }
    std::string to() const { return " --force -o " + path("x.json"); }
};

// Isotropic, anisotropic, transmitted and measured light, and each kind of coefficients.
TEST_F(AdviceAboutPoorResults, EndsAtAFormThatIsNotPoor) {
    for (const std::string job :
         {"ward:ax=.2,ay=.5 --cosine", "ggx:alpha=.3 --order 12", "phong:exponent=60 --order 3",
          "phong:exponent=60 --form basis --order 3", "ggx:ax=.1,ay=.2 --order 4 --outgoing 4x4",
          "ggx:alpha=.6 --outgoing 8 --keep 9", "phong:exponent=400 --outgoing 30,0 --order 4",
          "oren-nayar:kd=.5,sigma=30 --order 1",
          "blinn-phong:exponent=500 --form halfway --halfway 3,1,1"})
        EXPECT_FALSE(followed("project " + job + to()).contains("poor")) << job;
}

TEST_F(AdviceAboutPoorResults, EndsWhereNoFormIsKnown) {
    const Json glass = followed("project rough-glass:alpha=.2 --order 12" + to());
    ASSERT_TRUE(glass.contains("poor")) << "the halfway form holds it now: take another material";
    EXPECT_EQ(glass["poor"]["better"], "");
}

TEST_F(AdviceAboutPoorResults, EndsForMeasuredFiles) {
    const std::string bronze = sharedFolder() + "/data/merl_slices/alum-bronze.slice";
    SKIP_WITHOUT(bronze);
    followed("project " + bronze + to());
}

// The order of a trial passes by the same rule that calls the result poor.
TEST_F(AdviceAboutPoorResults, NamesAnOrderWhereOneIsEnough) {
    for (const std::string job :
         {"oren-nayar:kd=.5,sigma=30 --order 1", "phong:exponent=400 --outgoing 30,0 --order 4"}) {
        const Json document = answerOf("project " + job + to());
        EXPECT_NE(document["poor"]["better"].get<std::string>().find("--order"), std::string::npos)
            << document["poor"];
    }
}

// Its own advice was once twice the order, which is poor as well.
TEST_F(AdviceAboutPoorResults, OfExportsEnds) {
    run("project ward:ax=.2,ay=.5 --cosine" + to());
    const Json document = answerOf("export " + path("x.json") + " --force -o " + path("out"));
    const std::string call = document["poor"].value("to_try", "");
    EXPECT_TRUE(call.ends_with("--form halfway")) << document["poor"];
    EXPECT_EQ(document["poor"]["better"], "");
}

}  // namespace
}  // namespace hshfit::test
