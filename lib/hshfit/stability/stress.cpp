#include <hshfit/stability/stress.h>

#include <hshfit/bases/jacobi.h>
#include <hshfit/error.h>
#include <hshfit/projection/one_basis.h>
#include <hshfit/rotation/sh_rotation.h>
#include <hshfit/stability/internal/basis_change_errors.h>
#include <hshfit/stability/internal/rotation_errors.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

namespace hshfit::stability {
namespace {

LobeProjection projectLobe(const Brdf& brdf, double thetaDegrees) {
    LobeProjection result{.brdf = brdf.name(), .thetaDegrees = thetaDegrees};
    const auto basis = bases::make("hsh", 7, {});
    try {
        const Projection projection =
            project(brdf, *basis, OutgoingSet::direction(radians(thetaDegrees), 0),
                    {.quantity = Quantity::brdfCosine});
        const Coefficients& c = projection.coefficients;
        result.converged = c.energy.finite;
        result.reason = c.energy.reason;
        result.error = c.error;
        result.captured = projection.captured.back() / c.energy.value;
        result.evaluations = projection.evaluations;
    } catch (const NumericError& error) {
        result.reason = error.what();
    }
    return result;
}

/// 2, 3, …, 10, then by steps that grow, and the last.
std::vector<int> gramOrders(int largest) {
    std::vector<int> orders;
    for (int n = 2; n < largest; n += n < 10 ? 1 : n < 32 ? 2 : 16) orders.push_back(n);
    orders.push_back(largest);
    return orders;
}

/// For rotations of hemispherical bases, whose cost grows with the sixth power of the order.
constexpr int mostMatrixOrder = 16;

/// Rotation, and change of basis with the spherical harmonics as the other one.
void addAlgebra(const bases::Entry& entry, const bases::JacobiBasis& basis, StressReport& report) {
    const auto& asJacobi = [](const Basis& any) -> const bases::JacobiBasis& {
        return dynamic_cast<const bases::JacobiBasis&>(any);
    };
    const int order = std::min(basis.order(), ShRotation::maxOrder);
    const auto same = entry.make(order, {}), harmonics = bases::make("sh", order);
    const auto small = entry.make(std::min(order, mostMatrixOrder), {});
    for (Precision precision : {Precision::twice, Precision::single}) {
        if (entry.name == "sh") {
            report.rotation.push_back(rotationErrors(order, precision));
            continue;
        }
        if (precision == Precision::single || basis.inner() == Basis::Inner::solidAngle)
            report.rotation.push_back(hemisphereRotationErrors(*small, precision));
        report.basisChange.push_back(
            basisChangeErrors(asJacobi(*harmonics), asJacobi(*same), precision));
        if (entry.name == "hsh")
            report.basisChange.push_back(
                basisChangeErrors(asJacobi(*same), asJacobi(*harmonics), precision));
    }
}

}  // namespace

StressReport stress(std::span<const bases::Entry* const> bases, std::span<const Brdf* const> lobes,
                    const StressOptions& options) {
    StressReport report{.maxOrder = options.maxOrder};
    const std::size_t projections = lobes.size() * options.thetaDegrees.size();
    const std::size_t steps = bases.size() * 4 + projections;
    std::atomic<std::size_t> done = 0;
    const auto advance = [&](std::size_t by) {
        done += by;
        if (options.progress) options.progress(done, steps);
    };
    for (const bases::Entry* entry : bases) {
        const int order = std::min(options.maxOrder, entry->maxOrder);
        if (entry->name == "lsosh") {
            for (int n : gramOrders(order)) report.gram.push_back({n, bases::lsoshGram(n)});
        }
        const auto basis = entry->make(order, {});
        const auto* jacobi = dynamic_cast<const bases::JacobiBasis*>(basis.get());
        for (Precision precision : {Precision::twice, Precision::single}) {
            if (!jacobi) break;
            report.evaluation.push_back(evaluationErrors(*jacobi, precision));
            advance(1);
            report.orthonormality.push_back(orthonormalityErrors(*jacobi, precision));
            advance(1);
        }
        if (jacobi) addAlgebra(*entry, *jacobi, report);
        if (!jacobi) advance(4);
    }
    report.projection.resize(projections);
    tbb::parallel_for(std::size_t{0}, projections, [&](std::size_t k) {
        const std::size_t angles = options.thetaDegrees.size();
        report.projection[k] = projectLobe(*lobes[k / angles], options.thetaDegrees[k % angles]);
        advance(1);
    });
    return report;
}

}  // namespace hshfit::stability
