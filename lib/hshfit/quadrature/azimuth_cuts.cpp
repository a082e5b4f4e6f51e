#include <hshfit/quadrature/azimuth_cuts.h>

#include <hshfit/brdf/directions.h>
#include <hshfit/quadrature/quadrature.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline quadrature {
namespace {

double offsetOf(const KinkCurve& curve, double height) {
    return curve.constant + height * (curve.linear + height * curve.square);
}

double radiusOf(const KinkCurve& curve) {
    return std::hypot(curve.x, curve.y);
}

/// Rings alone are no curves: the BRDF's kinks() name them.
bool isCurve(const KinkCurve& curve) {
    return radiusOf(curve) > 0;
}

/// Sign changes of a function of theta in (0, pi / 2), as heights.
template <class Function>
void addRoots(const Function& value, std::vector<double>& heights) {
    constexpr int steps = 128, halvings = 60;
    double before = 0, valueBefore = value(0.0);
    for (int k = 1; k <= steps; ++k) {
        const double here = pi / 2 * k / steps, valueHere = value(here);
        if ((valueBefore < 0) != (valueHere < 0)) {
            double low = before, high = here;
            for (int h = 0; h < halvings; ++h) {
                const double middle = 0.5 * (low + high);
                ((value(middle) < 0) == (valueBefore < 0) ? low : high) = middle;
            }
            heights.push_back(std::cos(0.5 * (low + high)));
        }
        before = here;
        valueBefore = valueHere;
    }
}

/// Heights at which two curves about the same axis cross.
void addMeetings(const KinkCurve& a, const KinkCurve& b, std::vector<double>& heights) {
    constexpr double parallel = 1e-9;
    const double ra = radiusOf(a), rb = radiusOf(b);
    if (std::abs(a.x * b.y - a.y * b.x) > parallel * ra * rb) return;
    const double side = a.x * b.x + a.y * b.y < 0 ? -1 : 1;
    addRoots(
        [&](double theta) {
            const double height = std::cos(theta);
            return offsetOf(a, height) / ra - side * offsetOf(b, height) / rb;
        },
        heights);
}

/// Minus the cosine of the angle between the curve's axis and its crossings; beyond 1: none.
double crossing(const KinkCurve& curve, double height, double sine) {
    return offsetOf(curve, height) / (radiusOf(curve) * sine);
}

}  // namespace

std::vector<double> curveEnds(const std::vector<KinkCurve>& curves) {
    std::vector<double> heights;
    for (std::size_t k = 0; k < curves.size(); ++k) {
        const KinkCurve& curve = curves[k];
        if (!isCurve(curve)) continue;
        const double radius = radiusOf(curve);
        std::vector<double> own;
        for (const double side : {-1.0, 1.0})
            addRoots(
                [&](double theta) {
                    return offsetOf(curve, std::cos(theta)) + side * radius * std::sin(theta);
                },
                own);
        for (const double height : own)
            if (height > curve.low && height < curve.high) heights.push_back(height);
        heights.push_back(curve.low);
        heights.push_back(curve.high);
        for (std::size_t j = 0; j < k; ++j)
            if (isCurve(curves[j])) addMeetings(curve, curves[j], heights);
    }
    std::erase_if(heights, [](double height) { return !(height > 0 && height < 1); });
    return heights;
}

PanelCurves::PanelCurves(const std::vector<KinkCurve>& all, double a, double b) {
    const auto sineOf = [](double height) { return std::sqrt((1 - height) * (1 + height)); };
    const double middle = 0.25 * (a + b) * (a + b);
    for (const KinkCurve& curve : all) {
        if (!isCurve(curve) || middle <= curve.low || middle >= curve.high) continue;
        if (!(std::abs(crossing(curve, middle, sineOf(middle))) < 1)) continue;
        curves.push_back(curve);
        constexpr double touching = 1e-6;
        const auto touches = [&](double u) {
            const double height = u * u;
            return height > 0 && std::abs(crossing(curve, height, sineOf(height))) > 1 - touching;
        };
        rootAtA = rootAtA || touches(a);
        rootAtB = rootAtB || b == 1 || touches(b);
    }
}

Crowded crowded(double s, bool atFrom, bool atTo) {
    if (atFrom && atTo) return {s * s * (3 - 2 * s), 6 * s * (1 - s)};
    if (atFrom) return {s * s, 2 * s};
    if (atTo) return {s * (2 - s), 2 * (1 - s)};
    return {s, 1};
}

CutRing::CutRing(const PanelCurves& curves, const AzimuthSpread& spread, double refinement,
                 double height, double sine) {
    struct Cut {
        double t;
        bool crowd;
    };
    std::vector<Cut> cuts = {{0, false}, {pi, false}};
    const double kappa = spread.spacing.kappa();
    for (const KinkCurve& curve : curves.curves) {
        const double cosine = std::clamp(-crossing(curve, height, sine), -1.0, 1.0);
        const double axis = std::atan2(spread.centreX * curve.y - spread.centreY * curve.x,
                                       spread.centreX * curve.x + spread.centreY * curve.y);
        for (const double side : {-1.0, 1.0}) {
            const double phi = std::abs(std::remainder(axis + side * std::acos(cosine), 2 * pi));
            const double t =
                spread.spacing.squeeze > 0 ? 2 * std::atan(std::tan(phi / 2) / kappa) : phi;
            cuts.push_back({std::clamp(t, 0.0, pi), !curve.smoothSides});
        }
    }
    std::ranges::stable_sort(cuts, {}, &Cut::t);
    std::vector<Cut> apart;
    for (const Cut& cut : cuts) {
        constexpr double together = 1e-9;
        if (!apart.empty() && cut.t - apart.back().t < together)
            apart.back().crowd = apart.back().crowd || cut.crowd;
        else
            apart.push_back(cut);
    }
    apart.back().t = pi;
    // Gauss-Legendre nodes on a piece have to be pi / 2 as dense as equispaced ones.
    constexpr double leastNodes = 3, crowding = 1.5;
    const double density = static_cast<double>(spread.spacing.azimuths) / 4;
    for (std::size_t k = 0; k + 1 < apart.size(); ++k) {
        const double length = apart[k + 1].t - apart[k].t;
        double nodes = leastNodes * refinement + density * length;
        if (apart[k].crowd || apart[k + 1].crowd) nodes *= crowding;
        pieces_.push_back({apart[k].t, apart[k + 1].t, apart[k].crowd, apart[k + 1].crowd,
                           static_cast<std::size_t>(std::ceil(nodes))});
        size_ += pieces_.back().nodes;
    }
}

void CutRing::nodes(std::vector<double>& t, std::vector<double>& weights) const {
    t.clear();
    weights.clear();
    for (const Piece& piece : pieces_) {
        const GaussRule& rule = gaussLegendre(static_cast<int>(piece.nodes));
        const double length = piece.to - piece.from;
        for (std::size_t j = 0; j < piece.nodes; ++j) {
            const Crowded place =
                crowded(0.5 * (1 + rule.nodes[j]), piece.crowdFrom, piece.crowdTo);
            t.push_back(piece.from + length * place.at);
            weights.push_back(0.5 * length * place.slope * rule.weights[j]);
        }
    }
}

}  // namespace hshfit::inline quadrature
