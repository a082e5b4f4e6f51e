#include <hshfit/bases/internal/h_basis.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace hshfit::bases {

namespace {

class HBasis final : public Basis {
public:
    HBasis(int order, BasisOptions options) : Basis(order, options) {}

    std::string name() const override { return "h-basis"; }

    bool has(int l, int m) const override {
        return Basis::has(l, m) && (l < 2 || std::abs(m) == 2);
    }

    void theta(int m, std::span<const Elevation<double>> points, double* out) const override {
        fill(m, points, out);
    }
    void theta(int m, std::span<const Elevation<float>> points, float* out) const override {
        fill(m, points, out);
    }

private:
    template <class Real>
    void fill(int m, std::span<const Elevation<Real>> points, Real* out) const {
        for (int l = m; l < order(); ++l) {
            Real* row = out + static_cast<std::size_t>(l - m) * points.size();
            std::transform(points.begin(), points.end(), row,
                           [=](const Elevation<Real>& e) { return value(l, m, e); });
        }
    }

    template <class Real>
    static Real value(int l, int m, const Elevation<Real>& e) {
        if (e.mu < 0) return 0;
        const Real sineSquared = e.oneMinusMu * (1 + e.mu);
        if (l == 0) return 1;
        if (l == 1 && m == 0) return std::sqrt(Real{3}) * (e.mu - e.oneMinusMu);
        if (l == 1) return std::sqrt(Real{1.5} * sineSquared);
        if (l == 2 && m == 2) return std::sqrt(Real{1.875}) * sineSquared;
        return 0;
    }
};

}  // namespace

std::unique_ptr<Basis> makeHBasis(int order, BasisOptions options) {
    return std::make_unique<HBasis>(order, options);
}

}  // namespace hshfit::bases
