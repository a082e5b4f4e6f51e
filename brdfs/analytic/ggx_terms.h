// Terms of ggx.h. Included by ggx.cpp once for each instruction set.

#include <brdfs/analytic/facet_terms.h>
#include <brdfs/analytic/ggx_facets.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
using GgxTerms = FacetTerms<T, GgxFacets, GgxShape>;

struct GgxFormula {
    template <class T>
    using Terms = GgxTerms<T>;

    template <class N>
    static auto shape(const Values<N>& p) {
        return facetShape(p, GgxShape<N>{facetRoughness(p)});
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return facetWeights(p);
    }
};

void evalGgx(const FacetShape<GgxShape<double>>& shape, const TermBatch& batch) {
    evalLanes<GgxTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> ggxColumns(const ColumnRequest& request) {
    return columnsOf<GgxFormula, 2>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
