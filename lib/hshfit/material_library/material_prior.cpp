#include <hshfit/material_library/internal/material_prior.h>

#include <hshfit/brdf/uniform.h>
#include <hshfit/error.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/log_terms.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::material_library {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Numbers = std::array<MatrixXd, planes>;

constexpr std::size_t fewestMaterials = 3, mostMaterials = 1000, mostFolds = 10;
constexpr double alike = 0.5;  ///< share of the covariance beyond components that has no direction

/// The materials with what a prior needs.
std::vector<Measured> materialsOf(const Library& library) {
    std::vector<Measured> all = library.measured;
    if (!all.empty()) return all;
    for (const Material& material : library.materials) {
        if (material.kind != Kind::coded) continue;
        const LogMaterial logs = decode(library.basis, material.codes);
        all.push_back({.name = material.name,
                       .source = material.source,
                       .exponents = {logs.exponents.begin(), logs.exponents.end()},
                       .tops = {logs.tops.begin(), logs.tops.end()},
                       .error = material.error});
    }
    return all;
}

/// The rest beyond the terms: as measured, or, of files that do not say it, the same everywhere
/// and in all planes. The mean magnitude of a normal distribution is 0.8 of the deviation.
VectorXd restOf(const Measured& material) {
    if (material.rest.empty())
        return VectorXd::Constant(restRows, std::pow(1.25 * material.error.logError, 2));
    return Eigen::Map<const Eigen::VectorXf>(material.rest.data(), restRows).cast<double>();
}

Numbers leavingOut(const Numbers& numbers, std::size_t fold, std::size_t folds) {
    std::vector<Index> kept;
    for (Index m = 0; m < numbers[0].cols(); ++m)
        if (static_cast<std::size_t>(m) % folds != fold) kept.push_back(m);
    Numbers some;
    for (std::size_t p = 0; p < planes; ++p) some[p] = numbers[p](Eigen::all, kept);
    return some;
}

/// The components of materials about the mean of each plane, one a column.
MatrixXd componentsOf(const Numbers& numbers, std::size_t most) {
    MatrixXd sum = MatrixXd::Zero(numbers[0].rows(), numbers[0].rows());
    for (const MatrixXd& plane : numbers) {
        const MatrixXd off = plane.colwise() - plane.rowwise().mean();
        sum += off * off.transpose();
    }
    const Index count = std::min<Index>(static_cast<Index>(std::max<std::size_t>(most, 1)),
                                        3 * (numbers[0].cols() - 1));
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(sum);
    return solver.eigenvectors().rowwise().reverse().leftCols(std::min(count, sum.cols()));
}

/// The distribution of materials with these components. `beyond` has the rests of other materials,
/// beyond the components.
Normal normalOf(const MatrixXd& numbers, const MatrixXd& components, const MatrixXd& beyond) {
    const auto count = static_cast<double>(numbers.cols());
    const auto k = static_cast<double>(components.cols()), shrink = k / (k + count);
    Normal normal{numbers.rowwise().mean(), {}};
    const MatrixXd a = components.transpose() * (numbers.colwise() - normal.mean);
    MatrixXd within = a * a.transpose() / (count - 1);
    const VectorXd diagonal = within.diagonal();
    within *= 1 - shrink;
    within.diagonal() = diagonal;
    MatrixXd rest = beyond * beyond.transpose() / static_cast<double>(beyond.cols());
    const double mean = rest.trace() / static_cast<double>(rest.rows());
    rest *= 1 - alike;
    rest.diagonal().array() += alike * mean;
    normal.covariance = components * within * components.transpose() + rest;
    return normal;
}

Prior priorOf(const Numbers& numbers, const MatrixXd& components, const Numbers& beyond) {
    Prior prior;
    for (std::size_t p = 0; p < planes; ++p) prior[p] = normalOf(numbers[p], components, beyond[p]);
    return prior;
}

}  // namespace

Index restRow(std::size_t plane, std::size_t zone) {
    return static_cast<Index>((plane == 0 ? 0 : restZones) + zone);
}

VectorXd normalNumbers(Index count, std::mt19937_64& random) {
    VectorXd numbers(count);
    for (double& number : numbers) {
        const double radius = std::sqrt(-2 * std::log(1 - uniform(random)));
        number = radius * std::cos(2 * pi * uniform(random));
    }
    return numbers;
}

MaterialPrior::MaterialPrior(const LogSpace& space, const Library& library) {
    const std::vector<Measured> materials = materialsOf(library);
    if (materials.size() < fewestMaterials)
        throw InputError(
            fmt::format("the library has {} materials as sums of terms; a prior needs {} or more",
                        materials.size(), fewestMaterials));
    const std::size_t step = (materials.size() + mostMaterials - 1) / mostMaterials;
    const auto count = static_cast<Index>((materials.size() + step - 1) / step);
    const auto terms = static_cast<Index>(logTerms().size());
    for (MatrixXd& plane : numbers) plane.resize(terms, count);
    rests.resize(restRows, count);
    top = std::log(logOffset);
    const MatrixXd planesOf = planeMatrix().transpose();
    for (Index m = 0; m < count; ++m) {
        const Measured& material = materials[static_cast<std::size_t>(m) * step];
        MatrixXd channels =
            Eigen::Map<const Eigen::MatrixXf>(material.exponents.data(), terms,
                                              static_cast<Index>(material.channels()))
                .cast<double>();
        // A grey material has its channel for every colour.
        if (channels.cols() == 1) channels = channels.replicate(1, 3).eval();
        const MatrixXd d = space.samples().lower.transpose() * channels * planesOf;
        for (std::size_t p = 0; p < planes; ++p) numbers[p].col(m) = d.col(static_cast<Index>(p));
        rests.col(m) = restOf(material);
        top = std::max<double>(top, *std::ranges::max_element(material.tops));
    }
    const std::size_t parts = std::min<std::size_t>(mostFolds, static_cast<std::size_t>(count));
    std::vector<MatrixXd> components;
    Numbers beyond = numbers;
    for (std::size_t fold = 0; fold < parts; ++fold) {
        const Numbers others = leavingOut(numbers, fold, parts);
        components.push_back(componentsOf(others, library.basis.size()));
        const MatrixXd& b = components.back();
        for (std::size_t p = 0; p < planes; ++p) {
            const VectorXd mean = others[p].rowwise().mean();
            for (auto m = static_cast<Index>(fold); m < count; m += static_cast<Index>(parts)) {
                const VectorXd off = numbers[p].col(m) - mean;
                beyond[p].col(m) = off - b * (b.transpose() * off);
            }
        }
    }
    all = priorOf(numbers, componentsOf(numbers, library.basis.size()), beyond);
    for (std::size_t fold = 0; fold < parts; ++fold)
        folds.push_back(priorOf(leavingOut(numbers, fold, parts), components[fold],
                                leavingOut(beyond, fold, parts)));
}

}  // namespace hshfit::material_library
