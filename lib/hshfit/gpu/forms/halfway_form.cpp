#include <hshfit/gpu/forms/internal/form_rows.h>
#include <hshfit/gpu/forms/internal/form_text.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/halfway.h>

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace hshfit::gpu::inline forms {
namespace {

using kainjow::mustache::data;

/// The stream: runs over i (halfway_terms.h), the channels of a term next to each other; then the
/// nodes of the envelope, along a first, each in texels of its own.
struct Layout {
    HalfwayTerms terms;
    std::vector<StreamNumber> stream;
    std::vector<std::vector<std::optional<std::size_t>>> places;  ///< [position][channel]
    std::size_t envelope = 0;                                     ///< the first number of it

    explicit Layout(const Representation& form) : terms(HalfwayExpansion(form).terms()) {
        const std::size_t channels = form.head.channels.count(), count = terms.size();
        const auto& content = *form.as<HalfwayArray>();
        for (const std::size_t t : terms.position()) {
            auto& row = places.emplace_back(channels);
            for (std::size_t c = 0; c < channels; ++c) {
                const std::size_t value = c * count + t;
                if (!content.halfway.kept.empty() && !content.halfway.kept[value]) continue;
                row[c] = stream.size();
                stream.push_back({0, static_cast<std::uint32_t>(value)});
            }
        }
        if (!content.envelope) return;
        if (!content.envelope->logs.kept.empty())
            throw InputError(fmt::format("{}: an envelope has to have no mask", form.head.source));
        fillTexel();
        envelope = stream.size();
        for (std::size_t i = 0; i < content.envelope->logs.values.size(); ++i) {
            if (i % channels == 0) fillTexel();
            stream.push_back({1, static_cast<std::uint32_t>(i)});
        }
    }
    void fillTexel() {
        while (stream.size() % 4 != 0) stream.push_back({});
    }
};

std::string functionName(char axis, int n) {
    return n == 0 ? "" : fmt::format("{}{}", axis, n);
}

/// p_1 .. p_{count-1} of an axis by their recurrence, p_{n+1} = up t p_n - down p_{n-1}:
/// sqrt(2 n + 1) times that of Legendre's polynomials.
data axisSteps(char axis, int count, ShaderCost& cost) {
    data rows{data::type::list};
    for (int n = 0; n + 1 < count; ++n) {
        const double next = std::sqrt(2.0 * n + 3);
        data row;
        row.set("name", functionName(axis, n + 1));
        row.set("axis", std::string(1, axis));
        row.set("up", shaderNumber(next * std::sqrt(2.0 * n + 1) / (n + 1)));
        row.set("now", n == 0 ? data(false) : data(functionName(axis, n)));
        row.set("down", data(false));
        if (n > 0) {
            data down;
            down.set("value", shaderNumber(next / std::sqrt(2.0 * n - 1) * n / (n + 1)));
            down.set("before", n == 1 ? data(false) : data(functionName(axis, n - 1)));
            row.set("down", down);
        }
        cost.products += n == 0 ? 1 : 3;
        rows.push_back(row);
    }
    return rows;
}

std::string joined(const std::vector<std::string>& factors) {
    std::string text;
    for (const std::string& factor : factors) {
        if (!factor.empty()) text += (text.empty() ? "" : " * ") + factor;
    }
    return text;
}

std::vector<SumRun> runsOf(const Layout& layout) {
    std::vector<SumRun> runs;
    for (const HalfwayRun& run : layout.terms.runs()) {
        const HalfwayTerm& t = run.term;
        SumRun sum;
        const std::string harmonic = t.q == 0 ? "" : fmt::format("{}{}", t.sine ? "sq" : "cq", t.q);
        sum.factor = joined({functionName('d', t.j), functionName('a', t.k),
                             t.exchange ? "tau" : "", t.mirror ? "kappa" : "", harmonic});
        const int factors = (t.j > 0) + (t.k > 0) + t.exchange + t.mirror + (t.q > 0);
        sum.factorProducts = static_cast<std::size_t>(std::max(0, factors - 1));
        for (std::size_t i = 0; i < run.length; ++i) {
            sum.terms.push_back(
                {functionName('h', static_cast<int>(i)), layout.places[run.first + i]});
        }
        runs.push_back(std::move(sum));
    }
    return runs;
}

void setHarmonics(int count, FormText& text) {
    data rows{data::type::list};
    for (int q = 1; q <= count; ++q) {
        data row;
        row.set("q", std::to_string(q));
        row.set("before", q == 1 ? data(false) : data(std::to_string(q - 1)));
        rows.push_back(row);
        text.cost.products += 4;
    }
    text.page.set("harmonics", rows);
    text.page.set("turns", count > 0);
}

void setEnvelopeAxis(const char* name, std::size_t nodes, FormText& text) {
    text.page.set(name, false);
    if (nodes < 2) return;
    data axis;
    axis.set("last", shaderNumber(static_cast<double>(nodes - 1)));
    axis.set("lastCell", shaderNumber(static_cast<double>(nodes - 2)));
    text.page.set(name, axis);
}

/// Bilinear lookup of ln E: the nodes about a place, their weights, the scale of each channel.
void setEnvelope(const HalfwayEnvelope& envelope, std::size_t first, FormText& text) {
    text.page.set("envelope", false);
    if (envelope.empty()) return;
    const std::size_t base = text.setTable(first), parts = (text.channels() + 3) / 4;
    const std::size_t alongA = envelope.nodesAlongA(), alongB = envelope.nodesAlongB();
    setEnvelopeAxis("along", alongA, text);
    setEnvelopeAxis("up", alongB, text);
    data part, corners{data::type::list}, values{data::type::list};
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const bool right = corner % 2 == 1, up = corner / 2 == 1;
        if ((right && alongA < 2) || (up && alongB < 2)) continue;
        data row, fetches{data::type::list};
        row.set("corner", std::to_string(corner));
        row.set("horizontal", alongA < 2 ? "1.0" : right ? "ex" : "(1.0 - ex)");
        row.set("vertical", alongB < 2 ? "1.0" : up ? "ey" : "(1.0 - ey)");
        for (std::size_t p = 0; p < parts; ++p) {
            data fetch;
            fetch.set("part", std::to_string(p));
            fetch.set("place",
                      std::to_string(base + ((right ? 1 : 0) + (up ? alongA : 0)) * parts + p));
            fetches.push_back(fetch);
            ++text.cost.fetches;
        }
        row.set("fetches", fetches);
        corners.push_back(row);
        text.cost.products += 1 + text.channels();
    }
    for (std::size_t c = 0; c < text.channels(); ++c) {
        const LaneScale lane =
            text.constants ? LaneScale{} : text.payload.scaleOf(text.payload.stream[first + c]);
        data value, terms{data::type::list};
        value.set("i", std::to_string(c));
        value.set("scale", shaderNumber(lane.scale));
        value.set("offset", shaderNumber(lane.offset));
        bool any = false;
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if ((corner % 2 == 1 && alongA < 2) || (corner / 2 == 1 && alongB < 2)) continue;
            data term;
            term.set("first", !any);
            term.set("corner", std::to_string(corner));
            term.set("part", std::to_string(c / 4));
            term.set("lane", laneOf(c % 4));
            terms.push_back(term);
            any = true;
        }
        value.set("terms", terms);
        values.push_back(value);
    }
    part.set("corners", corners);
    part.set("values", values);
    part.set("parts", std::to_string(parts));
    part.set("row", shaderNumber(static_cast<double>(alongA)));
    part.set("ridge", shaderNumber(envelope.ridge()));
    part.set("onePlusRidge", shaderNumber(1 + envelope.ridge()));
    part.set("reciprocal", envelope.reciprocal());
    text.page.set("envelope", part);
}

}  // namespace

std::vector<StreamNumber> halfwayStream(const Representation& form) {
    return Layout(form).stream;
}

void fillHalfway(FormText& text) {
    const Layout layout(text.payload.form);
    const HalfwayExpansion expansion(text.payload.form);
    const HalfwayOrders& orders = layout.terms.orders();
    const auto any = [&](auto has) {
        for (const HalfwayRun& run : layout.terms.runs()) {
            if (has(run.term)) return true;
        }
        return false;
    };
    data steps{data::type::list};
    for (const auto& [axis, count] :
         {std::pair{'h', orders.half}, std::pair{'d', orders.difference},
          std::pair{'a', orders.azimuth}}) {
        data rows;
        rows.set("steps", axisSteps(axis, count, text.cost));
        steps.push_back(rows);
    }
    text.page.set("axes", steps);
    text.page.set("tau", any([](const HalfwayTerm& t) { return t.exchange; }));
    text.page.set("kappa", any([](const HalfwayTerm& t) { return t.mirror; }));
    setHarmonics(layout.terms.harmonics(), text);
    text.page.set("rootTwo", shaderNumber(std::sqrt(2.0)));
    text.setSums(runsOf(layout));
    text.setOutputs();
    setEnvelope(expansion.envelope(), layout.envelope, text);
}

}  // namespace hshfit::gpu::inline forms
