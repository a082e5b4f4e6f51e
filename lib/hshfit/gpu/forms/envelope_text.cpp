#include <hshfit/gpu/forms/internal/envelope_text.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/halfway.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace hshfit::gpu::inline forms {
namespace {

using kainjow::mustache::data;

HalfwayEnvelope envelopeOf(const Representation& form) {
    return HalfwayExpansion(form).envelope();
}

std::size_t cellsAlong(std::size_t nodes) {
    return std::max<std::size_t>(nodes, 2) - 1;
}

void setAxis(const char* name, std::size_t nodes, FormText& text) {
    text.page.set(name, false);
    if (nodes < 2) return;
    data axis;
    axis.set("last", shaderNumber(static_cast<double>(nodes - 1)));
    axis.set("lastCell", shaderNumber(static_cast<double>(nodes - 2)));
    text.page.set(name, axis);
}

/// The nodes about a place that the grid has, with their weights, and their texels.
void setCorners(const HalfwayEnvelope& envelope, std::size_t first, data& part, FormText& text) {
    const std::size_t alongA = envelope.nodesAlongA(), alongB = envelope.nodesAlongB();
    const std::size_t parts = (text.channels() + 3) / 4;
    data corners{data::type::list};
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const bool right = corner % 2 == 1, up = corner / 2 == 1;
        const bool there = !(right && alongA < 2) && !(up && alongB < 2);
        if (!there && !text.constants) continue;
        data row, fetches{data::type::list};
        row.set("corner", std::to_string(corner));
        const std::string across = alongA < 2 ? "" : right ? "ex" : "(1.0 - ex)";
        const std::string upward = alongB < 2 ? "" : up ? "ey" : "(1.0 - ey)";
        row.set("weight", !there                             ? "0.0"
                          : across.empty() && upward.empty() ? "1.0"
                          : across.empty()                   ? upward
                          : upward.empty()                   ? across
                                                             : across + " * " + upward);
        for (std::size_t p = 0; p < parts && !text.constants; ++p) {
            data fetch;
            fetch.set("part", std::to_string(p));
            fetch.set("place", std::to_string(first / 4 +
                                              ((right ? 1 : 0) + (up ? alongA : 0)) * parts + p));
            fetches.push_back(fetch);
            ++text.cost.fetches;
        }
        row.set("fetches", fetches);
        corners.push_back(row);
        text.cost.products += 1 + text.channels();
    }
    part.set("corners", corners);
    part.set("parts", std::to_string(parts));
}

/// ln E, or its logarithm to base 2 where numbers are constants, from the sum of the corners.
data valuesOf(const HalfwayEnvelope& envelope, std::size_t first, FormText& text) {
    data values{data::type::list};
    const double unit = text.constants ? std::numbers::log2e : 1;
    const StoredArray& logs = text.payload.form.as<HalfwayArray>()->envelope->logs;
    const bool one = envelope.logs().size() == text.channels();
    for (std::size_t c = 0; c < text.channels(); ++c) {
        LaneScale lane;
        if (one) {
            lane = {0, envelope.logs()[c]};
        } else if (text.constants) {
            const std::size_t group = c / logs.groupColumns();
            lane = {logs.scales[group] / 255.0, logs.offsets[group]};
        } else {
            lane = text.payload.scaleOf(text.payload.stream[first + c]);
        }
        data value;
        value.set("i", std::to_string(c));
        value.set("one", one);
        value.set("scale", shaderNumber(lane.scale * unit));
        value.set("offset", shaderNumber(lane.offset * unit));
        value.set("part", std::to_string(c / 4));
        value.set("lane", laneNames[c % 4]);
        value.set("number", std::to_string(c));
        data terms{data::type::list};
        bool any = false;
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if ((corner % 2 == 1 && envelope.nodesAlongA() < 2) ||
                (corner / 2 == 1 && envelope.nodesAlongB() < 2))
                continue;
            data term;
            term.set("first", !any);
            term.set("corner", std::to_string(corner));
            terms.push_back(term);
            any = true;
        }
        value.set("terms", terms);
        values.push_back(value);
    }
    return values;
}

void setCells(FormText& text) {
    const std::vector<std::uint32_t> cells = envelopeCells(text.payload.form);
    if (cells.empty()) return;
    data rows{data::type::list};
    for (std::size_t i = 0; i < cells.size(); i += 4) {
        data row;
        row.set("first", i == 0);
        std::vector<std::string> wholes;
        for (std::size_t lane = 0; lane < 4; ++lane) {
            row.set(laneNames[lane], std::to_string(cells[i + lane]));
            wholes.push_back(std::to_string(static_cast<std::int32_t>(cells[i + lane])));
        }
        row.set("signed", fmt::format("{}", fmt::join(wholes, ", ")));
        rows.push_back(row);
    }
    data part;
    part.set("rows", rows);
    part.set("count", std::to_string(cells.size() / 4));
    part.set("numbers", std::to_string(cells.size()));
    text.page.set("cells", part);
}

}  // namespace

std::vector<std::uint32_t> envelopeCells(const Representation& form) {
    const auto* content = form.as<HalfwayArray>();
    if (!content || !content->envelope) return {};
    const StoredArray& logs = content->envelope->logs;
    const std::size_t up = logs.shape[0], along = logs.shape[1], channels = logs.shape[2];
    if (up * along < 2) return {};
    if (logs.precision != Precision::unorm8) {
        throw UsageError(
            "a table of constants holds an envelope of 8 bits a node, which the file's is not: "
            "store the form as a texture or a block");
    }
    const auto node = [&](std::size_t a, std::size_t b, std::size_t c) {
        const std::size_t group = c / logs.groupColumns();
        const double scale = static_cast<double>(logs.scales[group]);
        const double value =
            logs.values[(b * along + a) * channels + c] - static_cast<double>(logs.offsets[group]);
        return scale == 0 ? 0U : static_cast<std::uint32_t>(std::lround(value / scale * 255));
    };
    std::vector<std::uint32_t> cells;
    for (std::size_t b = 0; b < cellsAlong(up); ++b) {
        for (std::size_t a = 0; a < cellsAlong(along); ++a) {
            const std::size_t right = std::min(a + 1, along - 1), above = std::min(b + 1, up - 1);
            for (std::size_t c = 0; c < (channels + 3) / 4 * 4; ++c) {
                cells.push_back(c >= channels
                                    ? 0
                                    : node(a, b, c) | node(right, b, c) << 8U |
                                          node(a, above, c) << 16U | node(right, above, c) << 24U);
            }
        }
    }
    return cells;
}

void setEnvelope(std::size_t first, FormText& text) {
    text.page.set("envelope", false);
    const HalfwayEnvelope envelope = envelopeOf(text.payload.form);
    if (envelope.empty()) return;
    const std::size_t alongA = envelope.nodesAlongA(), alongB = envelope.nodesAlongB();
    setAxis("along", alongA, text);
    setAxis("up", alongB, text);
    data part;
    part.set("lookup", alongA * alongB > 1);
    part.set("values", valuesOf(envelope, first, text));
    if (alongA * alongB > 1) setCorners(envelope, first, part, text);
    part.set("row",
             shaderNumber(static_cast<double>(text.constants ? cellsAlong(alongA) : alongA)));
    part.set("ridge", shaderNumber(envelope.ridge()));
    part.set("onePlusRidge", shaderNumber(1 + envelope.ridge()));
    part.set("reciprocal", envelope.reciprocal());
    text.page.set("envelope", part);
    if (text.constants) setCells(text);
}

}  // namespace hshfit::gpu::inline forms
