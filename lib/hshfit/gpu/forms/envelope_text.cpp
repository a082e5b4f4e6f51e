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

/// Of the corners of a cell, those that the grid has.
bool isThere(const HalfwayEnvelope& envelope, std::size_t corner) {
    return (corner % 2 == 0 || envelope.nodesAlongA() > 1) &&
           (corner / 2 == 0 || envelope.nodesAlongB() > 1);
}

/// The texels of the nodes about a place, with their weights.
void setCorners(const HalfwayEnvelope& envelope, std::size_t first, data& part, FormText& text) {
    const std::size_t alongA = envelope.nodesAlongA(), alongB = envelope.nodesAlongB();
    const std::size_t parts = (text.channels() + 3) / 4;
    data corners{data::type::list};
    for (std::size_t corner = 0; corner < 4; ++corner) {
        if (!isThere(envelope, corner)) continue;
        const bool right = corner % 2 == 1, up = corner / 2 == 1;
        data row, fetches{data::type::list};
        row.set("corner", std::to_string(corner));
        const std::string across = alongA < 2 ? "" : right ? "ex" : "(1.0 - ex)";
        const std::string upward = alongB < 2 ? "" : up ? "ey" : "(1.0 - ey)";
        row.set("weight", across + (across.empty() || upward.empty() ? "" : " * ") + upward);
        for (std::size_t p = 0; p < parts; ++p) {
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

std::string wordOf(const FormText& text, const char* name) {
    return text.page.get(name)->string_value();
}

std::string vectorOf(const std::string& type, const std::vector<std::string>& lanes) {
    return lanes.size() == 1 ? lanes[0] : fmt::format("{}({})", type, fmt::join(lanes, ", "));
}

/// The stored numbers of channels from `first` on, between the corners of a cell: of words where
/// the numbers are constants, else of texels.
std::string betweenCorners(const HalfwayEnvelope& envelope, std::size_t first, FormText& text) {
    const std::size_t parts = (text.channels() + 3) / 4;
    const auto lanesOf = [&](auto lane) {
        std::vector<std::string> lanes;
        for (std::size_t c = first; c < first + text.together(); ++c) lanes.push_back(lane(c));
        return lanes;
    };
    if (!text.constants) {
        std::vector<std::string> terms;
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if (!isThere(envelope, corner)) continue;
            const auto lane = [&](std::size_t c) {
                return fmt::format("n{}_{}.{}", corner, c / 4, laneNames[c % 4]);
            };
            terms.push_back(
                fmt::format("w{} * {}", corner, vectorOf(wordOf(text, "vec3"), lanesOf(lane))));
        }
        return fmt::format("({})", fmt::join(terms, " + "));
    }
    const std::string prefix = wordOf(text, "prefix");
    const auto corners = [&](const std::string& word) {
        return fmt::format("{}_corners({}, {}, {})", prefix, word,
                           envelope.nodesAlongA() > 1 ? "ex" : "0.0",
                           envelope.nodesAlongB() > 1 ? "ey" : "0.0");
    };
    text.cost.products += 3 * text.together();
    if (text.page.get("flat")->is_true()) {
        const auto lane = [&](std::size_t c) {
            return corners(fmt::format("{}_cell(node * {} + {})", prefix, 4 * parts, c));
        };
        return vectorOf(wordOf(text, "vec3"), lanesOf(lane));
    }
    const auto lane = [&](std::size_t c) {
        return parts == 1 ? fmt::format("{}_cells[node].{}", prefix, laneNames[c])
                          : fmt::format("{}_cells[node * {} + {}].{}", prefix, parts, c / 4,
                                        laneNames[c % 4]);
    };
    return corners(vectorOf(wordOf(text, "words3"), lanesOf(lane)));
}

/// The scale and the offset of a channel's stored numbers, for ln E, or for its logarithm to base 2
/// where numbers are constants.
LaneScale scaleOf(const HalfwayEnvelope& envelope, std::size_t first, std::size_t channel,
                  const FormText& text) {
    const StoredArray& logs = text.payload.form.as<HalfwayArray>()->envelope->logs;
    LaneScale lane;
    if (envelope.logs().size() == text.channels()) {
        lane = {0, envelope.logs()[channel]};
    } else if (text.constants) {
        const std::size_t group = channel / logs.groupColumns();
        lane = {logs.scales[group] / 255.0, logs.offsets[group]};
    } else {
        lane = text.payload.scaleOf(text.payload.stream[first + channel]);
    }
    const double unit = text.constants ? std::numbers::log2e : 1;
    return {lane.scale * unit, lane.offset * unit};
}

/// ln E, or its logarithm to base 2, of the channels of each output.
data valuesOf(const HalfwayEnvelope& envelope, std::size_t first, FormText& text) {
    data values{data::type::list};
    const bool one = envelope.logs().size() == text.channels();
    const std::string type = wordOf(text, "vec3");
    for (std::size_t c = 0; c < text.channels(); c += text.together()) {
        std::vector<std::string> scales, offsets;
        for (std::size_t k = c; k < c + text.together(); ++k) {
            const LaneScale lane = scaleOf(envelope, first, k, text);
            scales.push_back(shaderNumber(lane.scale));
            offsets.push_back(shaderNumber(lane.offset));
        }
        data value;
        value.set("i", std::to_string(c));
        value.set("vector", text.together() > 1);
        value.set("scale", vectorOf(type, scales));
        value.set("offset", vectorOf(type, offsets));
        value.set("between", one ? data(false) : data(betweenCorners(envelope, c, text)));
        text.cost.products += one ? 0 : text.together();
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

bool hasEnvelopeCells(const Representation& form) {
    const auto* content = form.as<HalfwayArray>();
    if (!content || !content->envelope) return false;
    const StoredArray& logs = content->envelope->logs;
    return logs.shape[0] * logs.shape[1] > 1 && logs.precision == Precision::unorm8;
}

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
    if (alongA * alongB > 1 && !text.constants) setCorners(envelope, first, part, text);
    part.set("row",
             shaderNumber(static_cast<double>(text.constants ? cellsAlong(alongA) : alongA)));
    part.set("ridge", shaderNumber(envelope.ridge()));
    part.set("onePlusRidge", shaderNumber(1 + envelope.ridge()));
    part.set("reciprocal", envelope.reciprocal());
    text.page.set("envelope", part);
    if (text.constants) setCells(text);
}

}  // namespace hshfit::gpu::inline forms
