#include <brdfs/fit/lobe_formula.h>

#include <brdfs/fit/lobes.h>

#include <ceres/jet.h>

#include <algorithm>
#include <optional>

namespace hshfit::brdfs {
namespace {

/// Which linear parameters there are: kd, and that of the lobe.
struct Places {
    std::optional<std::size_t> diffuse, lobe;
    std::size_t count = 0;
};

/// `Lobe<T>(const T* shapes, words)` and `T operator()(PairGeometry, T& base)`: what the linear
/// parameter multiplies, and what stands without one.
template <template <class> class Lobe, int n>
class Formula final : public LobeFormula {
public:
    Formula(const Places& places, const LobeWords& words) : places_(places), words_(words) {}

    void fill(const FitSamples& samples, std::size_t begin, std::size_t size,
              std::span<const double> shapes, double* base, double* linear,
              double* slopes) const override {
        std::fill_n(linear, places_.count * size, 0.0);
        if (places_.diffuse) std::fill_n(linear + *places_.diffuse * size, size, 1 / pi);
        if (!slopes) {
            const Lobe<double> lobe(shapes.data(), words_);
            for (std::size_t k = 0; k < size; ++k) {
                double own = 0;
                const double value = lobe(geometry(samples, begin + k), own);
                base[k] += own;
                if (places_.lobe) linear[*places_.lobe * size + k] = value;
            }
            return;
        }
        using Jet = ceres::Jet<double, n>;
        Jet values[n];
        for (int j = 0; j < n; ++j) values[j] = Jet(shapes[static_cast<std::size_t>(j)], j);
        const Lobe<Jet> lobe(values, words_);
        const std::size_t columns = 1 + places_.count;
        std::fill_n(slopes, n * columns * size, 0.0);
        for (std::size_t k = 0; k < size; ++k) {
            Jet own(0.0);
            const Jet value = lobe(geometry(samples, begin + k), own);
            base[k] += own.a;
            if (places_.lobe) linear[*places_.lobe * size + k] = value.a;
            for (int j = 0; j < n; ++j) {
                double* to = slopes + static_cast<std::size_t>(j) * columns * size + k;
                to[0] = own.v[j];
                if (places_.lobe) to[(1 + *places_.lobe) * size] = value.v[j];
            }
        }
    }

private:
    static PairGeometry geometry(const FitSamples& samples, std::size_t k) {
        return {samples.wo[k], samples.wiX[k], samples.wiY[k], samples.wiZ[k]};
    }

    Places places_;
    LobeWords words_;
};

/// A Lambert term alone.
class Constant final : public LobeFormula {
public:
    void fill(const FitSamples&, std::size_t, std::size_t size, std::span<const double>, double*,
              double* linear, double*) const override {
        std::fill_n(linear, size, 1 / pi);
    }
};

template <template <class> class Lobe, int n>
std::unique_ptr<LobeFormula> make(const Places& places, const LobeWords& words) {
    return std::make_unique<Formula<Lobe, n>>(places, words);
}

/// A formula, the shapes it takes in order, its linear parameter, and the choices it knows.
struct Row {
    std::string_view model;
    std::vector<std::string_view> shapes;
    std::string_view linear;
    std::string_view choice;  ///< "key=word" that has to stand; empty: any
    std::unique_ptr<LobeFormula> (*make)(const Places&, const LobeWords&);
};

const std::vector<Row>& rows() {
    static const std::vector<Row> table{
        {"blinn-phong", {"exponent"}, "ks", "normalized=false", make<BlinnPhongLobe, 1>},
        {"ward", {"ax"}, "ks", "", make<WardLobe, 1>},
        {"ggx", {"alpha"}, "F0", "fresnel=schlick", make<GgxLobe, 1>},
        {"beckmann", {"alpha"}, "F0", "fresnel=schlick", make<BeckmannLobe, 1>},
        {"cook-torrance", {"F0", "m"}, "ks", "", make<CookTorranceLobe, 2>},
        {"abc", {"B", "C", "ior"}, "A", "", make<AbcLobe, 3>},
        {"sgd",
         {"alpha", "p", "Lambda", "c", "k", "theta0", "F0", "F1"},
         "ks",
         "",
         make<SgdLobe, 8>}};
    return table;
}

LobeWords wordsOf(const Model& model, const Parameters& stated) {
    LobeWords words;
    for (const Parameter& parameter : model.parameters)
        if (parameter.kind == Parameter::Kind::choice) {
            const auto found = stated.words.find(parameter.name);
            words[std::string(parameter.name)] = found != stated.words.end()
                                                     ? found->second
                                                     : std::string(parameter.choices.front());
        }
    return words;
}

bool matches(const Row& row, const std::vector<FreeParameter>& shapes, const LobeWords& words) {
    if (shapes.size() != row.shapes.size()) return false;
    for (std::size_t j = 0; j < shapes.size(); ++j)
        if (shapes[j].keys.front() != row.shapes[j]) return false;
    // Ward's ay goes with ax.
    if (row.model == "ward" && shapes.front().keys.size() != 2) return false;
    if (row.choice.empty()) return true;
    const std::size_t equals = row.choice.find('=');
    return words.at(std::string(row.choice.substr(0, equals))) == row.choice.substr(equals + 1);
}

}  // namespace

std::unique_ptr<LobeFormula> makeLobeFormula(const Model& model, const Parameters& stated,
                                             const std::vector<FreeParameter>& shapes,
                                             const std::vector<std::string>& linearKeys) {
    for (const Parameter& parameter : model.parameters)
        if (parameter.kind != Parameter::Kind::choice && stated.given(parameter.name))
            return nullptr;
    if (model.name == "lambert" && linearKeys.size() == 1) return std::make_unique<Constant>();
    const LobeWords words = wordsOf(model, stated);
    for (const Row& row : rows()) {
        if (row.model != model.name || !matches(row, shapes, words)) continue;
        Places places{.diffuse = {}, .lobe = {}, .count = linearKeys.size()};
        for (std::size_t k = 0; k < linearKeys.size(); ++k) {
            if (linearKeys[k] == "kd")
                places.diffuse = k;
            else if (linearKeys[k] == row.linear)
                places.lobe = k;
            else
                return nullptr;
        }
        return places.lobe ? row.make(places, words) : nullptr;
    }
    return nullptr;
}

}  // namespace hshfit::brdfs
