#pragma once

#include "program.h"

#include <nlohmann/json.hpp>

#include <string>

namespace hshfit::test {

/// Commands that have to succeed, with their answers as JSON.
class JsonAnswers : public Cli {
protected:
    nlohmann::json answerOf(const std::string& arguments) const {
        const bool writes = arguments.find(" -o ") != std::string::npos;
        const Answer answer = run(arguments + (writes ? " --force --json" : " --json"));
        EXPECT_EQ(answer.code, 0) << arguments << "\n" << answer.err;
        return answer.code == 0 ? nlohmann::json::parse(answer.out) : nlohmann::json();
    }
};

}  // namespace hshfit::test
