#include "manual.h"

#include "command.h"
#include "command_table.h"
#include "help_pages.h"
#include "job_options.h"
#include "topics.h"

#include <hshfit/files/file_set.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cctype>
#include <filesystem>

namespace hshfit::cli {
namespace {

/// The code point at `at`, which moves behind it. The texts of the tables are valid UTF-8.
char32_t takeCharacter(std::string_view text, std::size_t& at) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned char first = byte(at++);
    if (first < 0x80) return first;
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1;
    char32_t code = first & (0x3FU >> more);
    for (int k = 0; k < more && at < text.size(); ++k) code = code << 6 | (byte(at++) & 0x3FU);
    return code;
}

/// Text for roff: other than ASCII as code points; nothing is taken for a request.
std::string escaped(std::string_view text) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const char32_t code = takeCharacter(text, at);
        if (code >= 0x80)
            out += fmt::format("\\[u{:04X}]", static_cast<std::uint32_t>(code));
        else if (code == '\\')
            out += "\\e";
        else if (code == '-')
            out += "\\-";
        else if (code == '\'')
            out += "\\(aq";
        else if (code == '^')
            out += "\\(ha";
        else if (code == '~')
            out += "\\(ti";
        else if (code == '`')
            out += "\\(ga";
        else if (code == '"')
            out += "\\(dq";
        else
            out += static_cast<char>(code);
    }
    return out.starts_with('.') ? "\\&" + out : out;
}

std::string upperCase(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

std::string head(const std::string& name, int section, const std::string& help) {
    return fmt::format(".TH {} {} \"\" \"hshfit {}\" \"hshfit manual\"\n.SH NAME\n{} \\- {}\n",
                       escaped(upperCase(name)), section, version, escaped(name), escaped(help));
}

std::string synopsis(const CLI::App& app) {
    return fmt::format(".SH SYNOPSIS\n{}\n", escaped(usageLine(app)));
}

std::string blocks(const Page& page) {
    std::string out;
    bool fresh = false;
    for (const Block& block : page) {
        switch (block.kind) {
            case Block::Kind::heading:
                out += fmt::format(".SH \"{}\"\n", escaped(upperCase(block.text)));
                break;
            case Block::Kind::paragraph:
                out += fmt::format("{}{}\n", fresh ? "" : ".PP\n", escaped(block.text));
                break;
            case Block::Kind::row:
                out +=
                    fmt::format(".TP\n\\fB{}\\fR\n{}\n", escaped(block.term), escaped(block.text));
                break;
            case Block::Kind::command:
                out += fmt::format("{}.nf\n{}\n.fi\n", fresh ? "" : ".PP\n", escaped(block.text));
                break;
        }
        fresh = block.kind == Block::Kind::heading;
    }
    return out;
}

std::string seeAlso(const std::string& pages) {
    return ".SH \"SEE ALSO\"\n" + pages + "\n";
}

std::string reference(const std::string& name, int section) {
    return fmt::format("\\fB{}\\fR({})", escaped(name), section);
}

/// The folders share/man/man1 and share/man/man7 below `folder`. Returns the number of files.
/// Whether files that exist are replaced is up to the rule of the process.
std::size_t writeManual(const CLI::App& program, const std::filesystem::path& folder) {
    FileSet first(folder / "man1", true), seventh(folder / "man7", true);
    first.write("hshfit.1", programManual(program));
    for (const Command& row : commands())
        first.write(fmt::format("hshfit-{}.1", row.name),
                    commandManual(row, *program.get_subcommand(row.name)));
    for (const Topic& topic : topics())
        seventh.write(fmt::format("hshfit-{}.7", topic.name), topicManual(topic));
    first.commit();
    seventh.commit();
    return 1 + commands().size() + topics().size();
}

struct ManualArguments {
    std::string output;
};

constexpr ArgumentRow manualArguments[] = {
    requiredOutput(at<&ManualArguments::output>,
                   "Folder for man1 and man7, such as ~/.local/share/man; made if absent",
                   {.files = Files::folder}),
};

}  // namespace

std::string programManual(const CLI::App& program) {
    std::string also;
    for (const Command& row : commands())
        also += reference(fmt::format("hshfit-{}", row.name), 1) + ",\n";
    for (const Topic& topic : topics())
        also += (also.ends_with('\n') ? "" : ",\n") +
                reference(fmt::format("hshfit-{}", topic.name), 7);
    return head("hshfit", 1, "BRDFs and lights as coefficients of hemispherical bases") +
           synopsis(program) + ".SH DESCRIPTION\n" + escaped(programSummary()) + "\n" +
           blocks(programSections(program)) + seeAlso(also);
}

std::string commandManual(const Command& row, const CLI::App& command) {
    return head(fmt::format("hshfit-{}", row.name), 1, row.help) + synopsis(command) +
           blocks(commandSections(command)) +
           seeAlso(reference("hshfit", 1) + ",\n" + reference("hshfit-specifications", 7) + ",\n" +
                   reference("hshfit-exit-codes", 7));
}

std::string topicManual(const Topic& topic) {
    return head(fmt::format("hshfit-{}", topic.name), 7, topic.help) + blocks(topic.page()) +
           seeAlso(reference("hshfit", 1));
}

CommandRows manualRows() {
    return {manualArguments, {}};
}

void addManual(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ManualArguments>();
    addArguments(command, manualArguments, *arguments);
    const CLI::App* const program = command.get_parent();
    command.callback([arguments, program, &globals] {
        const std::string& output = arguments->output;
        const std::size_t pages = writeManual(*program, output);
        if (globals.json)
            printJson({{"format", "hshfit-manual"},
                       {"version", 1},
                       {"output", output},
                       {"pages", pages}});
        else
            note(globals, fmt::format("{}: {} pages in man1 and man7", output, pages));
    });
}

}  // namespace hshfit::cli
