// Terms of eon.h. Included by eon.cpp once for each instruction set.

#include <brdfs/analytic/eon_lobe.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

struct EonFormula {
    template <class T>
    using Terms = EonTerms<T>;

    template <class N>
    static EonSettings<N> settings(const Values<N>& p) {
        return {eonRoughness(p("roughness")), p.chosen("albedo", "exact")};
    }
    template <class N>
    static EonShape<N> shape(const Values<N>& p) {
        return settings(p).shape();
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        const N kd = p("kd");
        return {N(0.0), {kd / pi, settings(p).multiple(kd)}};
    }
};

struct OpenpbrDiffuseFormula {
    template <class T>
    using Terms = EonTerms<T>;

    template <class N>
    static EonSettings<N> settings(const Values<N>& p) {
        return {eonRoughness(p("base_diffuse_roughness")), true};
    }
    template <class N>
    static EonShape<N> shape(const Values<N>& p) {
        return settings(p).shape();
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        const N kd = p("base_weight") * p("base_color");
        return {N(0.0), {kd / pi, settings(p).multiple(kd)}};
    }
};

void evalEon(const EonShape<double>& shape, const TermBatch& batch) {
    evalLanes<EonTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> eonColumns(const ColumnRequest& request) {
    return columnsOf<EonFormula, 2>(request);
}
std::unique_ptr<ModelColumns> openpbrDiffuseColumns(const ColumnRequest& request) {
    return columnsOf<OpenpbrDiffuseFormula, 2>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
