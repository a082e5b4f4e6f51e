#pragma once

#include <jobs/exports/formula_candidates.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// A renderer, a format or a shading language, and the kinds of candidates (choose.h) that it
/// takes.
struct Renderer {
    std::string_view name, help;
    std::vector<std::string> kinds;
    /// For coefficient files: the target of their export; empty: the file itself.
    std::string_view target = {};
};

/// Kinds of candidates: formulas and files.
std::span<const CandidateKind> candidateKinds();
/// Throws UsageError that lists the known ones.
void requireKind(std::string_view name);

/// "any" first.
std::span<const Renderer> renderers();
/// Throws UsageError that lists the known ones.
const Renderer& findRenderer(std::string_view name);

}  // namespace hshfit::jobs
