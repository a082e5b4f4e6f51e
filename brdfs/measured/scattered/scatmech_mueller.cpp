#include <brdfs/measured/scattered/scatmech_mueller.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// az_k.
double azimuthal(int k, double phi) {
    if (k == 0) return std::sqrt(0.5);
    return k > 0 ? std::cos(k * phi) : -std::sin(k * phi);
}

/// The elements below the diagonal that change their sign with the order of directions.
bool isOdd(std::size_t row, std::size_t column) {
    return (row == 2 && column < 2) || (row == 3 && column == 2);
}

}  // namespace

ZernikeMueller::ZernikeMueller(ZernikeExpansion reflectance, const std::vector<Row>& rows,
                               MuellerElement element, std::string name)
    : reflectance_(std::move(reflectance)), element_(std::move(element)), name_(std::move(name)) {
    laws_.isotropic = true;
    laws_.nonNegative = element_.isDegree();
    for (std::size_t place = 0; place < element_.places().size(); ++place) {
        const std::size_t at = element_.places()[place];
        if (at == 0) continue;  // f_11 is that of the expansion
        const int least = static_cast<int>(std::min(at / 4, at % 4));
        const int most = static_cast<int>(std::max(at / 4, at % 4));
        for (const Row& row : rows)
            if (row.i == least && row.j == most) addRow(row, place);
    }
    if (products_.empty()) {
        throw InputError(fmt::format("{}: the file has no row of this element (i <= j)", name_));
    }
}

std::size_t ZernikeMueller::mode(int n, int k) {
    const auto index = std::ranges::find(modes_, std::pair(n, k)) - modes_.begin();
    if (index == std::ssize(modes_)) modes_.emplace_back(n, k);
    return static_cast<std::size_t>(index);
}

void ZernikeMueller::addRow(const Row& row, std::size_t place) {
    const std::size_t at = element_.places()[place];
    const bool below = at / 4 > at % 4, diagonal = row.i == row.j;
    const bool same = row.n[0] == row.n[1] && row.k[0] == row.k[1];
    Product product{place, mode(row.n[0], row.k[0]), mode(row.n[1], row.k[1]), {}};
    const double sign = below && isOdd(at / 4, at % 4) ? -1 : 1;
    const double factor = diagonal ? 1 / std::sqrt(same ? 4.0 : 2.0) : sign;
    const auto& nanometres = channels().wavelengths;
    for (std::size_t c = 0; c < channels().count(); ++c) {
        const double um = nanometres.empty() ? 1 : nanometres[c] / 1000;
        product.weights.push_back(row.a * factor * std::pow(um, row.p));
    }
    if (below) std::swap(product.first, product.second);
    products_.push_back(product);
    ++rows_;
    if (!diagonal) return;
    std::swap(product.first, product.second);
    products_.push_back(std::move(product));
}

void ZernikeMueller::modes(const Direction& d, double phi, double* out) const {
    const double r = std::sqrt(oneMinusZ(d));
    for (std::size_t s = 0; s < modes_.size(); ++s) {
        const auto [n, k] = modes_[s];
        out[s] = std::sqrt((n + 1) / pi) * zernikeRadial(n, std::abs(k), r) * azimuthal(k, phi);
    }
}

void ZernikeMueller::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    reflectance_.eval(wo, wi, out);
    if (!(wo.z > 0)) return;
    const std::size_t channels = this->channels().count();
    std::vector<double> there(modes_.size()), here(modes_.size());
    std::vector<std::array<double, 3>> sums(channels);
    for (std::size_t k = 0; k < wi.count; ++k) {
        if (!(wi.z[k] > 0)) continue;
        const Direction in{wi.x[k], wi.y[k], wi.z[k]};
        modes(in, pi, here.data());
        modes(wo, pi + azimuth(wo) - azimuth(in), there.data());
        std::ranges::fill(sums, std::array<double, 3>{element_.isDegree() ? 1.0 : 0.0, 0, 0});
        for (const Product& product : products_) {
            const double both = here[product.first] * there[product.second];
            for (std::size_t c = 0; c < channels; ++c)
                sums[c][product.place] += product.weights[c] * both;
        }
        for (std::size_t c = 0; c < channels; ++c) {
            double& value = out[c * wi.count + k];
            const double ratio = element_.value(sums[c].data());
            value = element_.isDegree() ? ratio : value * ratio;
        }
    }
}

std::vector<Fact> ZernikeMueller::facts() const {
    return {{"format", "scatmech"},
            {"terms", static_cast<std::int64_t>(rows_)},
            muellerFact(element_),
            {"axes",
             "x in the plane of incidence, and y, carried along to the direction of the light"}};
}

}  // namespace hshfit::brdfs
