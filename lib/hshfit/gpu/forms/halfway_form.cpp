#include <hshfit/gpu/forms/internal/chebyshev_terms.h>
#include <hshfit/gpu/forms/internal/envelope_text.h>
#include <hshfit/gpu/forms/internal/form_rows.h>
#include <hshfit/gpu/forms/internal/form_text.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/halfway.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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
/// sqrt(2 n + 1) times that of Legendre's polynomials, or Chebyshev's, where t is doubled.
data axisSteps(char axis, int count, bool chebyshev, ShaderCost& cost) {
    data rows{data::type::list};
    for (int n = 0; n + 1 < count; ++n) {
        const double next = std::sqrt(2.0 * n + 3);
        const double up = next * std::sqrt(2.0 * n + 1) / (n + 1);
        data row;
        row.set("name", functionName(axis, n + 1));
        row.set("axis", std::string(1, axis));
        row.set("up", !chebyshev ? data(shaderNumber(up)) : n == 0 ? data("0.5") : data(false));
        row.set("now", n == 0 ? data(false) : data(functionName(axis, n)));
        row.set("down", data(false));
        if (n > 0) {
            const double value = next / std::sqrt(2.0 * n - 1) * n / (n + 1);
            const bool one = chebyshev && n > 1;
            data down;
            down.set("value", one ? data(false) : data(shaderNumber(chebyshev ? 1 : value)));
            down.set("before", n == 1 ? data(false) : data(functionName(axis, n - 1)));
            row.set("down", down);
        }
        cost.products += n == 0 || chebyshev ? 1 : 3;
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

/// Runs that differ in j only, in brackets times the other factors.
std::vector<SumGroup> groupsOf(const Layout& layout) {
    std::vector<SumGroup> groups;
    HalfwayTerm last{.k = -1};
    for (const HalfwayRun& run : layout.terms.runs()) {
        const HalfwayTerm& t = run.term;
        if (t.k != last.k || t.q != last.q || t.exchange != last.exchange ||
            t.mirror != last.mirror || t.sine != last.sine) {
            SumGroup& group = groups.emplace_back();
            const std::string harmonic =
                t.q == 0 ? "" : fmt::format("{}{}", t.sine ? "sq" : "cq", t.q);
            group.factor = joined({functionName('a', t.k), t.exchange ? "tau" : "",
                                   t.mirror ? "kappa" : "", harmonic});
            const int factors = (t.k > 0) + t.exchange + t.mirror + (t.q > 0);
            group.factorProducts = static_cast<std::size_t>(std::max(0, factors - 1));
            last = t;
        }
        SumRun sum{functionName('d', t.j), {}};
        for (std::size_t i = 0; i < run.length; ++i) {
            sum.terms.push_back(
                {functionName('h', static_cast<int>(i)), layout.places[run.first + i]});
        }
        groups.back().runs.push_back(std::move(sum));
    }
    return groups;
}

/// The constants of the text: coefficients of Chebyshev polynomials for exp2 in place of exp; of
/// the polynomials of the file where a mask leaves terms out.
std::vector<double> constantsOf(const Layout& layout, const FormPayload& payload, bool chebyshev) {
    const StoredArray& array = payload.form.as<HalfwayArray>()->halfway;
    const std::size_t count = layout.terms.size();
    std::vector<double> all = array.values;
    for (std::size_t c = 0; chebyshev && c < payload.form.head.channels.count(); ++c) {
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(c * count);
        const auto last = first + static_cast<std::ptrdiff_t>(count);
        std::ranges::copy(chebyshevValues(layout.terms, {first, last}), first);
    }
    std::vector<double> constants(payload.stream.size(), 0.0);
    for (std::size_t n = 0; n < constants.size(); ++n) {
        const StreamNumber& number = payload.stream[n];
        if (number.array == 0) constants[n] = all[number.value] * std::numbers::log2e;
    }
    return constants;
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

}  // namespace

std::vector<StreamNumber> halfwayStream(const Representation& form) {
    return Layout(form).stream;
}

void fillHalfway(FormText& text) {
    const Layout layout(text.payload.form);
    const bool chebyshev =
        text.constants && text.payload.form.as<HalfwayArray>()->halfway.kept.empty();
    if (text.constants) text.values = constantsOf(layout, text.payload, chebyshev);
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
        rows.set("steps", axisSteps(axis, count, chebyshev, text.cost));
        steps.push_back(rows);
    }
    text.page.set("axes", steps);
    text.page.set("doubled", chebyshev);
    text.page.set("span", chebyshev ? "4.0" : "2.0");
    text.page.set("halfSpan", chebyshev ? "2.0" : "1.0");
    text.page.set("expOf", text.constants ? "exp2" : "exp");
    text.page.set("bound", !text.constants);
    text.page.set("tau", any([](const HalfwayTerm& t) { return t.exchange; }));
    text.page.set("kappa", any([](const HalfwayTerm& t) { return t.mirror; }));
    setHarmonics(layout.terms.harmonics(), text);
    text.page.set("rootTwo", shaderNumber(std::sqrt(2.0)));
    text.setSums(groupsOf(layout));
    text.setOutputs();
    setEnvelope(layout.envelope, text);
}

}  // namespace hshfit::gpu::inline forms
