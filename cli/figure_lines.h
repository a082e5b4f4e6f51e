#pragma once

#include <jobs/fits/figures.h>

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::cli {

struct Globals;

/// The key "figures" of an answer.
nlohmann::ordered_json figuresJson(const jobs::FigureFiles& figures, const std::string& folder);
/// The lines of the same, and a note where another font stands in the figures.
std::string figuresText(const jobs::FigureFiles& figures, const jobs::FigureArguments& arguments);
void noteFont(const jobs::FigureFiles& figures, const jobs::FigureArguments& arguments,
              const Globals& globals);

}  // namespace hshfit::cli
