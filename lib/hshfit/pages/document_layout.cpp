#include <hshfit/pages/internal/document_layout.h>
#include <hshfit/pages/internal/print_layout.h>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <numeric>

namespace hshfit::inline pages {
namespace {

using Kind = DocumentBlock::Kind;

constexpr double textSize = 9, tableSize = 7.5, headingSize = 11, titleSize = 16;
constexpr double prose = 0.92;      ///< width of prose over the width of as many digits
constexpr double leading = 1.35;    ///< distance of lines, in sizes of the font
constexpr double nameColumn = 120;  ///< points, of pairs
constexpr double gap = 8;           ///< between columns of a table, points
constexpr double footerSpace = 22;  ///< below the text, points
constexpr double pointsPerMillimetre = 72 / 25.4;

/// The part of a word, in whole characters, that is within a width.
std::size_t fitting(const std::string& word, double width) {
    std::size_t end = 0;
    while (end < word.size()) {
        std::size_t next = end + 1;
        while (next < word.size() && (static_cast<unsigned char>(word[next]) & 0xc0) == 0x80)
            ++next;
        if (end > 0 && textWidth(word.substr(0, next)) > width) break;
        end = next;
    }
    return end;
}

/// Adds a word to the last line, or to lines of its own.
void addWord(std::string word, double width, std::vector<std::string>& lines) {
    std::string& last = lines.back();
    const std::string joined = last.empty() ? word : fmt::format("{} {}", last, word);
    if (textWidth(joined) <= width) {
        last = joined;
        return;
    }
    if (!last.empty()) lines.emplace_back();
    while (textWidth(word) > width) {
        const std::size_t part = fitting(word, width);
        lines.back() = word.substr(0, part);
        word.erase(0, part);
        if (word.empty()) return;
        lines.emplace_back();
    }
    lines.back() = word;
}

class Pages {
public:
    explicit Pages(const FigureStyle& style) : style_(style) { turn(); }

    void add(const DocumentBlock& block) {
        switch (block.kind) {
            case Kind::title:
                addLines(block.text, {.size = titleSize, .text = {}, .bold = true}, 0);
                down(0.4 * titleSize);
                break;
            case Kind::heading:
                addHeading(block.text);
                break;
            case Kind::text:
                addLines(block.text, {.text = {}}, 0);
                down(0.4 * textSize);
                break;
            case Kind::code:
                addLines(block.text, {.size = 8, .text = {}, .code = true}, 0);
                down(0.4 * textSize);
                break;
            case Kind::pairs:
                for (const auto& [name, text] : block.pairs) addPair(name, text);
                down(0.3 * textSize);
                break;
            case Kind::table:
                addTable(block);
                break;
            case Kind::figure:
                for (const PrintFigure& figure : block.figures) addFigure(figure);
                break;
        }
    }

    std::vector<DocumentPage> finished(const std::string& footer) {
        for (std::size_t k = 0; k < pages_.size(); ++k) {
            DocumentPage& page = pages_[k];
            constexpr double y = PaperSize::margin - 8;
            page.rules.push_back({PaperSize::margin, PaperSize::width - PaperSize::margin, y + 9});
            page.texts.push_back(
                {.x = PaperSize::margin, .y = y, .size = 7, .text = footer, .soft = true});
            page.texts.push_back({.x = PaperSize::width - PaperSize::margin,
                                  .y = y,
                                  .size = 7,
                                  .text = fmt::format("page {} of {}", k + 1, pages_.size()),
                                  .side = PlacedText::Side::right,
                                  .soft = true});
        }
        return std::move(pages_);
    }

private:
    void turn() {
        pages_.emplace_back();
        y_ = PaperSize::height - PaperSize::margin;
    }
    void down(double points) { y_ -= points; }
    bool isTop() const { return y_ >= PaperSize::height - PaperSize::margin; }
    /// A new page where less is left of this one.
    void need(double points) {
        if (!isTop() && y_ - points < PaperSize::margin + footerSpace) turn();
    }

    /// A text at the current height, its middle half a line below.
    void place(PlacedText text, double x, double line) {
        text.x = x;
        text.y = y_ - line / 2;
        pages_.back().texts.push_back(std::move(text));
    }

    void addLines(const std::string& text, const PlacedText& form, double indent) {
        const double line = leading * form.size;
        const auto lines =
            brokenLines(text, (PaperSize::inner - indent) / (form.code ? 1 : prose) / form.size);
        // A paragraph stands whole, with room for the lines of a table below it.
        constexpr std::size_t mostWhole = 6;
        if (lines.size() <= mostWhole) need(static_cast<double>(lines.size() + mostWhole) * line);
        for (const std::string& one : lines) {
            need(line);
            PlacedText placed = form;
            placed.text = one;
            place(std::move(placed), PaperSize::margin + indent, line);
            down(line);
        }
    }

    void addHeading(const std::string& text) {
        // At least three lines of the text below stand on the same page.
        need(headingSize * 2.2 + 3 * leading * textSize);
        if (!isTop()) down(0.6 * headingSize);
        addLines(text, {.size = headingSize, .text = {}, .bold = true}, 0);
        pages_.back().rules.push_back(
            {PaperSize::margin, PaperSize::width - PaperSize::margin, y_});
        down(0.4 * headingSize);
    }

    void addPair(const std::string& name, const std::string& text) {
        const double line = leading * textSize;
        const auto names = brokenLines(name, (nameColumn - gap) / prose / textSize);
        const auto texts = brokenLines(text, (PaperSize::inner - nameColumn) / prose / textSize);
        for (std::size_t k = 0; k < std::max(names.size(), texts.size()); ++k) {
            need(line);
            if (k < names.size()) place({.text = names[k], .soft = true}, PaperSize::margin, line);
            if (k < texts.size()) place({.text = texts[k]}, PaperSize::margin + nameColumn, line);
            down(line);
        }
    }

    /// Widths as wide as the cells; of a table that is too wide the widest columns give way.
    static std::vector<double> widthsOf(const DocumentBlock& block) {
        std::vector<double> widths;
        for (std::size_t c = 0; c < block.heads.size(); ++c) {
            double width = textWidth(block.heads[c]);
            for (const auto& row : block.rows) width = std::max(width, textWidth(row[c]));
            widths.push_back(width * tableSize);
        }
        const double most = PaperSize::inner -
                            gap * static_cast<double>(std::max<std::size_t>(widths.size(), 1) - 1);
        constexpr double step = 2, least = 20;
        while (std::accumulate(widths.begin(), widths.end(), 0.0) > most) {
            const auto widest = std::ranges::max_element(widths);
            if (*widest <= least) break;
            *widest -= step;
        }
        return widths;
    }

    void addRow(const std::vector<std::string>& cells, const DocumentBlock& block,
                const std::vector<double>& widths, bool head) {
        const double line = 1.25 * tableSize;
        std::vector<std::vector<std::string>> broken;
        std::size_t lines = 1;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            broken.push_back(brokenLines(cells[c], widths[c] / tableSize + 0.01));
            lines = std::max(lines, broken.back().size());
        }
        for (std::size_t k = 0; k < lines; ++k) {
            double x = PaperSize::margin;
            for (std::size_t c = 0; c < cells.size(); ++c) {
                const bool right = block.columns[c] == 'r';
                if (k < broken[c].size() && !broken[c][k].empty())
                    place({.size = tableSize,
                           .text = broken[c][k],
                           .side = right ? PlacedText::Side::right : PlacedText::Side::left,
                           .bold = head},
                          right ? x + widths[c] : x, line);
                x += widths[c] + gap;
            }
            down(line);
        }
    }

    void addTable(const DocumentBlock& block) {
        assert(block.columns.size() == block.heads.size());
        const std::vector<double> widths = widthsOf(block);
        const double right = PaperSize::margin +
                             std::accumulate(widths.begin(), widths.end(), 0.0) +
                             gap * static_cast<double>(widths.size() - 1);
        const double line = 1.25 * tableSize;
        const auto rule = [&] {
            down(1.5);
            pages_.back().rules.push_back({PaperSize::margin, right, y_});
            down(1.5);
        };
        const auto head = [&] {
            rule();
            addRow(block.heads, block, widths, true);
            rule();
        };
        need(5 * line);
        head();
        for (const auto& row : block.rows) {
            if (y_ - 2 * line < PaperSize::margin + footerSpace) {
                rule();
                turn();
                head();
            }
            addRow(row, block, widths, false);
        }
        rule();
        down(0.6 * textSize);
    }

    void addFigure(const PrintFigure& figure) {
        const double height = figureSize(figure, style_)[1] * pointsPerMillimetre;
        need(height);
        pages_.back().figures.push_back({&figure, PaperSize::margin, y_ - height});
        down(height + textSize);
    }

    const FigureStyle& style_;
    std::vector<DocumentPage> pages_;
    double y_ = 0;
};

}  // namespace

std::vector<std::string> brokenLines(const std::string& text, double width) {
    std::vector<std::string> lines;
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t end = std::min(text.find('\n', from), text.size());
        lines.emplace_back();
        for (std::size_t at = from; at < end;) {
            const std::size_t blank = std::min(text.find(' ', at), end);
            if (blank > at) addWord(text.substr(at, blank - at), width, lines);
            at = blank + 1;
        }
        from = end + 1;
    }
    return lines;
}

std::vector<DocumentPage> pagesOf(const PrintDocument& document, const FigureStyle& style) {
    Pages pages(style);
    for (const DocumentBlock& block : document.blocks) pages.add(block);
    return pages.finished(document.footer);
}

}  // namespace hshfit::inline pages
