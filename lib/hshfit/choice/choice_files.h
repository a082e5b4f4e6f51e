#pragma once

#include <hshfit/choice/choice.h>

#include <string>

namespace hshfit::choice {

/// The document of `choose --json` (docs/schemas/choose.schema.json), with a line feed at the end.
std::string choiceJson(const Choice& choice);

/// The table for a terminal, the recommended row and its commands.
std::string choiceText(const Choice& choice);

/// The page: the table, and spheres of source, candidate and difference of each row.
std::string choicePage(const Choice& choice, const Brdf& source);

}  // namespace hshfit::choice
