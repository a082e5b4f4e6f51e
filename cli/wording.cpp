#include "wording.h"

#include <algorithm>
#include <cctype>

namespace hshfit::cli {
namespace {

enum class Value {
    shown,   ///< --option VALUE
    quoted,  ///< --option 'VALUE'
    none,    ///< a flag
};

struct OptionRow {
    std::string_view member, option;
    Value value = Value::shown;
};

constexpr OptionRow options[] = {
    {"ConvertOptions::format", "--to"},
    {"ConvertOptions::measureLoss", "--report-loss"},
    {"ConvertOptions::repairs", "--repair"},
    {"ConvertOptions::rgb", "--rgb", Value::none},
    {"ExportOptions::allowLoss", "--allow-loss"},
    {"ExportOptions::force", "--force"},
    {"ExportOptions::lights", "--light"},
    {"ExportOptions::name", "--name"},
    {"ExportOptions::outgoing", "--outgoing"},
    {"ExportOptions::source", "--source"},
    {"ExportOptions::storage", "--storage"},
    {"ExportOptions::targets", "--target"},
    {"FileSet::force", "--force"},
    {"FitOptions::accept", "--accept"},
    {"FitOptions::bands", "--bands"},
    {"FitOptions::bandsTo", "--bands-to"},
    {"FitOptions::bootstrap", "--bootstrap"},
    {"FitOptions::budget", "--budget"},
    {"FitOptions::calibration", "--calibration"},
    {"FitOptions::certificate", "--certificate"},
    {"FitOptions::dispersion", "--dispersion"},
    {"FitOptions::instrument.bandwidth", "--bandwidth"},
    {"FitOptions::instrument.dark", "--dark"},
    {"FitOptions::instrument.detector", "--detector-aperture"},
    {"FitOptions::instrument.detectorZero", "--detector-zero"},
    {"FitOptions::instrument.incidenceZero", "--incidence-zero"},
    {"FitOptions::instrument.offset", "--offset"},
    {"FitOptions::instrument.scale", "--scan-scale"},
    {"FitOptions::instrument.source", "--source-aperture"},
    {"FitOptions::instrument.stray", "--stray"},
    {"FitOptions::loss", "--loss"},
    {"FitOptions::model", "--model", Value::quoted},
    {"FitOptions::parts", "--extensions"},
    {"FitOptions::places", "--at"},
    {"FitOptions::profile", "--profile"},
    {"FitOptions::residuals", "--residuals"},
    {"FitOptions::scans", "--scans"},
    {"FitOptions::sigma", "--sigma"},
    {"FitOptions::weights", "--weights"},
    {"Form::basis", "--basis"},
    {"Form::condonShortley", "--condon-shortley"},
    {"Form::energyPreserving", "--energy-preserving"},
    {"Form::halfway", "--halfway"},
    {"Form::keep", "--keep"},
    {"Form::kind", "--form"},
    {"Form::nonNegative", "--non-negative"},
    {"Form::nonNegativeFactors", "--non-negative-factors"},
    {"Form::order", "--order"},
    {"Form::outgoing", "--outgoing"},
    {"Form::precision", "--precision"},
    {"Form::quantity", "--cosine", Value::none},
    {"Form::rank", "--rank"},
    {"Form::rankError", "--rank-error"},
    {"Form::reciprocal", "--reciprocal"},
    {"Form::split", "--split", Value::quoted},
    {"Form::window", "--window"},
    {"ImportOptions::force", "--force"},
    {"LearnLibraryOptions::final", "--final"},
    {"LearnOptions::bytes", "--bytes"},
    {"LightDomain::normal", "--normal"},
    {"MatrixOptions::weight", "--weight"},
    {"PackOptions::number", "--number"},
    {"PlanOptions::bases", "--bases"},
    {"PlanOptions::byTime", "--by-time"},
    {"ProjectOptions::leastSquares", "--least-squares"},
    {"ProjectionOptions::maxEvaluations", "--max-evaluations"},
    {"ProjectionOptions::quantity", "--cosine", Value::none},
    {"ProjectionOptions::tolerance", "--tolerance"},
    {"GatheringOptions::rays", "--rays"},
    {"IlluminateOptions::camera", "--camera"},
    {"IlluminateOptions::reference", "--reference"},
    {"CacheOptions::accuracy", "--accuracy"},
    {"CacheOptions::basis", "--basis"},
    {"CacheOptions::rays", "--rays"},
    {"PathOptions::fewestBounces", "--from-bounce"},
    {"TradeoffOptions::byTime", "--by-time"},
    {"TradeoffOptions::gpu", "--gpu"},
    {"TransferMeshOptions::edge", "--edge"},
    {"TransferOptions::clusters", "--clusters"},
    {"TransferOptions::components", "--components"},
    {"TransferOptions::lights", "--light"},
    {"TransferOptions::localOrder", "--local-order"},
    {"TransferOptions::memory", "--memory"},
    {"TransferOptions::order", "--order"},
    {"TradeoffOptions::maxBytes", "--max-bytes"},
    {"TradeoffOptions::maxNanoseconds", "--max-ns"},
    {"TradeoffOptions::metric", "--metric"},
    {"TradeoffOptions::timing", "--no-timing", Value::none},
    {"TradeoffOptions::writePairs", "--write-pairs"},
    {"output", "-o"},
};

std::string optionOf(const Setting& setting) {
    const auto* row = std::ranges::find(options, setting.member, &OptionRow::member);
    if (row == std::end(options)) return asMember(setting);
    const std::string option(row->option);
    if (setting.value.empty() || row->value == Value::none) return option;
    return row->value == Value::quoted ? option + " '" + setting.value + "'"
                                       : option + " " + setting.value;
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

/// The text, in quotes if it contains characters that are special to a shell.
std::string forShell(const std::string& text) {
    const auto plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
               std::string_view("._-/:=,+@%").find(c) != std::string_view::npos;
    };
    return !text.empty() && std::ranges::all_of(text, plain) ? text : quoted(text);
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
