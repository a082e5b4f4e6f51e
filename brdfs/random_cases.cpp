#include <brdfs/random_cases.h>

#include <brdfs/rows/spec.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/files/temporary_file.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace hshfit::brdfs {
namespace {

/// A range over more than two decades is drawn from by its logarithm; one that begins at 0, from
/// this share of its end on.
constexpr double decades = 100, leastShare = 1e-9;

double fromRange(double low, double high, Draws& draws) {
    if (low >= 0 && high > decades * low && high > 1) {
        const double least = low > 0 ? low : std::max(leastShare * high, 1e-3);
        return draws.logBetween(least, high);
    }
    return draws.between(low, high);
}

double numberOf(const Parameter& parameter, Draws& draws, DrawFrom from) {
    const bool typical = !parameter.fit.empty() && (from == DrawFrom::typical || draws.oneIn(2));
    if (!typical) return fromRange(parameter.min, parameter.max, draws);
    const FitRange& range = parameter.fit.front();
    return range.logarithmic ? draws.logBetween(range.low, range.high)
                             : draws.between(range.low, range.high);
}

std::string valueOf(const Parameter& parameter, Draws& draws, DrawFrom from) {
    if (parameter.kind == Parameter::Kind::choice)
        return std::string(parameter.choices[draws.below(parameter.choices.size())]);
    std::string value = fmt::format("{:.4g}", numberOf(parameter, draws, from));
    if (parameter.kind == Parameter::Kind::colour && draws.oneIn(4))
        for (int c = 1; c < 3; ++c)
            value += fmt::format("/{:.4g}", numberOf(parameter, draws, from));
    return value;
}

/// One draw; its combination of parameters may be invalid.
std::string drawSpec(const Model& model, Draws& draws, DrawFrom from) {
    std::string text(model.name);
    char separator = ':';
    for (const Parameter& parameter : model.parameters) {
        const bool optional =
            parameter.fallback.has_value() || parameter.kind == Parameter::Kind::choice;
        if (optional && draws.oneIn(2)) continue;
        text += fmt::format("{}{}={}", separator, parameter.name, valueOf(parameter, draws, from));
        separator = ',';
    }
    return text;
}

/// Small tables: edges of cells matter here, not how many there are.
std::string_view smallOptions(std::string_view writer) {
    if (writer == "slices") return "size=90";
    if (writer == "rgl") return "theta=8,phi=3,slice=24,normals=32";
    return {};
}

/// A table and the command that writes it.
struct Table {
    std::shared_ptr<const Brdf> brdf;
    std::string file, command;
};

/// A table of a random model, opened from a file that is then removed. Mapped bytes stay readable.
Table randomTable(const Writer& writer, Draws& draws, std::size_t number) {
    const TemporaryFile path(fmt::format("trial{}", writer.extension));
    const std::string file = fmt::format("{}-{}{}", writer.name, number + 1, writer.extension);
    const std::string_view chosen = smallOptions(writer.name);
    constexpr int attempts = 100;
    std::string reason;
    for (int k = 0; k < attempts; ++k) {
        const Model& model = models()[draws.below(models().size())];
        const std::string spec = randomSpec(model, draws, DrawFrom::typical);
        try {
            const Parameters options = parseParameters(writer.name, writer.parameters, chosen);
            std::filesystem::remove(
                path.path());  // one that did not open: rules for files that exist would keep it
            writer.write(*open(spec), path.path(), options, {.force = true});
            return {open(path.path()), file,
                    fmt::format("hshfit convert {} {} --to {}{}{}", spec, file, writer.name,
                                chosen.empty() ? "" : ":", chosen)};
        } catch (const OutputError&) {
            throw;
        } catch (const Error& error) {  // a format cannot hold every model
            reason = error.what();
        }
    }
    throw NumericError(
        fmt::format("{}: none of {} models could be written: {}", writer.name, attempts, reason));
}

}  // namespace

double Draws::between(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(generator_() >> 11), -53);
}

double Draws::logBetween(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
}

std::size_t Draws::below(std::size_t count) {
    return static_cast<std::size_t>(between(0, static_cast<double>(count)));
}

std::string randomSpec(const Model& model, Draws& draws, DrawFrom from) {
    constexpr int attempts = 1000;
    for (int k = 0; k < attempts; ++k) {
        const std::string spec = drawSpec(model, draws, from);
        try {
            openModel(spec);
            return spec;
        } catch (const UsageError&) {  // parameters that exclude each other
        }
    }
    return std::string(model.name);
}

std::vector<stability::ErrorTrial> randomCases(const RandomCasesOptions& options) {
    Draws draws(options.seed);
    std::vector<const Writer*> formats;
    for (const Writer& writer : writers()) {
        const bool wanted =
            options.formats.empty() ||
            std::ranges::find(options.formats, writer.name) != options.formats.end();
        if (writer.readBack && wanted && options.tablesPerFormat > 0) formats.push_back(&writer);
    }
    std::vector<std::string_view> names = spelling::namesOf(models());
    for (const Writer* format : formats) names.emplace_back(format->name);
    for (const std::string& name : options.only)
        if (std::ranges::find(names, name) == names.end())
            throw spelling::unknown("model or format with random cases", name, names);
    const auto isWanted = [&](std::string_view group) {
        return options.only.empty() || std::ranges::find(options.only, group) != options.only.end();
    };
    // Written when they are first used, each from draws of its own.
    std::vector<Table> tables(formats.size() * options.tablesPerFormat);
    const std::size_t groups = models().size() + formats.size();
    std::vector<stability::ErrorTrial> cases;
    for (std::size_t k = 0; k < options.count; ++k) {
        const std::size_t group = k % groups;
        stability::ErrorTrial trial;
        if (group < models().size()) {
            const Model& model = models()[group];
            trial.group = model.name;
            trial.brdf = openModel(randomSpec(model, draws));
        } else {
            const std::size_t format = group - models().size();
            const std::size_t drawn = draws.below(options.tablesPerFormat);
            const std::size_t number = format * options.tablesPerFormat + drawn;
            trial.group = formats[format]->name;
            Table& table = tables[number];
            if (!table.brdf && isWanted(trial.group)) {
                Draws own(options.seed + 1 + number);
                table = randomTable(*formats[format], own, drawn);
            }
            trial.brdf = table.brdf;
            trial.file = table.file;
            trial.writtenBy = table.command;
        }
        const bases::Entry& entry = bases::catalog()[draws.below(bases::catalog().size())];
        trial.basis = entry.name;
        trial.order = 1 + static_cast<int>(draws.below(static_cast<std::size_t>(
                              std::min(options.maxOrder, entry.maxOrder))));
        trial.thetaDegrees = draws.between(0, 89);
        trial.phiDegrees = draws.between(0, 360);
        trial.quantity = draws.oneIn(2) ? Quantity::brdfCosine : Quantity::brdf;
        if (isWanted(trial.group)) cases.push_back(std::move(trial));
    }
    return cases;
}

}  // namespace hshfit::brdfs
