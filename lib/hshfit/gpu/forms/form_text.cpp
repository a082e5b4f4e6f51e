#include <hshfit/gpu/forms/internal/form_text.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace hshfit::gpu::inline forms {
namespace {

using kainjow::mustache::data;

data list() {
    return data{data::type::list};
}

bool isRgb(const FormText& text) {
    return text.payload.form.head.channels.kind == Channels::Kind::rgb;
}

std::string numberText(const FormText& text, std::optional<std::size_t> place) {
    if (!place) return "0.0";
    if (text.constants) return shaderNumber(text.payload.valueOf(text.payload.stream[*place]));
    return fmt::format("x{}.{}", *place / 4, laneOf(*place % 4));
}

/// Whether any channel of a group has a number that the text has to name.
bool used(const FormText& text, const SumTerm& term, std::size_t first, std::size_t count) {
    return std::any_of(
        term.numbers.begin() + static_cast<std::ptrdiff_t>(first),
        term.numbers.begin() + static_cast<std::ptrdiff_t>(first + count), [&](const auto& place) {
            return place &&
                   !(text.constants && text.payload.valueOf(text.payload.stream[*place]) == 0);
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

data groupOf(const FormText& text, const SumRun& run, std::size_t first, std::size_t count) {
    data terms = list();
    bool any = false;
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
        text.cost.products += count;
        any = true;
    }
    data group;
    group.set("g", std::to_string(first));
    group.set("vector", count > 1);
    group.set("terms", terms);
    group.set("any", any);
    return group;
}

}  // namespace

std::string laneOf(std::size_t index) {
    return laneNames[index];
}

void FormText::setSums(const std::vector<SumRun>& runs) {
    const std::size_t together = isRgb(*this) ? 3 : 1;
    data sums = list(), rows = list();
    for (std::size_t c = 0; c < channels(); c += together) {
        data sum;
        sum.set("g", std::to_string(c));
        sum.set("vector", together > 1);
        sums.push_back(sum);
    }
    std::size_t next = 0, r = 0;
    for (const SumRun& run : runs) {
        data row;
        row.set("r", std::to_string(r++));
        row.set("fetches", fetchesOf(*this, run, next));
        data groups = list();
        bool any = false;
        for (std::size_t c = 0; c < channels(); c += together) {
            const bool here = std::any_of(run.terms.begin(), run.terms.end(), [&](const auto& t) {
                return used(*this, t, c, together);
            });
            if (!here) continue;
            groups.push_back(groupOf(*this, run, c, together));
            any = true;
        }
        row.set("groups", groups);
        row.set("factor", run.factor.empty() || !any ? data(false) : data(run.factor));
        if (any) cost.products += run.factorProducts + (run.factor.empty() ? 0 : channels());
        rows.push_back(row);
    }
    page.set("sums", sums);
    page.set("runs", rows);
}

void FormText::setOutputs() {
    data outputs = list();
    for (std::size_t c = 0; c < channels(); ++c) {
        data row;
        row.set("i", std::to_string(c));
        row.set("sum", isRgb(*this) ? "s0." + laneOf(c) : fmt::format("s{}", c));
        outputs.push_back(row);
    }
    page.set("outputs", outputs);
}

std::size_t FormText::setTable(std::size_t first) {
    if (!constants) return first / 4;
    data rows = list();
    std::size_t count = 0;
    for (std::size_t i = first; i < payload.stream.size(); i += 4, ++count) {
        std::vector<std::string> lanes;
        for (std::size_t k = i; k < i + 4; ++k) {
            lanes.push_back(
                shaderNumber(k < payload.stream.size() ? payload.valueOf(payload.stream[k]) : 0));
        }
        data row;
        row.set("first", count == 0);
        row.set("numbers", fmt::format("{}", fmt::join(lanes, ", ")));
        rows.push_back(row);
    }
    data table;
    table.set("rows", rows);
    table.set("count", std::to_string(count));
    table.set("numbersInTable", std::to_string(4 * count));
    page.set("table", table);
    return 0;
}

}  // namespace hshfit::gpu::inline forms
