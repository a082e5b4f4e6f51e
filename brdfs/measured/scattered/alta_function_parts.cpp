#include <brdfs/measured/scattered/alta_function_parts.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hshfit::brdfs {
namespace {

using Numbers = std::vector<double>;
constexpr std::size_t mostCoordinates = 6;

double oneCoordinate(const AltaCoordinates& input, const Direction& wi, const Direction& wo) {
    double x = 0;
    input.coordinates(wi, wo, &x);
    return std::clamp(x, -1.0, 1.0);
}

/// The width of a lobe whose sharpest channel is exp(-n (1 - cos)) near its peak.
double mirrorWidthOf(const AltaCoordinates& input, double n) {
    return input.name == "COS_TLR" && n > 2 ? 2.5 / std::sqrt(n) : 0;
}

class Diffuse final : public AltaPart {
public:
    explicit Diffuse(Numbers kd) : kd_(std::move(kd)) {}
    void eval(const Direction&, const Direction&, double* values) const override {
        std::ranges::copy(kd_, values);
    }

private:
    Numbers kd_;
};

class Blinn final : public AltaPart {
public:
    Blinn(Numbers ks, Numbers n) : ks_(std::move(ks)), n_(std::move(n)) {}
    void eval(const Direction& wi, const Direction& wo, double* values) const override {
        const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
        const double cosine = z / std::sqrt(x * x + y * y + z * z);
        for (std::size_t c = 0; c < ks_.size(); ++c) values[c] = ks_[c] * std::pow(cosine, n_[c]);
    }

private:
    Numbers ks_, n_;
};

class Abc final : public AltaPart {
public:
    Abc(const AltaCoordinates& input, Numbers a, Numbers b, Numbers c)
        : input_(input), a_(std::move(a)), b_(std::move(b)), c_(std::move(c)) {}
    const AltaCoordinates* coordinates() const override { return &input_; }
    void eval(const Direction& wi, const Direction& wo, double* values) const override {
        const double x = oneCoordinate(input_, wi, wo);
        for (std::size_t i = 0; i < a_.size(); ++i)
            values[i] = x >= 0 ? a_[i] * std::pow(1 + b_[i] * (1 - x), -c_[i]) : 0;
    }
    double mirrorWidth() const override {
        double sharpest = 0;
        for (std::size_t i = 0; i < b_.size(); ++i) sharpest = std::max(sharpest, b_[i] * c_[i]);
        return mirrorWidthOf(input_, sharpest);
    }

private:
    const AltaCoordinates& input_;
    Numbers a_, b_, c_;
};

class Gaussian final : public AltaPart {
public:
    Gaussian(const AltaCoordinates& input, Numbers ks, Numbers n)
        : input_(input), ks_(std::move(ks)), n_(std::move(n)) {}
    const AltaCoordinates* coordinates() const override { return &input_; }
    void eval(const Direction& wi, const Direction& wo, double* values) const override {
        const double x = oneCoordinate(input_, wi, wo);
        for (std::size_t i = 0; i < ks_.size(); ++i) values[i] = ks_[i] * std::exp(n_[i] * (x - 1));
    }
    double mirrorWidth() const override {
        return mirrorWidthOf(input_, *std::ranges::max_element(n_));
    }

private:
    const AltaCoordinates& input_;
    Numbers ks_, n_;
};

class Schlick final : public AltaPart {
public:
    explicit Schlick(Numbers r) : r_(std::move(r)) {}
    void eval(const Direction& wi, const Direction& wo, double* values) const override {
        const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
        const double cosine = std::min(1.0, 0.5 * std::sqrt(x * x + y * y + z * z));
        const double rise = std::pow(1 - cosine, 5);
        for (std::size_t c = 0; c < r_.size(); ++c) values[c] = r_[c] + (1 - r_[c]) * rise;
    }

private:
    Numbers r_;
};

/// Powers or Legendre polynomials of all degrees up to the highest, of each coordinate.
class Rational final : public AltaPart {
public:
    Rational(const AltaCoordinates& input, Numbers min, Numbers max, bool legendre,
             std::vector<AltaQuotient> channels)
        : input_(input),
          min_(std::move(min)),
          max_(std::move(max)),
          legendre_(legendre),
          channels_(std::move(channels)) {
        for (const AltaQuotient& quotient : channels_)
            for (const auto* terms : {&quotient.numerator, &quotient.denominator})
                for (const AltaTerm& term : *terms)
                    for (const int degree : term.degrees) highest_ = std::max(highest_, degree);
    }
    const AltaCoordinates* coordinates() const override { return &input_; }

    bool covers(const Direction& wi, const Direction& wo) const override {
        std::array<double, mostCoordinates> x{};
        input_.coordinates(wi, wo, x.data());
        constexpr double rounding = 1e-9;
        for (std::size_t k = 0; k < input_.count; ++k) {
            const double slack = rounding * (max_[k] - min_[k]);
            if (x[k] < min_[k] - slack || x[k] > max_[k] + slack) return false;
        }
        return true;
    }

    void eval(const Direction& wi, const Direction& wo, double* values) const override {
        std::array<double, mostCoordinates> x{};
        input_.coordinates(wi, wo, x.data());
        const std::size_t stride = static_cast<std::size_t>(highest_) + 1;
        Numbers basis(input_.count * stride, 1.0);
        for (std::size_t k = 0; k < input_.count; ++k) {
            const double u = 2 * ((x[k] - min_[k]) / (max_[k] - min_[k])) - 1;
            double* own = basis.data() + k * stride;
            for (int n = 1; n <= highest_; ++n)
                own[n] = legendre_ && n > 1
                             ? ((2 * n - 1) * u * own[n - 1] - (n - 1) * own[n - 2]) / n
                             : u * own[n - 1];
        }
        const auto sum = [&](const std::vector<AltaTerm>& terms) {
            double total = 0;
            for (const AltaTerm& term : terms) {
                double product = term.coefficient;
                for (std::size_t k = 0; k < term.degrees.size(); ++k)
                    product *= basis[k * stride + static_cast<std::size_t>(term.degrees[k])];
                total += product;
            }
            return total;
        };
        constexpr double most = std::numeric_limits<double>::max();
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            const double p = sum(channels_[c].numerator), q = sum(channels_[c].denominator);
            const double value = p == 0 ? 0 : p / q;
            values[c] = std::isnan(value) ? 0 : std::clamp(value, -most, most);
        }
    }

private:
    const AltaCoordinates& input_;
    Numbers min_, max_;
    bool legendre_;
    std::vector<AltaQuotient> channels_;
    int highest_ = 0;
};

}  // namespace

std::unique_ptr<AltaPart> altaDiffuse(Numbers kd) {
    return std::make_unique<Diffuse>(std::move(kd));
}
std::unique_ptr<AltaPart> altaBlinn(Numbers ks, Numbers n) {
    return std::make_unique<Blinn>(std::move(ks), std::move(n));
}
std::unique_ptr<AltaPart> altaAbc(const AltaCoordinates& input, Numbers a, Numbers b, Numbers c) {
    return std::make_unique<Abc>(input, std::move(a), std::move(b), std::move(c));
}
std::unique_ptr<AltaPart> altaGaussian(const AltaCoordinates& input, Numbers ks, Numbers n) {
    return std::make_unique<Gaussian>(input, std::move(ks), std::move(n));
}
std::unique_ptr<AltaPart> altaSchlick(Numbers r) {
    return std::make_unique<Schlick>(std::move(r));
}
std::unique_ptr<AltaPart> altaRational(const AltaCoordinates& input, Numbers min, Numbers max,
                                       bool legendre, std::vector<AltaQuotient> channels) {
    return std::make_unique<Rational>(input, std::move(min), std::move(max), legendre,
                                      std::move(channels));
}

}  // namespace hshfit::brdfs
