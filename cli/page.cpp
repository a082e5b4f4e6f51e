#include "page.h"

#include <algorithm>

namespace hshfit::cli {
namespace {

constexpr std::size_t margin = 2;

/// The next word of `text`, which is taken off it; "" at its end. Spaces within single quotes do
/// not end a word if `quotes` count.
std::string_view takeWord(std::string_view& text, bool quotes) {
    text.remove_prefix(std::min(text.find_first_not_of(" \n"), text.size()));
    bool quoted = false;
    std::size_t end = 0;
    for (; end < text.size(); ++end) {
        if (quotes && text[end] == '\'') quoted = !quoted;
        if (!quoted && (text[end] == ' ' || text[end] == '\n')) break;
    }
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(end);
    return word;
}

/// Words in lines; `joint` ends a line that goes on, and is counted.
std::string lines(std::string_view text, std::size_t width, std::size_t indent, std::size_t start,
                  std::string_view joint) {
    std::string out;
    std::size_t column = start;
    bool fresh = true;  // nothing stands on the line yet
    while (true) {
        const std::string_view word = takeWord(text, !joint.empty());
        if (word.empty()) return out;
        const std::size_t size = columnsOf(word), room = text.empty() ? 0 : joint.size();
        if (!fresh && column + 1 + size + room > width) {
            out += std::string(joint) + "\n" + std::string(indent, ' ');
            column = indent;
            fresh = true;
        }
        if (!fresh) out += ' ', ++column;
        out += word;
        column += size;
        fresh = false;
    }
}

std::string rowText(const Block& row, std::size_t width, std::size_t column) {
    const std::size_t end = margin + columnsOf(row.term);
    std::string out = std::string(margin, ' ') + row.term;
    if (row.text.empty()) return out + "\n";
    if (end + 2 > column) {
        // The term fills its column, and perhaps several lines.
        out = std::string(margin, ' ') + wrapped(row.term, width, 2 * margin, margin) + "\n" +
              std::string(column, ' ');
    } else {
        out += std::string(column - end, ' ');
    }
    return out + wrapped(row.text, width, column, column) + "\n";
}

/// The column in which the explanations of the rows from `first` on begin: behind the longest term,
/// but not past a third of the width.
std::size_t explanationColumn(const Page& page, std::size_t first, std::size_t width) {
    std::size_t column = 0;
    for (std::size_t k = first; k < page.size() && page[k].kind != Block::Kind::heading; ++k)
        if (page[k].kind == Block::Kind::row)
            column = std::max(column, margin + columnsOf(page[k].term) + 2);
    return std::min(column, std::max<std::size_t>(width / 3, 14));
}

/// The beginning of a command of this program that goes on to the end of the line; npos if there is
/// none.
std::size_t commandIn(std::string_view line) {
    constexpr std::string_view name = "hshfit ", behind = ": hshfit ";
    const std::size_t first = line.find_first_not_of(' ');
    if (first != line.npos && line.substr(first).starts_with(name)) return first;
    const std::size_t colon = line.find(behind);
    return colon == line.npos ? line.npos : colon + behind.size() - name.size();
}

}  // namespace

void addHeading(Page& page, std::string text) {
    page.push_back({.kind = Block::Kind::heading, .text = std::move(text)});
}

void addParagraph(Page& page, std::string text) {
    page.push_back({.kind = Block::Kind::paragraph, .text = std::move(text)});
}

void addRow(Page& page, std::string term, std::string text) {
    page.push_back({.kind = Block::Kind::row, .text = std::move(text), .term = std::move(term)});
}

void addCommand(Page& page, std::string line) {
    page.push_back({.kind = Block::Kind::command, .text = std::move(line)});
}

std::size_t columnsOf(std::string_view text) {
    return static_cast<std::size_t>(std::ranges::count_if(
        text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent,
                    std::size_t start) {
    return lines(text, width, indent, start, "");
}

std::string folded(std::string_view text, std::size_t width) {
    std::string out;
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        const bool ends = line.size() < text.size();
        text.remove_prefix(line.size() + (ends ? 1 : 0));
        const std::size_t margin = std::min(line.find_first_not_of(' '), line.size());
        std::string rest(line);
        while (columnsOf(rest) > width) {
            const std::size_t from = rest.find_first_not_of(' ');
            // A command that is copied from a terminal has to be one line.
            const std::size_t whole = commandIn(rest);
            std::size_t at = std::string::npos;
            for (std::size_t k = rest.find(' ', from); k != std::string::npos && k < whole;
                 k = rest.find(' ', k + 1)) {
                if (at != std::string::npos && columnsOf(rest.substr(0, k)) > width) break;
                at = k;
            }
            if (at == std::string::npos) break;
            out += rest.substr(0, rest.find_last_not_of(' ', at) + 1) + "\n";
            rest = std::string(margin + 4, ' ') +
                   rest.substr(std::min(rest.find_first_not_of(' ', at), rest.size()));
        }
        out += rest + (ends ? "\n" : "");
    }
    return out;
}

std::string textOf(const Page& page, std::size_t width, bool colour) {
    std::string out;
    std::size_t column = explanationColumn(page, 0, width);
    bool inSection = false;
    for (std::size_t k = 0; k < page.size(); ++k) {
        const Block& block = page[k];
        const bool follows = k > 0 && page[k - 1].kind == block.kind;
        switch (block.kind) {
            case Block::Kind::heading:
                column = explanationColumn(page, k + 1, width);
                inSection = true;
                out += (out.empty() ? "" : "\n") +
                       (colour ? "\x1b[1m" + block.text + ":\x1b[0m" : block.text + ":") + "\n";
                break;
            case Block::Kind::paragraph: {
                const std::size_t indent = inSection ? margin : 0;
                if (k > 0 && page[k - 1].kind != Block::Kind::heading) out += "\n";
                out += std::string(indent, ' ') + wrapped(block.text, width, indent, indent) + "\n";
                break;
            }
            case Block::Kind::row:
                if (k > 0 && page[k - 1].kind == Block::Kind::paragraph) out += "\n";
                out += rowText(block, width, column);
                break;
            case Block::Kind::command:
                if (k > 0 && !follows && page[k - 1].kind != Block::Kind::heading) out += "\n";
                out += std::string(margin, ' ') +
                       lines(block.text, width, 3 * margin, margin, " \\") + "\n";
                break;
        }
    }
    return out;
}

}  // namespace hshfit::cli
