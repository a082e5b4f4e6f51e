#include <hshfit/gpu/forms/internal/form_text.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace hshfit::gpu::inline forms {
namespace {

using kainjow::mustache::data;

data list() {
    return data{data::type::list};
}

/// The value of a constant.
double valueAt(const FormText& text, std::size_t place) {
    return text.values.empty() ? text.payload.valueOf(text.payload.stream[place])
                               : text.values[place];
}

std::string numberText(const FormText& text, std::optional<std::size_t> place) {
    if (!place) return "0.0";
    if (text.constants) return shaderNumber(valueAt(text, *place));
    return fmt::format("x{}.{}", *place / 4, laneNames[*place % 4]);
}

/// Whether any channel of a group has a number that the text has to name.
bool used(const FormText& text, const SumTerm& term, std::size_t first, std::size_t count) {
    return std::any_of(term.numbers.begin() + static_cast<std::ptrdiff_t>(first),
                       term.numbers.begin() + static_cast<std::ptrdiff_t>(first + count),
                       [&](const auto& place) {
                           return place && !(text.constants && valueAt(text, *place) == 0);
                       });
}

/// The row that fetches a texel, with the scale of its lanes.
data fetchRow(const FormText& text, std::size_t texel) {
    data row;
    row.set("k", std::to_string(texel));
    row.set("affine", false);
    std::vector<std::string> scales, offsets;
    bool plain = true;
    for (std::size_t i = 4 * texel; i < 4 * texel + 4; ++i) {
        const bool there = i < text.payload.stream.size();
        const LaneScale lane = there ? text.payload.scaleOf(text.payload.stream[i]) : LaneScale{};
        plain &= lane.scale == 1 && lane.offset == 0;
        scales.push_back(shaderNumber(lane.scale));
        offsets.push_back(shaderNumber(lane.offset));
    }
    ++text.cost.fetches;
    if (plain) return row;
    data affine;
    affine.set("scales", fmt::format("{}", fmt::join(scales, ", ")));
    affine.set("offsets", fmt::format("{}", fmt::join(offsets, ", ")));
    row.set("affine", affine);
    text.cost.products += 4;
    return row;
}

/// Fetches of the texels that terms need and that none before needed.
data fetchesOf(const FormText& text, const SumRun& run, std::size_t& next) {
    data rows = list();
    if (text.constants) return rows;
    std::size_t end = next;
    for (const SumTerm& term : run.terms) {
        for (const auto& place : term.numbers) {
            if (place) end = std::max(end, *place / 4 + 1);
        }
    }
    for (; next < end; ++next) rows.push_back(fetchRow(text, next));
    return rows;
}

/// The terms of a run for the channels of one vector; none: an empty list.
data termsOf(const FormText& text, const SumRun& run, std::size_t first) {
    data terms = list();
    bool any = false;
    const std::size_t count = run.name.empty() ? text.together() : 1;
    for (const SumTerm& term : run.terms) {
        if (!used(text, term, first, count)) continue;
        std::vector<std::string> numbers;
        for (std::size_t c = first; c < first + count; ++c)
            numbers.push_back(numberText(text, term.numbers[c]));
        data row;
        row.set("first", !any);
        row.set("function", term.function.empty() ? data(false) : data(term.function));
        row.set("numbers", fmt::format("{}", fmt::join(numbers, ", ")));
        terms.push_back(row);
        text.cost.products += term.function.empty() ? 0 : count;
        any = true;
    }
    return terms;
}

data flagOr(const std::string& text) {
    return text.empty() ? data(false) : data(text);
}

data zeroTerm() {
    data row;
    row.set("first", true);
    row.set("function", false);
    row.set("numbers", "0.0");
    return row;
}

/// A statement that adds a run to a sum, or begins it.
data statement(const FormText& text, const SumRun& run, const std::string& sum, bool begins,
               const data& terms) {
    data row;
    row.set("sum", sum);
    row.set("begins", begins);
    row.set("vector", run.name.empty() && text.together() > 1);
    row.set("factor", flagOr(run.factor));
    row.set("terms", terms);
    if (!run.factor.empty()) text.cost.products += text.together();
    return row;
}

}  // namespace

std::size_t FormText::together() const {
    return payload.form.head.channels.kind == Channels::Kind::rgb ? 3 : 1;
}

void FormText::setSums(const std::vector<SumGroup>& groups) {
    data sums = list(), rows = list();
    std::set<char> letters{'s'};
    for (const SumGroup& group : groups) letters.insert(group.sum);
    for (const char letter : letters) {
        for (std::size_t c = 0; c < channels(); c += together()) {
            data sum;
            sum.set("name", fmt::format("{}{}", letter, c));
            sum.set("vector", together() > 1);
            sums.push_back(sum);
        }
    }
    std::size_t next = 0, g = 0;
    for (const SumGroup& group : groups) {
        const bool nested = !group.factor.empty();
        std::vector<bool> begun(channels(), false);
        data row, steps = list(), ends = list();
        for (const SumRun& run : group.runs) {
            data step, statements = list();
            step.set("fetches", fetchesOf(*this, run, next));
            if (!run.name.empty()) {
                data terms = termsOf(*this, run, 0);
                if (terms.is_empty_list()) terms.push_back(zeroTerm());
                statements.push_back(statement(*this, run, run.name, true, terms));
            }
            for (std::size_t c = 0; run.name.empty() && c < channels(); c += together()) {
                const data terms = termsOf(*this, run, c);
                if (terms.is_empty_list()) continue;
                const std::string sum =
                    nested ? fmt::format("t{}_{}", g, c) : fmt::format("{}{}", group.sum, c);
                statements.push_back(statement(*this, run, sum, nested && !begun[c], terms));
                begun[c] = true;
            }
            step.set("statements", statements);
            steps.push_back(step);
        }
        bool any = false;
        for (std::size_t c = 0; nested && c < channels(); c += together()) {
            if (!begun[c]) continue;
            data end;
            end.set("sum", fmt::format("{}{}", group.sum, c));
            end.set("part", fmt::format("t{}_{}", g, c));
            ends.push_back(end);
            cost.products += together();
            any = true;
        }
        row.set("g", std::to_string(g++));
        row.set("steps", steps);
        row.set("factor", any ? data(group.factor) : data(false));
        row.set("ends", ends);
        if (any) cost.products += group.factorProducts;
        rows.push_back(row);
    }
    page.set("sums", sums);
    page.set("groups", rows);
}

void FormText::setOutputs() {
    data outputs = list();
    for (std::size_t c = 0; c < channels(); c += together()) {
        data row;
        row.set("i", std::to_string(c));
        row.set("vector", together() > 1);
        row.set("added", false);
        if (!payload.constant.empty()) {
            std::vector<std::string> numbers;
            for (std::size_t k = c; k < c + together(); ++k)
                numbers.push_back(shaderNumber(payload.constant[k]));
            row.set("added", fmt::format("{}", fmt::join(numbers, ", ")));
        }
        outputs.push_back(row);
    }
    page.set("outputs", outputs);
}

}  // namespace hshfit::gpu::inline forms
