#include <brdfs/fit/dispersion_json.h>

#include <brdfs/catalog/metal_spec.h>
#include <brdfs/catalog/preset.h>
#include <brdfs/composed/spectrum.h>
#include <brdfs/fit/dispersed_problem.h>
#include <brdfs/fit/split_models.h>
#include <brdfs/presets/preset_json.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

/// The coefficients of all laws in the order of the model's parameters, each checked against its
/// box.
std::vector<double> coefficientsIn(const DispersedModel& model,
                                   const std::vector<JsonFields>& laws) {
    std::vector<double> all;
    for (std::size_t i = 0; i < model.parameterCount(); ++i) {
        const LawCurve& curve = model.curve(i);
        const auto numbers = laws[i].numbers("coefficients", curve.count());
        for (std::size_t j = 0; j < numbers.size(); ++j) {
            const double reach = 1e-6 * (1 + std::abs(numbers[j]));
            if (!(numbers[j] >= curve.lower()[j] - reach && numbers[j] <= curve.upper()[j] + reach))
                laws[i].fail(fmt::format("has {}; expected {} to {}", numbers[j], curve.lower()[j],
                                         curve.upper()[j]),
                             "coefficients");
            all.push_back(std::clamp(numbers[j], curve.lower()[j], curve.upper()[j]));
        }
    }
    return all;
}

/// Files of earlier versions have no number where a model stands more than once; their laws are in
/// the order of the parameters, as all are.
void addNumbers(const DispersedModel& model, std::vector<LawStatement>& laws) {
    for (std::size_t i = 0; i < std::min(laws.size(), model.parameterCount()); ++i)
        if (withoutNumber(model.law(i).parameter) == laws[i].parameter)
            laws[i].parameter = model.law(i).parameter;
}

}  // namespace

nlohmann::ordered_json dispersionJson(const FitResult& result) {
    nlohmann::ordered_json laws = nlohmann::ordered_json::array();
    for (const FittedLaw& own : result.laws)
        laws.push_back(
            {{"parameter", own.parameter}, {"law", own.law}, {"coefficients", own.coefficients}});
    return {{"isotropic", result.point.isotropic}, {"laws", laws}};
}

std::unique_ptr<Brdf> openDispersed(std::string_view text, const std::string& where,
                                    std::string_view wavelengths) {
    const std::vector<double> asked = wavelengthsIn(wavelengths, where + ": nm");
    const Json json = parsePresetJson(text, "hshfit-preset", where);
    const JsonFields preset(json, "", where);
    if (!preset.has("fit") || !preset.object("fit").has("dispersion"))
        throw UsageError(fmt::format(
            "{}: has no laws over the wavelength, such as hshfit fit --dispersion writes; leave "
            "out nm={}",
            where, wavelengths));
    const JsonFields fit = preset.object("fit");
    const JsonFields dispersion = fit.object("dispersion");
    std::vector<double> measured;
    for (const PresetContent::Line& line : parsePreset(text, where).spectrum)
        measured.push_back(line.wavelength);
    if (measured.empty()) preset.fail("is absent beside fit.dispersion", "spectrum");
    const std::vector<JsonFields> laws = dispersion.objects("laws");
    std::vector<LawStatement> statements;
    std::vector<Spectrum::Line> lines;
    try {
        for (const JsonFields& law : laws)
            statements.push_back(
                parseDispersion(law.word("parameter") + "=" + law.word("law")).at(0));
        addNumbers(DispersedModel(fit.word("model"), dispersion.flag("isotropic"), measured, {}),
                   statements);
        const DispersedModel model(fit.word("model"), dispersion.flag("isotropic"), measured,
                                   statements);
        if (laws.size() != model.parameterCount())
            dispersion.fail(fmt::format("has {} laws; the model has {} free parameters",
                                        laws.size(), model.parameterCount()),
                            "laws");
        for (std::size_t i = 0; i < laws.size(); ++i)
            if (statements[i].parameter != model.law(i).parameter)
                laws[i].fail(fmt::format("is {}; expected {}", statements[i].parameter,
                                         model.law(i).parameter),
                             "parameter");
        const std::vector<double> coefficients = coefficientsIn(model, laws);
        for (const double nanometres : asked)
            lines.push_back({nanometres, openModels(model.specAt(nanometres, coefficients))});
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("{}: {}", where, error.what()));
    }
    return std::make_unique<Spectrum>(std::move(lines),
                                      fmt::format("{}:nm={}", where, wavelengths));
}

}  // namespace hshfit::brdfs
