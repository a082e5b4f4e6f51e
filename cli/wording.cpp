#include "wording.h"

#include <hshfit/files/standard_streams.h>

#include <algorithm>
#include <cctype>

namespace hshfit::cli {
namespace {

/// A member whose option is not its own name with dashes.
struct RenamedMember {
    std::string_view member, option;
    bool flag = false;  ///< its value is not said
};
constexpr RenamedMember renamedMembers[] = {
    {"ConvertOptions::format", "--to"},
    {"ConvertOptions::measureLoss", "--report-loss"},
    {"ConvertOptions::repairs", "--repair"},
    {"ExportOptions::lights", "--light"},
    {"ExportOptions::targets", "--target"},
    {"FitOptions::instrument.detector", "--detector-aperture"},
    {"FitOptions::instrument.scale", "--scan-scale"},
    {"FitOptions::instrument.source", "--source-aperture"},
    {"FitOptions::parts", "--extensions"},
    {"FitOptions::places", "--at"},
    {"Form::kind", "--form"},
    {"Form::quantity", "--cosine", true},
    {"IrradianceOptions::engine", "--for"},
    {"PathOptions::fewestBounces", "--from-bounce"},
    {"ProjectionOptions::quantity", "--cosine", true},
    {"TradeoffOptions::maxNanoseconds", "--max-ns"},
    {"TradeoffOptions::timing", "--no-timing", true},
    {"TransferOptions::lights", "--light"},
    {"output", "-o"},
};

/// "--non-negative" for "Form::nonNegative" and "--dark" for "FitOptions::instrument.dark".
std::string optionNamed(std::string_view member) {
    std::string text = "--";
    for (const char c : member.substr(member.find_last_of(":.") + 1)) {
        const auto letter = static_cast<unsigned char>(c);
        if (std::isupper(letter) != 0) text += '-';
        text += static_cast<char>(std::tolower(letter));
    }
    return text;
}

std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'')
            out += "'\\''";
        else
            out += c;
    }
    return out + "'";
}

/// The text, in quotes if it contains characters that are special to a shell; standard input as it
/// is typed.
std::string forShell(const std::string& text) {
    if (text == standardInputPath) return "-";
    const auto plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
               std::string_view("._-/:=,+@%").find(c) != std::string_view::npos;
    };
    return !text.empty() && std::ranges::all_of(text, plain) ? text : quoted(text);
}

std::string optionOf(const Setting& setting) {
    const auto* row = std::ranges::find(renamedMembers, setting.member, &RenamedMember::member);
    const bool renamed = row != std::end(renamedMembers);
    const std::string option = renamed ? std::string(row->option) : optionNamed(setting.member);
    return setting.value.empty() || (renamed && row->flag) ? option
                                                           : option + " " + forShell(setting.value);
}

std::string optionsOf(const Call& call) {
    std::string text;
    for (const Setting& setting : call.settings) text += fmt::format(" {}", optionOf(setting));
    return text;
}

/// The output of a command that follows one with the same output. OUT.json stands for a file that
/// the reader names.
std::string again(const std::string& output) {
    return " -o " + forShell(output) + (output.starts_with("OUT.") ? "" : " --force");
}

/// The output of a command that is the first to write it.
std::string newly(const std::string& output) {
    return output.empty() ? output : " -o " + forShell(output);
}

struct CommandRow {
    std::string_view function;
    std::string (*command)(const Call& call);
};

const CommandRow commandsOfFunctions[] = {
    {"asRgb", [](const Call&) -> std::string { return "--rgb"; }},
    {"convert",
     [](const Call& call) {
         return "hshfit convert " + forShell(call.subject) + " " + forShell(call.output) +
                optionsOf(call);
     }},
    {"export",
     [](const Call& call) {
         return "hshfit export " + forShell(call.subject) + optionsOf(call) + newly(call.output);
     }},
    {"exportCoefficients",
     [](const Call& call) {
         return "hshfit export " + forShell(call.subject) + optionsOf(call) + again(call.output);
     }},
    {"fit",
     [](const Call& call) {
         return call.settings.empty()
                    ? "hshfit fit '" + call.subject + "' --model ggx -o fit.json"
                    : "hshfit fit " + forShell(call.subject) + optionsOf(call) + newly(call.output);
     }},
    {"formats", [](const Call&) -> std::string { return "hshfit list formats"; }},
    {"learn", [](const Call&) -> std::string { return "hshfit library learn"; }},
    {"linearlyTransformedCosines", [](const Call&) -> std::string { return "hshfit ltc"; }},
    {"metricCatalog", [](const Call&) -> std::string { return "hshfit list metrics"; }},
    {"project",
     [](const Call& call) {
         return "hshfit project " + forShell(call.subject) + optionsOf(call) + newly(call.output);
     }},
    {"represent",
     [](const Call& call) {
         return "hshfit project " + quoted(call.subject) + optionsOf(call) + again(call.output);
     }},
    {"writers", [](const Call&) -> std::string { return "hshfit list writers"; }},
    {"writeRepresentation",
     [](const Call& call) {
         return "hshfit project " + forShell(call.subject) + again(call.output) + optionsOf(call);
     }},
};

std::string commandOf(const Call& call) {
    const auto* row = std::ranges::find(commandsOfFunctions, call.function, &CommandRow::function);
    return row == std::end(commandsOfFunctions) ? asFunction(call) : row->command(call);
}

}  // namespace

Wording optionWording() {
    return {.setting = optionOf, .call = commandOf};
}

}  // namespace hshfit::cli
