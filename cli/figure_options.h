#pragma once

#include <jobs/fits/figures.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace hshfit::cli {

struct Globals;

/// The options of figures for print as they are given.
struct FigureArguments {
    std::string folder, width = "column", font = std::string(defaultFigureFont), size = "8",
                        axis = "auto", panels = "auto";

    /// None without a folder. Throws UsageError for a value that makes no figure, and for a look
    /// without a folder.
    std::optional<jobs::FigureOptions> parsed() const;
};

/// The options --figures, --figure-width, --font, --font-size, --axis and --panels.
void addFigureOptions(CLI::App& command, FigureArguments& arguments);

/// The key "figures" of an answer.
nlohmann::ordered_json figuresJson(const jobs::FigureFiles& figures, const std::string& folder);
/// The lines of the same, and a note where another font stands in the figures.
std::string figuresText(const jobs::FigureFiles& figures, const FigureArguments& arguments);
void noteFont(const jobs::FigureFiles& figures, const FigureArguments& arguments,
              const Globals& globals);

}  // namespace hshfit::cli
