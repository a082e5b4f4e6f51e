#include "form_samples.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/factoring/factoring.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/representation/named_arrays.h>

#include <cmath>
#include <random>

namespace hshfit::samples {
namespace {

struct Asked {
    HalfwayOrders orders;
    Channels channels;
    HalfwaySymmetry symmetry;
    Precision precision = Precision::float32;
    double ceiling = 1.7;  ///< that some pairs exceed
    std::size_t keep = 0;
};

FormSample sample(const std::string& name, const Asked& asked, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Representation r;
    r.head.channels = asked.channels;
    r.head.isotropic = asked.symmetry.isotropic;
    r.head.bilateral = asked.symmetry.bilateral;
    r.head.reciprocal = asked.symmetry.reciprocal;
    r.head.source = "random";
    r.head.generator = "hshfit test";
    r.halfway = asked.orders;
    const HalfwayTerms terms(asked.orders, asked.symmetry);
    const std::size_t channels = asked.channels.count();
    HalfwayArray content{{.shape = {channels, terms.size()}, .values = {}}};
    for (std::size_t c = 0; c < channels; ++c) {
        for (const HalfwayTerm& t : terms.list()) {
            const int degree = t.i + t.j + t.k + t.q;
            const double fall = 1 + degree * degree;
            content.halfway.values.push_back((degree == 0 ? 0.5 : 0) + uniform(random) / fall);
        }
    }
    if (asked.keep > 0) keepLargest(content.halfway, asked.keep);
    quantise(content.halfway, asked.precision);
    if (asked.symmetry.isotropic) {
        content.lobe = {0.3, 0.3, 0};
    } else {
        content.lobe = {0.3, 0.12, asked.symmetry.bilateral ? 0.0 : 0.4, 0.02, true};
    }
    content.ceilings.assign(channels, {asked.ceiling, asked.ceiling, std::exp(asked.ceiling + 1)});
    r.content = std::move(content);
    return {name, std::move(r)};
}

struct AskedBasis {
    std::string basis;
    int order;
    Channels channels;
    ProductSymmetry symmetry;
    Precision precision = Precision::float32;
    Quantity quantity = Quantity::brdf;
    std::size_t keep = 0;
};

FormSample basisSample(const std::string& name, const AskedBasis& asked, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Representation r;
    r.head.basis = asked.basis;
    r.head.order = asked.order;
    r.head.quantity = asked.quantity;
    r.head.channels = asked.channels;
    r.head.isotropic = asked.symmetry.isotropic;
    r.head.bilateral = asked.symmetry.bilateral;
    r.head.reciprocal = asked.symmetry.reciprocal;
    r.head.source = "random";
    r.head.generator = "hshfit test";
    const auto terms = productTerms(*bases::make(asked.basis, asked.order), asked.symmetry);
    MatrixArray content{{.shape = {asked.channels.count(), terms.size()}, .values = {}}};
    for (std::size_t c = 0; c < asked.channels.count(); ++c) {
        for (const ProductTerm& t : terms) {
            const double value = t.l + t.k == 0 ? 2 : uniform(random);
            content.matrix.values.push_back(value / (1 + t.l + t.k));
        }
    }
    if (asked.keep > 0) keepLargest(content.matrix, asked.keep);
    quantise(content.matrix, asked.precision);
    r.content = std::move(content);
    return {name, std::move(r)};
}

/// A form basis in factors of a rank that leaves some blocks whole.
FormSample factoredSample(const std::string& name, const AskedBasis& asked, int rank,
                          unsigned seed) {
    AskedBasis exact = asked;
    exact.precision = Precision::float64;
    exact.keep = 0;
    FormSample made = basisSample(name, exact, seed);
    made.form = factored(std::move(made.form), {.rank = rank});
    for (const auto& array : namedArrays(made.form)) {
        if (asked.keep > 0) keepLargest(*array.array, asked.keep);
        quantise(*array.array, asked.precision);
    }
    return made;
}

}  // namespace

std::vector<FormSample> factoredSamples() {
    const Channels rgb = Channels::rgb(), grey = Channels::grey();
    using enum Precision;
    return {
        factoredSample("hsh 6 rgb, isotropic, rank 2", {"hsh", 6, rgb, {true, true, false}}, 2, 31),
        factoredSample("hsh 7 rgb, reciprocal, rank 2, half",
                       {"hsh", 7, rgb, {true, true, true}, half}, 2, 32),
        factoredSample("hsh 6 rgb, twisted, rank 2", {"hsh", 6, rgb, {true, false, false}}, 2, 33),
        factoredSample("zernike 7 grey, twisted, reciprocal, rank 1",
                       {"zernike", 7, grey, {true, false, true}, unorm16}, 1, 34),
        factoredSample("hsh 4 rgb, anisotropic, f cos, rank 3, masked",
                       {"hsh", 4, rgb, {false, false, false}, half, Quantity::brdfCosine, 40}, 3,
                       35),
        factoredSample("hsh 4 rgb, anisotropic, bilateral, reciprocal, rank 3, unorm8",
                       {"hsh", 4, rgb, {false, true, true}, unorm8}, 3, 36),
    };
}

std::vector<FormSample> basisSamples() {
    const Channels rgb = Channels::rgb(), grey = Channels::grey();
    using enum Precision;
    return {
        basisSample("hsh 4 rgb, anisotropic", {"hsh", 4, rgb, {false, false, false}, half}, 21),
        basisSample("hsh 5 rgb, isotropic", {"hsh", 5, rgb, {true, true, false}}, 22),
        basisSample("zernike 6 grey, reciprocal", {"zernike", 6, grey, {true, true, true}}, 23),
        basisSample("hsh 4 rgb, twisted, reciprocal, unorm16",
                    {"hsh", 4, rgb, {true, false, true}, unorm16}, 24),
        basisSample("makhotkin 4 rgb, f cos, masked",
                    {"makhotkin", 4, rgb, {true, false, false}, half, Quantity::brdfCosine, 30},
                    25),
        basisSample("hsh 3 grey, anisotropic, bilateral, reciprocal",
                    {"hsh", 3, grey, {false, true, true}, unorm8}, 26),
    };
}

std::vector<FormSample> halfwaySamples() {
    const Channels rgb = Channels::rgb(), grey = Channels::grey(),
                   spectrum = Channels::spectral({420, 480, 550, 610, 690});
    const HalfwaySymmetry measured{true, true, false}, modelled{true, true, true};
    using enum Precision;
    return {
        sample("12,6,3 rgb, float32", {{12, 6, 3}, rgb, measured}, 1),
        sample("7,4,2 rgb, half", {{7, 4, 2}, rgb, measured, half}, 2),
        sample("7,4,2 rgb, unorm16", {{7, 4, 2}, rgb, measured, unorm16}, 3),
        sample("7,4,2 rgb, unorm8", {{7, 4, 2}, rgb, measured, unorm8}, 4),
        sample("8,4,3 rgb, half, masked", {{8, 4, 3}, rgb, measured, half, 1.7, 60}, 5),
        sample("8,4,2 grey, reciprocal", {{8, 4, 2}, grey, modelled}, 6),
        sample("7,5,4 rgb, twisted", {{7, 5, 4}, rgb, {true, false, false}, half}, 7),
        sample("7,5,4 rgb, anisotropic, half", {{7, 5, 4}, rgb, {false, false, false}, half}, 8),
        sample("6,4,3 grey, anisotropic, bilateral", {{6, 4, 3}, grey, {false, true, false}}, 9),
        sample("6,4,4 rgb, anisotropic, reciprocal", {{6, 4, 4}, rgb, {false, false, true}}, 10),
        sample("5,3,2 spectral, half", {{5, 3, 2}, spectrum, measured, half}, 11),
        sample("5,3,2 spectral, unorm8, masked", {{5, 3, 2}, spectrum, measured, unorm8, 1.7, 40},
               12),
        sample("9,8,6 rgb, below its ceilings", {{9, 8, 6}, rgb, modelled, half, 20}, 13),
        sample("1,1,1 grey", {{1, 1, 1}, grey, modelled}, 14),
    };
}

}  // namespace hshfit::samples
