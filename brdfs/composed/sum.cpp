#include <brdfs/composed/sum.h>

#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/specification/sums.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>

namespace hshfit::brdfs {
namespace {

constexpr std::string_view plus = " + ", times = " * ";
constexpr double mostWeight = 1e6;

/// "0.5 * SPEC" in its parts, with or without spaces; `number` is empty if it does not begin with a
/// number and '*'. Without spaces the rest has to begin with a letter, a digit or '/', so that the
/// pattern "2*.binary" is no product.
struct Factors {
    std::string_view number, rest;
    double weight = 1;
    std::errc error = {};

    explicit Factors(std::string_view term) : rest(term) {
        const std::size_t star = term.find('*');
        if (star == std::string_view::npos) return;
        const std::string_view before = withoutSpaces(term.substr(0, star));
        const std::string_view after = withoutSpaces(term.substr(star + 1));
        const char* const last = before.data() + before.size();
        const auto parsed = std::from_chars(before.data(), last, weight);
        const bool spaced = term.substr(star).starts_with("* ") && before.size() < star;
        const bool begins =
            !after.empty() &&
            (after[0] == '/' || std::isalnum(static_cast<unsigned char>(after[0])) != 0);
        if (before.empty() || parsed.ptr != last || !(spaced || begins)) {
            weight = 1;
            return;
        }
        number = before;
        rest = after;
        error = parsed.ec;
    }
};

WeightedSpec parseTerm(std::string_view term) {
    const Factors factors(term);
    if (factors.error != std::errc{} || !(factors.weight >= 0 && factors.weight <= mostWeight))
        throw UsageError(fmt::format("sum: weight {} in '{}' is out of range; valid: 0 to {}",
                                     factors.number, term, mostWeight));
    return {factors.weight + 0.0, std::string(factors.rest)};
}

/// The end of the term that starts at `start`: the next joint, unless a longer text is a whole.
std::size_t endOfTerm(std::string_view spec, std::size_t start, bool (*isWhole)(std::string_view)) {
    std::vector<std::size_t> ends;
    for (std::size_t at = nextJoint(spec, start); at != std::string_view::npos;
         at = nextJoint(spec, at + 1))
        ends.push_back(at);
    ends.push_back(spec.size());
    for (auto end = ends.rbegin(); end != ends.rend(); ++end) {
        const std::string_view term = withoutSpaces(spec.substr(start, *end - start));
        if (isWhole(term) || isWhole(Factors(term).rest)) return *end;
    }
    return ends.front();
}

/// "wavelengths 400 to 700 nm (31)" and the like.
std::string described(const Channels& channels) {
    if (channels.kind == Channels::Kind::named)
        return fmt::format("{} channels from {}", channels.count(), channels.names().front());
    if (channels.kind != Channels::Kind::spectral)
        return channels.kind == Channels::Kind::grey ? "grey" : "rgb";
    return fmt::format("{} wavelengths from {} to {} nm", channels.count(),
                       channels.wavelengths.front(), channels.wavelengths.back());
}

Channels mergedChannels(const std::vector<Sum::Term>& terms) {
    const Brdf* widest = terms.front().brdf.get();
    for (const Sum::Term& term : terms) {
        const Channels& channels = term.brdf->channels();
        if (widest->channels().serve(channels)) widest = term.brdf.get();
        if (!channels.serve(widest->channels()))
            throw UsageError(
                fmt::format("sum: '{}' is {} but '{}' is {}; all terms but grey ones "
                            "have to have the same channels",
                            widest->name(), described(widest->channels()), term.brdf->name(),
                            described(channels)));
    }
    return widest->channels();
}

/// The first term's side is the side of all.
std::vector<Sum::Term> ofOneSide(std::vector<Sum::Term> terms) {
    for (const Sum::Term& term : terms) requireSameSide(*terms.front().brdf, *term.brdf);
    return terms;
}

Laws commonLaws(const std::vector<Sum::Term>& terms) {
    Laws laws{true, true, true, true, true};
    double total = 0;
    for (const Sum::Term& term : terms) {
        const Laws& own = term.brdf->laws();
        laws.nonNegative &= own.nonNegative;
        laws.reciprocal &= own.reciprocal;
        laws.isotropic &= own.isotropic;
        laws.mirrorSymmetric &= own.mirrorSymmetric;
        laws.energyConserving &= own.energyConserving || term.weight == 0;
        if (own.energyConserving) total += term.weight;
    }
    laws.energyConserving &= total <= 1;
    return laws;
}

std::string joinedNames(const std::vector<Sum::Term>& terms) {
    std::string name;
    for (const Sum::Term& term : terms) {
        if (!name.empty()) name += plus;
        if (term.weight != 1) name += fmt::format("{}{}", term.weight, times);
        name += term.brdf->name();
    }
    return name;
}

}  // namespace

std::vector<WeightedSpec> splitSum(std::string_view spec, bool (*isWhole)(std::string_view)) {
    if (isWhole(spec)) return {{1, std::string(spec)}};
    std::size_t joints = 0;
    for (std::size_t at = nextJoint(spec, 0); at != std::string_view::npos;
         at = nextJoint(spec, at + 1))
        ++joints;
    if (joints >= mostTerms)
        throw UsageError(fmt::format("sum: '{}…' has {} terms; valid: at most {}",
                                     spec.substr(0, 40), joints + 1, mostTerms));
    std::vector<WeightedSpec> terms;
    for (std::size_t start = 0;;) {
        const std::size_t end = endOfTerm(spec, start, isWhole);
        // Spaces around a '+' mean nothing; a single specification is taken as it is.
        const bool single = start == 0 && end == spec.size();
        const std::string_view term =
            single ? spec : withoutSpaces(spec.substr(start, end - start));
        terms.push_back(isWhole(term) ? WeightedSpec{1, std::string(term)} : parseTerm(term));
        if (end == spec.size()) break;
        start = end + 1;
    }
    if (terms.size() > 1)
        for (const WeightedSpec& term : terms)
            if (term.spec.empty())
                throw UsageError(
                    fmt::format("sum: '{}' has an empty term; valid: {}", spec, sumHelp));
    return terms;
}

Sum::Sum(std::vector<Term> terms)
    : terms_(ofOneSide(std::move(terms))),
      name_(joinedNames(terms_)),
      channels_(mergedChannels(terms_)),
      laws_(commonLaws(terms_)) {}

void Sum::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = channels_.count();
    std::fill(out, out + channels * wi.count, 0.0);
    std::vector<double> values(channels * wi.count);
    for (const Term& term : terms_) {
        term.brdf->eval(wo, wi, values.data());
        const bool grey = term.brdf->channels().kind == Channels::Kind::grey;
        for (std::size_t c = 0; c < channels; ++c) {
            const double* own = values.data() + (grey ? 0 : c * wi.count);
            for (std::size_t k = 0; k < wi.count; ++k)
                out[c * wi.count + k] += term.weight * own[k];
        }
    }
    constexpr double most = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < channels * wi.count; ++i) out[i] = std::min(out[i], most);
}

void Sum::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    terms_.front().brdf->coverage(wo, wi, covered);
    std::vector<unsigned char> own(wi.count);
    for (std::size_t t = 1; t < terms_.size(); ++t) {
        terms_[t].brdf->coverage(wo, wi, own.data());
        for (std::size_t k = 0; k < wi.count; ++k) covered[k] = covered[k] && own[k];
    }
}

std::vector<Lobe> Sum::lobes(const Direction& wo) const {
    std::vector<Lobe> all;
    for (const Term& term : terms_)
        for (const Lobe& lobe : term.brdf->lobes(wo)) all.push_back(lobe);
    return all;
}

std::vector<Lobe> Sum::outgoingLobes(const Direction& wi) const {
    std::vector<Lobe> all;
    for (const Term& term : terms_)
        for (const Lobe& lobe : outgoingLobesOf(*term.brdf, wi)) all.push_back(lobe);
    return all;
}

std::vector<double> Sum::kinks(const Direction& wo) const {
    std::vector<double> all;
    for (const Term& term : terms_)
        for (const double height : term.brdf->kinks(wo)) all.push_back(height);
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

std::vector<double> Sum::outgoingKinks(const Direction& wi) const {
    std::vector<double> all;
    for (const Term& term : terms_)
        for (const double height : outgoingKinksOf(*term.brdf, wi)) all.push_back(height);
    return all;
}

std::vector<KinkCurve> Sum::outgoingKinkCurves(const Direction& wi) const {
    std::vector<KinkCurve> all;
    for (const Term& term : terms_)
        for (const KinkCurve& curve : outgoingKinkCurvesOf(*term.brdf, wi)) all.push_back(curve);
    return all;
}

int Sum::squareLevels() const {
    int most = 0;
    for (const Term& term : terms_) most = std::max(most, squareLevelsOf(*term.brdf));
    return most;
}

HasSamplers::Known Sum::samplers() const {
    Known all{.all = true, .samplers = {}};
    for (const Term& term : terms_) {
        if (term.weight == 0) continue;
        const auto* own = dynamic_cast<const HasSamplers*>(term.brdf.get());
        const Known known = own ? own->samplers() : Known{};
        all.all = all.all && known.all;
        all.samplers.insert(all.samplers.end(), known.samplers.begin(), known.samplers.end());
    }
    // Every part costs a density a sample.
    constexpr std::size_t most = 8;
    return all.samplers.size() <= most ? all : Known{};
}

std::vector<KinkCurve> Sum::kinkCurves(const Direction& wo) const {
    std::vector<KinkCurve> all;
    for (const Term& term : terms_)
        for (const KinkCurve& curve : kinkCurvesOf(*term.brdf, wo)) all.push_back(curve);
    return all;
}

double Sum::defaultTolerance() const {
    double largest = 0;
    for (const Term& term : terms_) largest = std::max(largest, term.brdf->defaultTolerance());
    return largest;
}

/// Each fact of a term under its number: "term_2_model".
std::vector<Fact> Sum::facts() const {
    std::vector<Fact> all{{"terms", static_cast<std::int64_t>(terms_.size())}};
    for (std::size_t t = 0; t < terms_.size(); ++t) {
        const std::string number = fmt::format("term_{}", t + 1);
        all.push_back({number, terms_[t].brdf->name()});
        all.push_back({number + "_weight", terms_[t].weight});
        for (const auto& [name, value] : terms_[t].brdf->facts())
            all.push_back({number + "_" + name, value});
    }
    return all;
}

void Sum::checkIntact() const {
    for (const Term& term : terms_) term.brdf->checkIntact();
}

}  // namespace hshfit::brdfs
