#include <brdfs/analytic/facet_normals.h>

#include <brdfs/analytic/facet_fresnel.h>

#include <cmath>

namespace hshfit::brdfs {

std::function<double(const Direction& h)> ggxNormals(double ax, double ay) {
    return [ax, ay](const Direction& h) {
        const double x = h.x / ax, y = h.y / ay, sum = x * x + y * y + h.z * h.z;
        return 1 / (pi * ax * ay * sum * sum);
    };
}

std::function<double(const Direction& h)> beckmannNormals(double ax, double ay) {
    return [ax, ay](const Direction& h) {
        if (!(h.z > 0)) return 0.0;
        const double x = h.x / ax, y = h.y / ay, square = h.z * h.z;
        return std::exp(-(x * x + y * y) / square) / (pi * ax * ay * square * square);
    };
}

FacetNormals microfacetNormals(const Model& model, const Parameters& p,
                               std::function<double(const Direction& h)> density,
                               const RoughnessOf<double>& roughness, bool gaussian) {
    FacetNormals result{
        .density = std::move(density),
        .widthX = roughness.ax,
        .widthY = roughness.ay,
        .weights = {overPi(p.colour("kd")), FacetFresnel(model, p).weights(p.colour("ks"))}};
    result.ofLobe.assign(result.weights.terms.size(), true);
    const bool same = p.number("alpha") > 0;
    result.text = facetText(
        {{"ax", same ? "alpha" : "ax", roughness.ax}, {"ay", same ? "alpha" : "ay", roughness.ay}},
        {"smith"});
    if (gaussian) result.text.flags.emplace_back("gaussian");
    if (p.choice("masking") == "correlated") result.text.flags.emplace_back("correlated");
    const FacetFresnel fresnel(model, p);
    for (const FacetIndex<double>& index : fresnel.indices())
        result.text.indices.push_back({{"ior", "ior", index.ior}, {"k", "k", index.k}});
    if (fresnel.indices().empty()) result.text.flags.emplace_back("schlick");
    return result;
}

}  // namespace hshfit::brdfs
