#include <hshfit/gpu/forms/internal/chebyshev_terms.h>
#include <hshfit/gpu/forms/internal/form_rows.h>
#include <hshfit/gpu/forms/internal/form_text.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/halfway.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace hshfit::gpu::inline forms {
namespace {

using kainjow::mustache::data;

/// The stream: runs over i (halfway_terms.h), the channels of a term next to each other.
struct Layout {
    HalfwayExpansion expansion;
    std::vector<StreamNumber> stream;
    std::vector<std::vector<std::optional<std::size_t>>> places;  ///< [position][channel]

    explicit Layout(const Representation& form) : expansion(form) {
        const std::size_t channels = form.head.channels.count(), count = terms().size();
        const auto& content = *form.as<HalfwayArray>();
        for (const std::size_t t : terms().position()) {
            auto& row = places.emplace_back(channels);
            for (std::size_t c = 0; c < channels; ++c) {
                const std::size_t value = c * count + t;
                if (!content.halfway.kept.empty() && !content.halfway.kept[value]) continue;
                row[c] = stream.size();
                stream.push_back({0, static_cast<std::uint32_t>(value)});
            }
        }
    }
    const HalfwayTerms& terms() const { return expansion.terms(); }
};

std::string functionName(char axis, int n) {
    return n == 0 ? "" : fmt::format("{}{}", axis, n);
}

/// p_1 .. p_{count-1} of an axis by their recurrence, p_{n+1} = up t p_n - down p_{n-1}: Legendre's
/// polynomials times sqrt(2 n + 1), or Chebyshev's polynomials, for which t is doubled.
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

/// The factors that runs have in common that differ in j only.
SumGroup groupFor(const HalfwayTerm& t) {
    const std::string power = t.power() > 0 ? fmt::format("xk{}", t.power()) : "";
    const std::string harmonic = t.q > 0 ? fmt::format("{}{}", t.sine ? "sq" : "cq", t.q) : "";
    const std::vector<std::string> factors{t.lobe ? power : functionName('p', t.k),
                                           !t.lobe && t.exchange ? "gap" : "",
                                           t.mirror ? "handed" : "", harmonic};
    const auto count = std::ranges::count_if(factors, [](const auto& f) { return !f.empty(); });
    SumGroup group;
    group.factor = joined(factors);
    group.factorProducts = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, count - 1));
    group.sum = t.lobe ? 'l' : 's';
    return group;
}

bool sameGroup(const HalfwayTerm& a, HalfwayTerm b) {
    b.i = a.i;
    b.j = a.j;
    return a == b;
}

/// Runs that differ in j only, in brackets times the other factors.
std::vector<SumGroup> groupsOf(const Layout& layout) {
    std::vector<SumGroup> groups;
    HalfwayTerm last{.k = -1};
    for (const HalfwayRun& run : layout.terms().runs()) {
        if (!sameGroup(run.term, last)) groups.push_back(groupFor(run.term));
        last = run.term;
        SumRun sum{functionName('d', last.j), {}};
        for (std::size_t i = 0; i < run.length; ++i) {
            sum.terms.push_back({functionName(last.lobe ? 'h' : 'm', static_cast<int>(i)),
                                 layout.places[run.first + i]});
        }
        groups.back().runs.push_back(std::move(sum));
    }
    return groups;
}

/// The constants of the text: coefficients of Chebyshev polynomials for exp2 in place of exp; of
/// the polynomials of the file where a mask leaves terms out.
std::vector<double> constantsOf(const Layout& layout, const FormPayload& payload, bool chebyshev) {
    const StoredArray& array = payload.form.as<HalfwayArray>()->halfway;
    const std::size_t count = layout.terms().size();
    std::vector<double> all = array.values;
    for (std::size_t c = 0; chebyshev && c < payload.form.head.channels.count(); ++c) {
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(c * count);
        const auto last = first + static_cast<std::ptrdiff_t>(count);
        std::ranges::copy(chebyshevValues(layout.terms(), {first, last}), first);
    }
    std::vector<double> constants(payload.stream.size(), 0.0);
    for (std::size_t n = 0; n < constants.size(); ++n)
        constants[n] = all[payload.stream[n].value] * std::numbers::log2e;
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

/// x kappa^n.
void setPowers(const HalfwayTerms& terms, FormText& text) {
    int most = 0;
    for (const HalfwayRun& run : terms.runs()) most = std::max(most, run.term.power());
    data rows{data::type::list};
    for (int n = 1; n <= most; ++n) {
        data row;
        row.set("n", std::to_string(n));
        row.set("before", n == 1 ? data("x") : data(fmt::format("xk{}", n - 1)));
        rows.push_back(row);
        ++text.cost.products;
    }
    text.page.set("powers", rows);
    text.page.set("kappa", most > 0);
}

/// The constants of the lobe: for an isotropic one the square of its stretch alone.
void setLobe(const Layout& layout, bool isotropic, FormText& text) {
    const HalfwayAxes::Constants& axes = layout.expansion.axes().constants();
    const bool round = isotropic && layout.terms().harmonics() == 0;
    text.page.set("round", round);
    text.page.set("stretch", shaderNumber(axes.xx * axes.xx));
    text.page.set("xx", shaderNumber(axes.xx));
    text.page.set("xy", shaderNumber(axes.xy));
    text.page.set("yx", shaderNumber(axes.yx));
    text.page.set("yy", shaderNumber(axes.yy));
    text.page.set("perLog", shaderNumber(axes.perLog));
    text.page.set("amplitude", shaderNumber(axes.amplitude));
    text.page.set("shelf", shaderNumber(axes.shelf));
    text.page.set("masked", axes.masked);
    text.page.set("lxx", shaderNumber(axes.lxx));
    text.page.set("lxy", shaderNumber(axes.lxy));
    text.page.set("lyy", shaderNumber(axes.lyy));
    text.cost.products += (round ? 13 : 17) + (axes.masked ? 16 : 0);
}

/// The ceilings of the channels of each output; exponents to the base of the text's exponential.
void setCeilings(const HalfwayExpansion& expansion, FormText& text) {
    const double unit = text.constants ? std::numbers::log2e : 1;
    const std::tuple<const char*, double HalfwayCeiling::*, double> parts[] = {
        {"smooth", &HalfwayCeiling::smooth, unit},
        {"lobe", &HalfwayCeiling::lobe, unit},
        {"top", &HalfwayCeiling::top, 1}};
    data rows{data::type::list};
    for (std::size_t c = 0; c < text.channels(); c += text.together()) {
        data row;
        row.set("i", std::to_string(c));
        row.set("vector", text.together() > 1);
        for (const auto& [name, member, scale] : parts) {
            std::vector<std::string> numbers;
            for (std::size_t k = c; k < c + text.together(); ++k)
                numbers.push_back(shaderNumber(expansion.ceilings()[k].*member * scale));
            row.set(name, fmt::format("{}", fmt::join(numbers, ", ")));
        }
        rows.push_back(row);
    }
    text.page.set("ceilings", rows);
}

}  // namespace

std::vector<StreamNumber> halfwayStream(const Representation& form) {
    return Layout(form).stream;
}

void fillHalfway(FormText& text) {
    const Layout layout(text.payload.form);
    const HalfwayTerms& terms = layout.terms();
    const bool chebyshev =
        text.constants && text.payload.form.as<HalfwayArray>()->halfway.kept.empty();
    if (text.constants) text.values = constantsOf(layout, text.payload, chebyshev);
    const HalfwayCounts& counts = terms.counts();
    const auto any = [&](auto has) {
        return std::ranges::any_of(terms.runs(), [&](const auto& run) { return has(run.term); });
    };
    data steps{data::type::list};
    for (const auto& [axis, count] : {std::pair{'m', counts.mean}, std::pair{'p', counts.product},
                                      std::pair{'d', counts.v}, std::pair{'h', counts.x}}) {
        data rows;
        rows.set("steps", axisSteps(axis, count, chebyshev, text.cost));
        steps.push_back(rows);
    }
    text.page.set("axes", steps);
    text.page.set("span", chebyshev ? "4.0" : "2.0");
    text.page.set("doubled", chebyshev);
    text.page.set("halfSpan", chebyshev ? "2.0" : "1.0");
    text.page.set("expOf", text.constants ? "exp2" : "exp");
    text.page.set("gap", any([](const HalfwayTerm& t) { return !t.lobe && t.exchange; }));
    text.page.set("handed", any([](const HalfwayTerm& t) { return t.mirror; }));
    setHarmonics(terms.harmonics(), text);
    setPowers(terms, text);
    setLobe(layout, text.payload.form.head.isotropic, text);
    text.page.set("rootTwo", shaderNumber(std::sqrt(2.0)));
    text.setSums(groupsOf(layout));
    text.setOutputs();
    setCeilings(layout.expansion, text);
}

}  // namespace hshfit::gpu::inline forms
