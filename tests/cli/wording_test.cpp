// Messages of lib and jobs name settings and functions; the program knows each as an option or a
// command of its own.

#include "places.h"

#include <cli/command.h>
#include <cli/command_table.h>
#include <cli/wording.h>

#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace {

namespace fs = std::filesystem;

/// The first group of every match in the sources of lib and jobs.
std::set<std::string> foundInSources(const std::string& pattern) {
    const std::regex expression(pattern);
    std::set<std::string> found;
    for (const char* folder : {"/lib", "/brdfs", "/jobs"}) {
        for (const auto& entry :
             fs::recursive_directory_iterator(hshfit::test::sourceFolder() + std::string(folder))) {
            if (entry.path().extension() != ".cpp") continue;
            std::ifstream file(entry.path());
            const std::string text((std::istreambuf_iterator<char>(file)), {});
            for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end;
                 ++at)
                found.insert((*at)[1]);
        }
    }
    return found;
}

/// The long options of all commands.
std::set<std::string> optionsOfCommands() {
    CLI::App app;
    hshfit::cli::Globals globals;
    std::set<std::string> names;
    for (const hshfit::cli::Command& row : hshfit::cli::commands()) {
        hshfit::cli::addCommand(app, globals, row);
        for (const CLI::Option* option : app.get_subcommand(row.name)->get_options())
            for (const std::string& name : option->get_lnames()) names.insert("--" + name);
    }
    return names;
}

TEST(Wording, EverySettingInMessagesIsAnOption) {
    const auto members = foundInSources("\"([A-Z][A-Za-z]*::[A-Za-z.]+)\"");
    EXPECT_GE(members.size(), 25u);
    const std::set<std::string> known = optionsOfCommands();
    for (const std::string& member : members) {
        const std::string option = hshfit::cli::optionWording().setting({member});
        EXPECT_TRUE(known.contains(option)) << member << " -> " << option;
    }
}

TEST(Wording, EveryFunctionInMessagesIsACommandOrAnOption) {
    const auto functions = foundInSources("\\.function = \"([A-Za-z]+)\"");
    EXPECT_GE(functions.size(), 6u);
    for (const std::string& function : functions) {
        const std::string command = hshfit::cli::optionWording().call({.function = function});
        EXPECT_TRUE(command.starts_with("hshfit ") || command.starts_with("--"))
            << function << " -> " << command;
    }
}

TEST(Wording, LibraryNamesItsOwnInterface) {
    const hshfit::Setting rank{"Form::rank", "3"};
    EXPECT_EQ(fmt::format("{} and {}", rank, hshfit::Setting{"Form::reciprocal"}),
              "Form::rank = 3 and Form::reciprocal");
    EXPECT_EQ(fmt::format("{}", hshfit::Call{.function = "represent",
                                             .subject = "lambert",
                                             .settings = {rank},
                                             .output = "l.json"}),
              "represent(lambert, Form::rank = 3, l.json)");
}

TEST(Wording, ValuesAreQuotedForAShell) {
    const hshfit::Wording wording = hshfit::cli::optionWording();
    EXPECT_EQ(wording.setting({"Form::split", "a b"}), "--split 'a b'");
    EXPECT_EQ(wording.setting({"Form::quantity", "brdf_cosine"}), "--cosine");
    EXPECT_EQ(wording.call({.function = "represent",
                            .subject = "it's",
                            .settings = {{"Form::rank", "3"}},
                            .output = "o.json"}),
              "hshfit project 'it'\\''s' --rank 3 -o o.json --force");
    EXPECT_EQ(wording.call({.function = "writeRepresentation",
                            .subject = "ggx:alpha=.2",
                            .settings = {{"Form::rank", "3"}},
                            .output = "OUT.json"}),
              "hshfit project ggx:alpha=.2 -o OUT.json --rank 3");
}

}  // namespace
