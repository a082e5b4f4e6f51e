#include "slang_rules.h"

#include "runners.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

namespace hshfit::shaders {
namespace {

std::string replaced(const std::string& text, const std::string& from, const std::string& to) {
    return std::regex_replace(text, std::regex(from), to);
}

/// Intrinsics that the guide lists as differentiable, and constructors.
const std::set<std::string> differentiable{"abs",    "max",      "min",      "sqrt",   "exp",
                                           "exp2",   "pow",      "log",      "log2",   "dot",
                                           "cross",  "lerp",     "clamp",    "length", "float3",
                                           "float4", "saturate", "distance", "float2", "normalize"};

}  // namespace

std::vector<std::string> breachesOf(const std::string& text) {
    std::vector<std::string> found;
    std::istringstream stream(text);
    std::string line, before;
    bool code = false, inside = false;
    int depth = 0;
    const std::regex call(R"((no_diff )?\b(\w+)\()");
    const std::regex signature(R"((public )?[\w]+ \w+\(.*\) \{)");
    while (std::getline(stream, line)) {
        if (line.starts_with("//") || line.empty()) continue;
        // The primary file of a module begins with its declaration.
        if (!code && !std::regex_match(line, std::regex(R"(module "[^"]+";)")))
            found.push_back("no module: " + line);
        if (code && line.starts_with("module")) found.push_back("two modules");
        code = true;
        if (line.find("register(") != line.npos) found.push_back("a register: " + line);
        const bool begins = depth == 0 && std::regex_match(line, signature);
        // The default is internal: importing modules would not see it.
        if (begins && !line.starts_with("public ")) found.push_back("not public: " + line);
        static const std::regex open(R"(public struct \w+ \{( public \w+ [^;]+;)+ \};)");
        if (depth == 0 && line.find("struct ") != line.npos && !std::regex_match(line, open))
            found.push_back("a struct with hidden members: " + line);
        if (before == "[Differentiable]") {
            if (!begins) found.push_back("no function is differentiable: " + line);
            inside = true;
        } else if (inside) {
            for (std::sregex_iterator each(line.begin(), line.end(), call), end; each != end;
                 ++each) {
                const std::string name = (*each)[2];
                const bool marked = (*each)[1].matched;
                if (!marked && name != "if" && !differentiable.contains(name))
                    found.push_back("a call without derivative: " + line);
                if (marked && name != "step") found.push_back("a derivative is lost: " + line);
            }
        }
        depth += static_cast<int>(std::ranges::count(line, '{') - std::ranges::count(line, '}'));
        if (depth == 0) inside = false;
        before = line;
    }
    if (depth != 0) found.push_back("braces");
    return found;
}

std::string asHlsl(std::string text) {
    text = replaced(text, "module \"[^\"]*\";\n", "");
    text = replaced(text, R"(\[Differentiable\]\n)", "");
    text = replaced(text, R"(\b(public|no_diff) )", "");
    text = replaced(text, R"((SamplerState \w+);)", "$1 : register(s1);");
    text = replaced(text, R"((Texture2DArray<float4> \w+_(basis|shared));)", "$1 : register(t2);");
    text = replaced(text, R"((Texture2DArray<float4> \w+_harmonics);)", "$1 : register(t5);");
    text = replaced(text, R"((Texture2DArray<float4> \w+);)", "$1 : register(t0);");
    return replaced(text, R"((cbuffer \w+) \{)", "$1 : register(b0) {");
}

std::string moduleAsHlsl(const std::string& snippets) {
    const std::string module = gpu::fileText(gpu::Language::slang, snippets, "paint 1_hsh");
    const std::vector<std::string> breaches = breachesOf(module);
    if (!breaches.empty()) throw Refused(fmt::format("{}", fmt::join(breaches, "\n")));
    return asHlsl(module);
}

}  // namespace hshfit::shaders
