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
                               MuellerElements elements, std::string name)
    : reflectance_(std::move(reflectance)),
      elements_(std::move(elements)),
      channels_(elements_.channels(reflectance_.channels())),
      name_(std::move(name)) {
    laws_.isotropic = true;
    laws_.nonNegative = elements_.arePositive();
    for (const std::size_t at : elements_.places()) {
        const int least = static_cast<int>(std::min(at / 4, at % 4));
        const int most = static_cast<int>(std::max(at / 4, at % 4));
        for (const Row& row : rows)
            if (row.i == least && row.j == most) addRow(row, at);
    }
    for (std::size_t k = 0; k < elements_.size(); ++k) {
        const bool has = std::ranges::any_of(elements_.places(k), [&](std::size_t place) {
            return std::ranges::find(products_, place, &Product::place) != products_.end();
        });
        // f_11 is the expansion's own, whose rows are not among these.
        if (!has && elements_.names()[k] != "m00")
            throw InputError(fmt::format("{}: the file has no row of {} (i <= j); name the others",
                                         name_, elements_.names()[k]));
    }
}

std::size_t ZernikeMueller::mode(int n, int k) {
    const auto index = std::ranges::find(modes_, std::pair(n, k)) - modes_.begin();
    if (index == std::ssize(modes_)) modes_.emplace_back(n, k);
    return static_cast<std::size_t>(index);
}

void ZernikeMueller::addRow(const Row& row, std::size_t place) {
    const bool below = place / 4 > place % 4, diagonal = row.i == row.j;
    const bool same = row.n[0] == row.n[1] && row.k[0] == row.k[1];
    Product product{place, mode(row.n[0], row.k[0]), mode(row.n[1], row.k[1]), {}};
    const double sign = below && isOdd(place / 4, place % 4) ? -1 : 1;
    const double factor = diagonal ? 1 / std::sqrt(same ? 4.0 : 2.0) : sign;
    const auto& nanometres = channels().wavelengths;
    for (std::size_t c = 0; c < reflectance_.channels().count(); ++c) {
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
    const std::size_t wavelengths = reflectance_.channels().count();
    std::vector<double> f(wavelengths * wi.count);
    reflectance_.eval(wo, wi, f.data());
    std::fill_n(out, channels_.count() * wi.count, 0.0);
    if (!(wo.z > 0)) return;
    std::vector<MuellerElements::Matrix> matrices(wavelengths);
    for (std::size_t k = 0; k < wi.count; ++k) {
        if (!(wi.z[k] > 0)) continue;
        ratios(wo, {wi.x[k], wi.y[k], wi.z[k]}, matrices);
        for (std::size_t w = 0; w < wavelengths; ++w) {
            for (double& element : matrices[w]) element *= f[w * wi.count + k];
            for (std::size_t e = 0; e < elements_.size(); ++e)
                out[(e * wavelengths + w) * wi.count + k] = elements_.value(e, matrices[w]);
        }
    }
}

void ZernikeMueller::ratios(const Direction& wo, const Direction& wi,
                            std::vector<MuellerElements::Matrix>& out) const {
    std::vector<double> there(modes_.size()), here(modes_.size());
    modes(wi, pi, here.data());
    modes(wo, pi + azimuth(wo) - azimuth(wi), there.data());
    std::ranges::fill(out, MuellerElements::Matrix{1});
    for (const Product& product : products_) {
        const double both = here[product.first] * there[product.second];
        for (std::size_t w = 0; w < out.size(); ++w)
            out[w][product.place] += product.weights[w] * both;
    }
}

std::vector<Fact> ZernikeMueller::facts() const {
    return {{"format", "scatmech"},
            {"terms", static_cast<std::int64_t>(rows_)},
            muellerFact(elements_),
            {"axes",
             "x in the plane of incidence, and y, carried along to the direction of the light"}};
}

}  // namespace hshfit::brdfs
