#pragma once

#include <hshfit/gpu/shader.h>
#include <hshfit/gpu/texels.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::gpu::inline engines {

/// A file with a complete material for one engine: a row for each. docs/renderers/ has its page.
struct EngineFile {
    std::string_view target;  ///< of targets.h
    std::string_view suffix;  ///< of the file, after the name of the export
    Language language;        ///< of the snippet in it
    std::string_view prefilter =
        {};                ///< whose environment it looks up (lighting/prefilter.h); empty: none
    bool script = false;   ///< the snippet stands in a literal of JavaScript
    bool textures = true;  ///< takes numbers as a texture; else as constants alone
};
std::span<const EngineFile> engineFiles();

/// The words of the templates. Snippets come from shader.h and form_shader.h, without sampling.
struct EngineMaterial {
    std::string name;  ///< of the export
    std::string title = {}, prefix = {}, snippet = {};
    bool cosine = false;   ///< eval has the cosine in it
    bool fetched = false;  ///< texels are fetched without a filter
    std::optional<Texels> texels = {};
    std::string lookUps = {};              ///< PREFIX_prefiltered in the same language; empty: none
    bool along = false;                    ///< it takes a tangent
    std::vector<float> lookUpTexels = {};  ///< RGBA by rows
    std::size_t lookUpWidth = 0, lookUpHeight = 0;
};

/// The text of the file. Throws UsageError for a texture where the engine's file takes none.
std::string engineFile(const EngineFile& row, const EngineMaterial& material);

}  // namespace hshfit::gpu::inline engines
