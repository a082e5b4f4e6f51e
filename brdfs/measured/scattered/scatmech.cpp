#include <brdfs/measured/scattered/scatmech.h>
#include <brdfs/measured/scattered/scatmech_mueller.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace hshfit::brdfs {
namespace {

/// The limit keeps radial polynomials exact to rounding; published tables end at 8.
constexpr int mostOrder = 40;
constexpr int mostPower = 8;

double normalisation(const ZernikeExpansion::Term& t) {
    const bool same = t.n == t.m, round = t.l == 0;
    const double divisor = t.n == 0 || (same && round) ? 4 : (same || round ? 2 : 1);
    return std::sqrt((t.n + 1.0) * (t.m + 1.0) / divisor) / (2 * pi);
}

/// Whole numbers in the first columns of a line: i, j, n, m, k, l, p.
std::array<int, 7> indicesOf(const std::vector<double>& row, const TextReader& reader) {
    constexpr std::array<std::string_view, 7> names = {"i", "j", "n", "m", "k", "l", "p"};
    constexpr std::array<int, 7> least = {1, 1, 0, 0, -mostOrder, -mostOrder, 0};
    constexpr std::array<int, 7> most = {4,         4,         mostOrder, mostOrder,
                                         mostOrder, mostOrder, mostPower};
    std::array<int, 7> indices{};
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (!(row[k] >= least[k] && row[k] <= most[k]) || row[k] != std::floor(row[k])) {
            throw reader.error(fmt::format("{} is {}, expected a whole number from {} to {}",
                                           names[k], row[k], least[k], most[k]));
        }
        indices[k] = static_cast<int>(row[k]);
    }
    return indices;
}

ZernikeExpansion::Term termOf(const std::array<int, 7>& at, double a, const TextReader& reader) {
    const auto [i, j, n, m, k, l, p] = at;
    if (k != l || l < 0 || l > std::min(n, m) || (n - l) % 2 != 0 || (m - l) % 2 != 0) {
        throw reader.error(
            fmt::format("n, m, k, l are {}, {}, {}, {}; element 11 needs k = l from "
                        "0 to both n and m, and n - l and m - l even",
                        n, m, k, l));
    }
    return {n, m, l, p, a};
}

/// A row i <= j of another element than 11.
ZernikeMueller::Row muellerRow(const std::array<int, 7>& at, double a, const TextReader& reader) {
    const auto [i, j, n, m, k, l, p] = at;
    if (i > j || std::abs(k) > n || std::abs(l) > m || (n - k) % 2 != 0 || (m - l) % 2 != 0) {
        throw reader.error(fmt::format(
            "i, j, n, m, k, l are {}, {}, {}, {}, {}, {}; expected i <= j, |k| up to n, "
            "|l| up to m, and n - k and m - l even",
            i, j, n, m, k, l));
    }
    return {i - 1, j - 1, {n, m}, {k, l}, p, a};
}

bool looksLikeScatmech(std::span<const unsigned char> head, std::uint64_t fileSize) {
    const std::string_view text = asText(head);
    TextReader reader(text, "");
    std::vector<double> row;
    try {
        int rows = 0;
        while (rows < 3 && reader.next()) {
            // The last line of the head may be incomplete.
            const auto end = static_cast<std::size_t>(reader.line().end() - text.begin());
            if (end == text.size() && fileSize > text.size()) break;
            if (reader.blank()) continue;
            reader.takeNumbers(row, ',');
            if (row.size() != 8) return false;
            indicesOf(row, reader);
            ++rows;
        }
        return rows > 0;
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace

/// By Kintner's three-term recurrence in n (Optica Acta 23, 1976).
double zernikeRadial(int n, int l, double r) {
    double last = std::pow(r, l);
    if (n == l) return last;
    double now = ((l + 2) * r * r - (l + 1)) * last;
    for (int k = l + 4; k <= n; k += 2) {
        const double k1 = 0.5 * (k + l) * (k - l) * (k - 2), k2 = 2.0 * k * (k - 1) * (k - 2);
        const double k3 =
            -static_cast<double>(l) * l * (k - 1) - static_cast<double>(k) * (k - 1) * (k - 2);
        const double k4 = -0.5 * k * (k + l - 2) * (k - l - 2);
        const double next = ((k2 * r * r + k3) * now + k4 * last) / k1;
        last = now;
        now = next;
    }
    return now;
}

ZernikeExpansion::ZernikeExpansion(const std::vector<Term>& terms, std::vector<double> wavelengths,
                                   std::string name, std::size_t otherTerms)
    : name_(std::move(name)), terms_(terms.size()), otherTerms_(otherTerms) {
    laws_.nonNegative = laws_.reciprocal = laws_.isotropic = laws_.mirrorSymmetric = true;
    channels_ = wavelengths.empty() ? Channels::grey() : Channels::spectral(wavelengths);
    std::map<std::array<int, 3>, std::vector<double>> weights;
    for (const Term& t : terms) {
        for (const auto& key : {std::array{t.n, t.m, t.l}, std::array{t.m, t.n, t.l}}) {
            std::vector<double>& sum = weights[key];
            sum.resize(channels_.count(), 0.0);
            for (std::size_t c = 0; c < sum.size(); ++c) {
                const double um = wavelengths.empty() ? 1 : wavelengths[c] / 1000;
                sum[c] += t.a * normalisation(t) * std::pow(um, t.p);
            }
        }
    }
    const auto indexOf = [&](int n, int l) {
        const auto index = std::ranges::find(radials_, std::pair(n, l)) - radials_.begin();
        if (index == std::ssize(radials_)) radials_.emplace_back(n, l);
        return static_cast<int>(index);
    };
    for (auto& [key, sum] : weights) {
        const auto [n, m, l] = key;
        highest_ = std::max(highest_, l);
        const int first = indexOf(n, l), second = indexOf(m, l);
        products_.push_back({first, second, l, std::move(sum)});
    }
}

void ZernikeExpansion::radials(const Direction& d, double* out) const {
    const double r = std::sqrt(oneMinusZ(d));  // 2 sin^2(theta/2) = 1 - cos(theta)
    for (std::size_t k = 0; k < radials_.size(); ++k) {
        out[k] = zernikeRadial(radials_[k].first, radials_[k].second, r);
    }
}

void ZernikeExpansion::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = channels_.count();
    std::fill_n(out, channels * wi.count, 0.0);
    if (!(wo.z > 0)) return;
    const std::size_t size = radials_.size();
    std::vector<double> there(size), here(size), folded(size * channels, 0.0);
    std::vector<double> cosines(static_cast<std::size_t>(highest_) + 1);
    radials(wo, there.data());
    for (const Product& product : products_) {
        for (std::size_t c = 0; c < channels; ++c) {
            folded[static_cast<std::size_t>(product.radial) * channels + c] +=
                product.weights[c] * there[static_cast<std::size_t>(product.other)];
        }
    }
    const double outer = azimuth(wo);
    for (std::size_t k = 0; k < wi.count; ++k) {
        if (!(wi.z[k] > 0)) continue;
        const Direction d{wi.x[k], wi.y[k], wi.z[k]};
        radials(d, here.data());
        const double turn = outer - azimuth(d);
        for (std::size_t l = 0; l < cosines.size(); ++l) {
            cosines[l] = std::cos(static_cast<double>(l) * turn);
        }
        for (std::size_t r = 0; r < size; ++r) {
            const double part = here[r] * cosines[static_cast<std::size_t>(radials_[r].second)];
            for (std::size_t c = 0; c < channels; ++c) {
                out[c * wi.count + k] += part * folded[r * channels + c];
            }
        }
        for (std::size_t c = 0; c < channels; ++c) {
            out[c * wi.count + k] = std::max(0.0, out[c * wi.count + k]);
        }
    }
}

std::vector<Fact> ZernikeExpansion::facts() const {
    std::vector<Fact> facts{{"format", "scatmech"}, {"terms", static_cast<std::int64_t>(terms_)}};
    if (otherTerms_ > 0) {
        facts.push_back(muellerFact(MuellerElements()));
        facts.emplace_back("not_read",
                           fmt::format("{} terms of Mueller elements other than 11", otherTerms_));
    }
    return facts;
}

std::unique_ptr<Brdf> readScatmech(std::string_view text, const std::string& where,
                                   std::string name, const ScatmechOptions& options) {
    TextReader reader(text, where);
    std::vector<ZernikeExpansion::Term> terms;
    std::vector<ZernikeMueller::Row> rows;
    std::vector<double> row;
    std::size_t others = 0;
    bool coloured = false;
    while (reader.next()) {
        if (reader.blank()) continue;
        reader.takeNumbers(row, ',');
        if (row.size() != 8) {
            throw reader.error(
                fmt::format("{} numbers, expected the 8 of i, j, n, m, k, l, p, a", row.size()));
        }
        const std::array<int, 7> at = indicesOf(row, reader);
        if (!(std::fabs(row[7]) <= 1e6)) {
            throw reader.error(fmt::format("a is {}, expected a number within 1e6", row[7]));
        }
        if (at[0] == 1 && at[1] == 1) {
            terms.push_back(termOf(at, options.scale * row[7], reader));
        } else if (options.elements.isReflectance()) {
            ++others;
            continue;
        } else {
            rows.push_back(muellerRow(at, row[7], reader));
        }
        coloured = coloured || at[6] > 0;
    }
    if (terms.empty()) throw reader.error("the file has no row of Mueller element 11");
    std::vector<double> wavelengths;
    if (options.wavelength > 0) {
        wavelengths = {options.wavelength};
    } else if (coloured) {
        wavelengths = {351, 532, 633, 1064};
    }
    ZernikeExpansion reflectance(terms, wavelengths, name, others);
    if (options.elements.isReflectance())
        return std::make_unique<ZernikeExpansion>(std::move(reflectance));
    return std::make_unique<ZernikeMueller>(std::move(reflectance), rows, options.elements,
                                            std::move(name));
}

const Format& scatmechFormat() {
    static const Format format{
        .name = "scatmech",
        .help = "Zernike expansion, SCATMECH coefficient table (CSV), isotropic, spectral",
        .extension = ".csv",
        .recognises = looksLikeScatmech,
        .parameters = {{.name = "wavelength",
                        .help = "nm; left out: 351, 532, 633 and 1064, or grey where the table "
                                "does not depend on it",
                        .kind = Parameter::Kind::number,
                        .fallback = 0,
                        .min = 100,
                        .max = 20000},
                       {.name = "scale",
                        .help = "factor, the reflectance of the sample where the table stands for "
                                "unit reflectance",
                        .kind = Parameter::Kind::number,
                        .fallback = 1,
                        .min = 0,
                        .max = 1000},
                       muellerParameter()},
        .open = [](const std::string& path, const Parameters& parameters) -> std::unique_ptr<Brdf> {
            const std::string options = parameters.canonical();
            std::unique_ptr<Brdf> brdf;
            withTextFile(path, [&](std::string_view text, const std::string& where) {
                brdf = readScatmech(text, where, options.empty() ? path : path + ":" + options,
                                    {.wavelength = parameters.number("wavelength"),
                                     .scale = parameters.number("scale"),
                                     .elements = muellerElements(parameters)});
            });
            return brdf;
        },
    };
    return format;
}

}  // namespace hshfit::brdfs
