#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::cli {

/// A piece of a page of help. The terminal and the manual show the same pages.
struct Block {
    enum class Kind {
        heading,
        paragraph,
        row,      ///< a term and its explanation
        command,  ///< a command line to copy
    };
    Kind kind = Kind::paragraph;
    std::string text;
    std::string term = {};  ///< of a row
};

using Page = std::vector<Block>;

/// Appends a block.
void addHeading(Page& page, std::string text);
void addParagraph(Page& page, std::string text);
void addRow(Page& page, std::string term, std::string text);
void addCommand(Page& page, std::string line);

/// The page in lines of at most `width` columns, but for words that are longer; long command lines
/// go on after a backslash. `colour`: headings are bold.
std::string textOf(const Page& page, std::size_t width, bool colour);

/// `text` in lines of at most `width` columns, broken at spaces; those after the first begin with
/// `indent` spaces, and the first begins at column `start`.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent,
                    std::size_t start);

/// Lines longer than `width` columns broken at spaces; what follows is indented by four more.
/// Spaces within a line stay, so that columns do. A word that is longer stays whole, and so does a
/// command of this program to the end of its line, which would be cut where it is copied.
std::string folded(std::string_view text, std::size_t width);

/// Characters of a UTF-8 text, each taken to be one column wide.
std::size_t columnsOf(std::string_view text);

}  // namespace hshfit::cli
