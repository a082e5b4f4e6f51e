#pragma once

#include <jobs/common/option_row.h>

#include <hshfit/brdf/brdf.h>
#include <hshfit/choice/rows.h>
#include <hshfit/wording.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// A source, for the candidates that are made of it; its BRDF outlives them.
struct CandidateSource {
    const Brdf& brdf;
    std::string spec;  ///< that commands name: with rgb: before it where the BRDF has wavelengths
    std::string name;  ///< of files
};

/// A kind of candidates (choice::Candidate).
struct CandidateKind {
    std::string_view name, help;
    bool alone = false;  ///< measured only for renderers that take it
};

/// Kinds of candidates that are no coefficient files: the model itself, fits of lobes, standard
/// materials.
std::span<const CandidateKind> formulaKinds();
std::vector<Word> formulaWords();  ///< with "none"

/// Their candidates for a source: the model itself only where the source is one of models.
std::vector<choice::Candidate> formulaCandidates(const CandidateSource& source);
/// Throws UsageError for a kind that is not known, and for "none" beside others.
void requireFormulaKinds(const std::vector<std::string>& kinds);
/// The candidates of some kinds; "none": none.
std::vector<choice::Candidate> formulaCandidates(const CandidateSource& source,
                                                 const std::vector<std::string>& kinds);

constexpr OptionRow formulasRow(Member kinds) {
    const OptionRow row{"formulas", kinds,
                        "Materials to measure beside coefficients: of model, lobes, gltf, openpbr, "
                        "usd, or none"};
    return row.takes({formulaWords, Syntax::list});
}

constexpr OptionRow costsRow(Member value) {
    return {"costs", value,
            "State the costs of shaders on an AMD GPU, by Mesa's compiler; no card is needed"};
}

/// A call of the program as a command line.
std::string commandOf(const char* function, const std::string& subject,
                      std::vector<Setting> settings, const std::string& output);

}  // namespace hshfit::jobs
