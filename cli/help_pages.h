#pragma once

#include "page.h"

#include <string>

namespace CLI {
class App;
}

namespace hshfit::cli {

/// The commands by group, the topics, the options of the program and examples.
Page programPage(const CLI::App& program);

/// The names of the commands by group and three examples: the answer to `hshfit` alone.
Page overviewPage();

/// The options of a command and its example.
Page commandPage(const CLI::App& command);

// The pages without their first paragraphs, which the manual has in sections of their own.
std::string programSummary();
Page programSections(const CLI::App& program);
Page commandSections(const CLI::App& command);

/// "hshfit project [OPTIONS] SPEC..."
std::string usageLine(const CLI::App& app);

/// Gives an app and the commands that are added to it afterwards these pages as their help, in the
/// width and the colours of standard output.
void usePagesForHelp(CLI::App& app);

}  // namespace hshfit::cli
