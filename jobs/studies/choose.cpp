#include "choose.h"

#include <jobs/common/inputs.h>
#include <jobs/exports/projection_cache.h>
#include <jobs/source/source.h>
#include "choose_renderers.h"
#include "stand_ins.h"

#include <hshfit/choice/choice_files.h>
#include <hshfit/error.h>
#include <hshfit/files/file_set.h>

#include <brdfs/fit/fit_samples.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

namespace hshfit::jobs {
namespace {

/// The specification in linear Rec. 709, which all candidates are.
std::string inColours(const std::string& spec) {
    return openBrdf(spec)->channels().kind == Channels::Kind::spectral ? "rgb:" + spec : spec;
}

/// The candidates whose kinds the renderer takes first, and of these the quick ones, so that the
/// time goes to them. Matrices, which are larger than halfway forms and no nearer, follow these.
std::vector<choice::Candidate> candidatesFor(const CandidateSource& source,
                                             const Renderer& renderer,
                                             const std::vector<std::string>& kinds,
                                             const tradeoff::ProjectionFolder& folder) {
    std::vector<choice::Candidate> all = formulaCandidates(source);
    std::ranges::move(formCandidates(source, std::string(renderer.target), folder),
                      std::back_inserter(all));
    all.push_back(bsdfCandidate(source));
    const auto takes = [&](const choice::Candidate& candidate) {
        return std::ranges::find(renderer.kinds, candidate.kind) != renderer.kinds.end();
    };
    std::erase_if(all, [&](const choice::Candidate& candidate) {
        const auto kind = std::ranges::find(candidateKinds(), candidate.kind, &CandidateKind::name);
        if (kind->alone && !takes(candidate)) return true;
        return !kinds.empty() && std::ranges::find(kinds, candidate.kind) == kinds.end();
    });
    const auto rank = [&](const choice::Candidate& candidate) {
        return std::tuple(!takes(candidate), candidate.kind == "coefficients", candidate.seconds);
    };
    std::ranges::stable_sort(all, [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
    return all;
}

void writeChoice(const choice::Choice& choice, const Brdf& source, FileSet& files) {
    if (choice.recommended) {
        const choice::Made& made = choice.rows[*choice.recommended].made;
        if (made.write) made.write(files);
    }
    files.write("choice.json", choiceJson(choice));
    files.write("choice.html", choicePage(choice, source));
    files.commit();
}

}  // namespace

choice::Choice choose(const std::string& spec, const std::string& output,
                      const ChooseOptions& options, const Listener& listener) {
    const Renderer& renderer = findRenderer(options.renderer);
    for (const std::string& kind : options.kinds) requireKind(kind);
    const std::string named = inColours(spec);
    const auto brdf = openBrdf(named);
    if (brdfs::areMeasured(*brdf)) {
        listener.say(
            "between scattered samples f is a guess, and pictures show that guess: candidates are "
            "compared with it");
    }
    std::optional<FileSet> files;
    if (!output.empty()) files.emplace(output, true, FileSet::Above::require);
    tradeoff::ProjectionFolder folder = options.folder;
    useCache(folder, listener);
    const CandidateSource source{*brdf, named, nameOf(spec)};
    choice::ChoiceOptions how{.renderer = std::string(renderer.name),
                              .kinds = renderer.kinds,
                              .bytes = options.bytes,
                              .error = options.error,
                              .cycles = options.cost,
                              .cpuSeconds = options.seconds,
                              .progress = listener.part("choose")};
    bool said = false;
    how.found = [&](const choice::Row& row) {
        if (std::exchange(said, true)) return;
        listener.say(fmt::format("a faithful one so far: {}, {} bytes, FLIP {:.3f}", row.name,
                                 row.made.bytes, row.picture.flip.mean));
    };
    choice::Choice chosen =
        choice::choose(*brdf, candidatesFor(source, renderer, options.kinds, folder), how);
    if (!chosen.recommended) stateExitCode(static_cast<int>(ExitCode::numeric));
    if (files) writeChoice(chosen, *brdf, *files);
    return chosen;
}

}  // namespace hshfit::jobs
