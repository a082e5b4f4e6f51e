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

/// The cycles of a row ("-": not known), and a sentence without its point that says what they are.
std::string cyclesText(const Row& row);
std::string costsText(const Choice& choice);

/// The commands that write a row, as one line of a shell; empty: there is no file to write.
std::string commandLineOf(const Row& row);

}  // namespace hshfit::choice
