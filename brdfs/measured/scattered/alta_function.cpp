#include <brdfs/measured/scattered/alta.h>
#include <brdfs/measured/scattered/alta_function_parts.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hshfit::brdfs {
namespace {

/// A function times the Fresnel factor that follows it.
struct Product {
    std::unique_ptr<AltaPart> function, fresnel;
};

Laws lawsOf(const std::vector<Product>& products) {
    Laws laws{.nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};
    for (const Product& product : products)
        if (const AltaCoordinates* input = product.function->coordinates()) {
            laws.reciprocal &= input->reciprocal;
            laws.isotropic &= input->isotropic;
            laws.mirrorSymmetric &= input->mirrorSymmetric;
        }
    return laws;
}

/// A sum of products; 0 where rational functions make it negative.
class AltaFunction : public Brdf {
public:
    AltaFunction(std::vector<Product> products, std::size_t channels, std::string input,
                 std::string name)
        : products_(std::move(products)),
          input_(std::move(input)),
          name_(std::move(name)),
          channels_(channels == 1 ? Channels::grey() : Channels::rgb()),
          laws_(lawsOf(products_)) {
        width_ = halfwayWidth();
    }

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }

    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        const std::size_t channels = channels_.count();
        for (std::size_t k = 0; k < wi.count; ++k) {
            double f[3] = {};
            const Direction in{wi.x[k], wi.y[k], wi.z[k]};
            if (in.z > 0 && wo.z > 0) add(in, wo, f);
            for (std::size_t c = 0; c < channels; ++c) out[c * wi.count + k] = std::max(f[c], 0.0);
        }
    }

    void coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const override {
        for (std::size_t k = 0; k < wi.count; ++k) {
            const Direction in{wi.x[k], wi.y[k], wi.z[k]};
            covered[k] =
                in.z > 0 && wo.z > 0 && std::ranges::all_of(products_, [&](const Product& product) {
                    return product.function->covers(in, wo);
                });
        }
    }

    std::vector<Lobe> lobes(const Direction& wo) const override {
        std::vector<Lobe> lobes;
        if (width_ > 0)
            lobes.push_back({.about = Lobe::About::halfway, .width = width_, .axis = {}});
        for (const Product& product : products_)
            if (const double width = product.function->mirrorWidth(); width > 0)
                lobes.push_back({.about = Lobe::About::axis, .width = width, .axis = mirrored(wo)});
        return lobes;
    }

    std::vector<Fact> facts() const override {
        std::vector<Fact> facts{{"format", "alta"},
                                {"functions", static_cast<std::int64_t>(products_.size())}};
        if (!input_.empty()) facts.emplace_back("parametrisation", input_);
        return facts;
    }

private:
    void add(const Direction& wi, const Direction& wo, double* f) const {
        constexpr double most = std::numeric_limits<double>::max() / 64;
        for (const Product& product : products_) {
            double own[3] = {}, factor[3] = {1, 1, 1};
            product.function->eval(wi, wo, own);
            if (product.fresnel) product.fresnel->eval(wi, wo, factor);
            for (std::size_t c = 0; c < channels_.count(); ++c)
                f[c] = std::clamp(f[c] + std::clamp(own[c], -most, most) * factor[c], -most, most);
        }
    }

    /// From the slope of the half vector at which f falls to half of its value at the normal: cos^N
    /// is nearly a Gaussian of the slope, which falls to half at 1.18 standard deviations of 2.5.
    /// 0 for a lobe as wide as a cosine's.
    double halfwayWidth() const {
        constexpr double finest = 1e-4, widest = 1;
        double peak[3] = {};
        add({0, 0, 1}, {0, 0, 1}, peak);
        for (double slope = finest; slope < widest; slope *= 1.05) {
            const Direction h = directionFromAngles(std::atan(slope), 0);
            double f[3] = {};
            add(h, h, f);
            for (std::size_t c = 0; c < channels_.count(); ++c)
                if (peak[c] > 0 && f[c] < 0.5 * peak[c]) return 2.5 / 1.18 * slope;
        }
        return 0;
    }

    std::vector<Product> products_;
    std::string input_, name_;
    Channels channels_;
    Laws laws_;
    double width_ = 0;
};

/// Reads the blocks that begin with #FUNC. Lines are taken one ahead of those that they end at.
class FunctionReader {
public:
    FunctionReader(std::string_view text, const std::string& where, std::string_view input)
        : reader_(text, where), where_(where), stated_(input) {}

    std::unique_ptr<Brdf> read() {
        bool more = nextLine();
        while (more) {
            const std::string_view key = atFunction_ ? "#FUNC" : reader_.takeWord();
            atFunction_ = false;
            if (key == "#FUNC") {
                if (channels_ == 0) throw reader_.error("#FUNC, but no #DIM before it");
                more = readFunction(reader_.takeWord());
                continue;
            }
            if (!key.starts_with('#'))
                throw reader_.error(fmt::format("'{}' belongs to no #FUNC", key.substr(0, 40)));
            readHeader(key);
            more = nextLine();
        }
        if (products_.empty()) throw reader_.error("the file has no #FUNC");
        return std::make_unique<AltaFunction>(std::move(products_), channels_, used_, where_);
    }

private:
    bool nextLine() {
        while (reader_.next())
            if (!reader_.blank()) return true;
        return false;
    }

    void readHeader(std::string_view key) {
        if (key == "#DIM") {
            double in = 0, out = 0;
            if (!reader_.takeNumber(in) || !reader_.takeNumber(out) || (out != 1 && out != 3))
                throw reader_.error("#DIM has to end in 1 (grey) or 3 (R, G, B)");
            if (!products_.empty() && static_cast<std::size_t>(out) != channels_)
                throw reader_.error("#DIM changes the number of channels after a #FUNC");
            dimension_ = in;
            channels_ = static_cast<std::size_t>(out);
        } else if (key == "#PARAM_IN") {
            parameters_ = reader_.takeWord();
        } else if (key == "#CMD") {
            const std::string_view line = reader_.line();
            constexpr std::string_view option = "--sg-type";
            if (const std::size_t at = line.find(option); at != line.npos) {
                std::string_view rest = line.substr(at + option.size());
                rest.remove_prefix(std::min(rest.find_first_not_of(" \t="), rest.size()));
                gaussian_ = rest.substr(0, rest.find_first_of(" \t\r"));
            }
        }
    }

    /// True if a line follows that is not of this function.
    bool readFunction(std::string_view name) {
        const auto column = [&](std::size_t i) {
            std::vector<double> values;
            for (std::size_t c = 0; c < channels_; ++c) values.push_back(numbers_[c][i]);
            return values;
        };
        if (name == "rational_function") return readRational();
        if (name == "nonlinear_function_diffuse") {
            readNumbers({"kd"});
            products_.push_back({altaDiffuse(column(0)), nullptr});
        } else if (name == "nonlinear_function_blinn") {
            readNumbers({"Ks", "N"});
            products_.push_back({altaBlinn(column(0), column(1)), nullptr});
        } else if (name == "nonlinear_function_abc") {
            const AltaCoordinates& input = readParameter();
            readNumbers({"a", "b", "c"});
            products_.push_back({altaAbc(input, column(0), column(1), column(2)), nullptr});
        } else if (name == "nonlinear_function_spherical_gaussian") {
            const AltaCoordinates& input = gaussianInput();
            readNumbers({"Ks", "N"});
            products_.push_back({altaGaussian(input, column(0), column(1)), nullptr});
        } else if (name == "nonlinear_fresnel_schlick") {
            if (products_.empty() || products_.back().fresnel)
                throw reader_.error("a Fresnel factor follows the one function that it multiplies");
            readNumbers({"R"});
            for (const auto& own : numbers_)
                if (own[0] > 1)
                    throw reader_.error(fmt::format("R is {}, expected from 0 to 1", own[0]));
            products_.back().fresnel = altaSchlick(column(0));
        } else {
            throw reader_.error(
                fmt::format("the function '{}' is not read; readable are rational_function, "
                            "nonlinear_function_ diffuse, blinn, abc and spherical_gaussian, and "
                            "nonlinear_fresnel_schlick",
                            name.substr(0, 60)));
        }
        return nextLine();
    }

    /// Lines of a key and a value, for each channel all keys.
    void readNumbers(std::initializer_list<std::string_view> keys) {
        numbers_.assign(channels_, {});
        constexpr double most = 1e6;
        for (auto& own : numbers_)
            for (const std::string_view key : keys) {
                double value = 0;
                if (!nextLine()) throw reader_.error(fmt::format("the file ends before {}", key));
                if (reader_.takeWord() != key || !reader_.takeNumber(value))
                    throw reader_.error(fmt::format("expected {} and its value", key));
                if (!(value >= 0 && value <= most))
                    throw reader_.error(
                        fmt::format("{} is {}, expected from 0 to {}", key, value, most));
                own.push_back(value);
            }
    }

    /// #PARAM and a cosine.
    const AltaCoordinates& readParameter() {
        if (!nextLine() || reader_.takeWord() != "#PARAM") throw reader_.error("expected #PARAM");
        const std::string_view name = reader_.takeWord();
        const AltaCoordinates* input = altaCoordinates(name);
        if (!input || input->count != 1)
            throw reader_.error(
                fmt::format("#PARAM {} is no cosine that is read: COS_TH, COS_TK, "
                            "COS_TLV or COS_TLR",
                            name.substr(0, 40)));
        return *input;
    }

    const AltaCoordinates& gaussianInput() const {
        if (gaussian_ == "half") return *altaCoordinates("COS_TH");
        if (gaussian_ == "mirror") return *altaCoordinates("COS_TLR");
        if (gaussian_ == "back") return *altaCoordinates("COS_TK");
        throw reader_.error(
            fmt::format("a spherical Gaussian is about the half, the mirror or the back vector, by "
                        "--sg-type of "
                        "#CMD, which is '{}' here",
                        gaussian_.substr(0, 40)));
    }

    const AltaCoordinates& rationalInput() {
        const std::string_view name = stated_.empty() ? parameters_ : stated_;
        const AltaCoordinates* input = altaCoordinates(name);
        if (!input)
            throw reader_.error(fmt::format(
                "#PARAM_IN {} does not say of what the function is one; state it with the option "
                "input, as in {}:input=COS_TH; known are {}",
                name.empty() ? "is missing, which" : name.substr(0, 40), where_,
                altaCoordinateNames()));
        if (static_cast<double>(input->count) != dimension_)
            throw reader_.error(fmt::format("#DIM gives {} coordinates, but {} has {}", dimension_,
                                            input->name, input->count));
        used_ = input->name;
        return *input;
    }

    std::vector<double> readRange(std::size_t count, std::string_view key) {
        std::vector<double> values;
        for (double value; reader_.takeNumber(value);) values.push_back(value);
        if (values.size() != count ||
            !std::ranges::all_of(values, [](double v) { return std::abs(v) <= 1e9; }))
            throw reader_.error(fmt::format(
                "{} has to have {} finite numbers, one of each coordinate", key, count));
        return values;
    }

    std::size_t readCount(std::string_view key) {
        double value = 0;
        if (!reader_.takeNumber(value) || !(value >= 1 && value <= 1e6) ||
            value != std::floor(value))
            throw reader_.error(fmt::format("{} has to be a whole number from 1 to 1e6", key));
        return static_cast<std::size_t>(value);
    }

    AltaTerm readTerm(std::size_t count) {
        std::vector<double> row;
        reader_.takeNumbers(row);
        if (row.size() != count + 1)
            throw reader_.error(fmt::format("{} numbers, expected {} degrees and a coefficient",
                                            row.size(), count));
        AltaTerm term;
        constexpr double highest = 100;
        for (std::size_t k = 0; k < count; ++k) {
            if (!(row[k] >= 0 && row[k] <= highest) || row[k] != std::floor(row[k]))
                throw reader_.error(
                    fmt::format("degree {} is {}, expected a whole number from 0 to {}", k + 1,
                                row[k], highest));
            term.degrees.push_back(static_cast<int>(row[k]));
        }
        if (!std::isfinite(row.back()) || std::abs(row.back()) > 1e150)
            throw reader_.error(
                fmt::format("the coefficient is {}, expected at most 1e150", row.back()));
        term.coefficient = row.back();
        return term;
    }

    /// #MIN, #MAX, #NP, #NQ and #BASIS in any order, then terms; #NP and #NQ may stand again before
    /// the terms of each channel.
    bool readRational() {
        const AltaCoordinates& input = rationalInput();
        std::vector<double> min, max;
        std::size_t np = 0, nq = 0;
        bool legendre = false, more = true;
        std::vector<AltaQuotient> channels(1);
        while ((more = nextLine())) {
            if (!reader_.line().starts_with('#')) {
                if (min.empty() || max.empty() || np == 0 || nq == 0)
                    throw reader_.error("coefficients, but no #MIN, #MAX, #NP and #NQ before them");
                AltaQuotient* last = &channels.back();
                if (last->denominator.size() == nq) {
                    if (channels.size() == channels_)
                        throw reader_.error(
                            fmt::format("more coefficients than those of {} channels", channels_));
                    last = &channels.emplace_back();
                }
                (last->numerator.size() < np ? last->numerator : last->denominator)
                    .push_back(readTerm(input.count));
                continue;
            }
            const std::string_view key = reader_.takeWord();
            if (key == "#FUNC") {
                atFunction_ = true;
                break;
            }
            if (key == "#MIN") {
                min = readRange(input.count, key);
            } else if (key == "#MAX") {
                max = readRange(input.count, key);
            } else if (key == "#NP" || key == "#NQ") {
                const AltaQuotient& last = channels.back();
                if (!last.numerator.empty() && last.denominator.size() < nq)
                    throw reader_.error(fmt::format("{} among the coefficients", key));
                (key == "#NP" ? np : nq) = readCount(key);
                if (!last.numerator.empty() && channels.size() < channels_) channels.emplace_back();
            } else if (key == "#BASIS") {
                const std::string_view basis = reader_.takeWord();
                if (basis != "LEGENDRE")
                    throw reader_.error(
                        fmt::format("#BASIS is '{}', expected LEGENDRE", basis.substr(0, 40)));
                legendre = true;
            }
        }
        const AltaQuotient& last = channels.back();
        if (channels.size() != channels_ || np == 0 || nq == 0 || last.denominator.size() != nq)
            throw reader_.error("the function ends before its last coefficient");
        for (std::size_t k = 0; k < input.count; ++k) {
            // ALTA widens the range of a coordinate that has one value.
            if (min[k] == max[k]) min[k] -= 0.1, max[k] += 0.1;
            if (!(min[k] < max[k]))
                throw reader_.error(fmt::format("#MIN {} is above #MAX {}", min[k], max[k]));
        }
        for (const AltaQuotient& quotient : channels)
            if (std::ranges::all_of(quotient.denominator,
                                    [](const AltaTerm& t) { return t.coefficient == 0; }))
                throw reader_.error("a denominator is 0");
        products_.push_back(
            {altaRational(input, min, max, legendre, std::move(channels)), nullptr});
        return more;
    }

    TextReader reader_;
    const std::string& where_;
    std::string_view stated_, parameters_, gaussian_;
    double dimension_ = 0;
    std::size_t channels_ = 0;
    bool atFunction_ = false;  ///< #FUNC of the line has been taken
    std::string used_;
    std::vector<std::vector<double>> numbers_;
    std::vector<Product> products_;
};

}  // namespace

std::unique_ptr<Brdf> readAltaFunction(std::string_view text, const std::string& where,
                                       std::string_view input) {
    return FunctionReader(text, where, input).read();
}

}  // namespace hshfit::brdfs
