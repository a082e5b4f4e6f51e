#include <hshfit/projection/projection.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/projection/horizon.h>
#include <hshfit/projection/internal/refinement.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <mutex>

namespace hshfit::inline projection {
namespace {

/// An outgoing direction that follows from its group's representative by symmetry.
struct Member {
    std::size_t index;
    double turnX = 1, turnY = 0;        ///< cosine and sine of a rotation about z (isotropic)
    bool flipX = false, flipY = false;  ///< x -> -x, y -> -y (mirror symmetric)
};

/// Outgoing directions that share one quadrature.
struct Group {
    Direction wo;
    bool even = false;  ///< f is even in phi_i
    double solidAngle = 0;
    std::vector<Member> members;
};

std::vector<Group> groupBySymmetry(const OutgoingSet& outgoing, const Laws& laws) {
    std::vector<Group> groups;
    std::map<std::pair<double, double>, std::size_t> known;
    for (std::size_t k = 0; k < outgoing.size(); ++k) {
        const Direction& wo = outgoing.directions[k];
        Member member{k};
        Direction representative = wo;
        std::pair<double, double> key(static_cast<double>(k), -2);
        if (laws.isotropic) {
            const double sine = std::hypot(wo.x, wo.y);
            representative = {sine, 0, wo.z};
            if (sine > 0) member.turnX = wo.x / sine, member.turnY = wo.y / sine;
            key = {wo.z, 0};
        } else if (laws.mirrorSymmetric) {
            representative = {std::abs(wo.x), std::abs(wo.y), wo.z};
            member.flipX = wo.x < 0;
            member.flipY = wo.y < 0;
            key = {representative.x, representative.y};
        }
        const auto [place, isNew] = known.try_emplace(key, groups.size());
        if (isNew) {
            groups.push_back(
                {representative, laws.mirrorSymmetric && representative.y == 0, 0, {}});
        }
        Group& group = groups[place->second];
        group.solidAngle += outgoing.solidAngles[k];
        group.members.push_back(member);
    }
    return groups;
}

/// Coefficients of a member from the coefficients of its group's representative.
void applySymmetry(const Member& member, int order, const double* from, double* to) {
    double c = 1, s = 0;  // of m times the angle
    for (int m = 0; m < order; ++m) {
        if (m > 0) {
            const double next = c * member.turnX - s * member.turnY;
            s = s * member.turnX + c * member.turnY;
            c = next;
        }
        const double flipX = member.flipX && m % 2 ? -1 : 1;
        const double cosineSign = flipX, sineSign = member.flipX ? -flipX : 1;
        for (int l = m; l < order; ++l) {
            if (m == 0) {
                to[slotOf(l, 0)] = from[slotOf(l, 0)];
                continue;
            }
            const double a = from[slotOf(l, m)] * cosineSign;
            const double b = from[slotOf(l, -m)] * (member.flipY ? -sineSign : sineSign);
            to[slotOf(l, m)] = c * a - s * b;
            to[slotOf(l, -m)] = s * a + c * b;
        }
    }
}

/// The bases, and where they are of few functions a further one: changes of few numbers agree by
/// accident, and no error is seen.
std::vector<const Basis*> withMonitor(std::span<const Basis* const> bases) {
    constexpr int enough = 4;
    static const std::unique_ptr<const Basis> monitor = bases::make("hsh", enough);
    std::vector<const Basis*> all(bases.begin(), bases.end());
    if (std::ranges::max(bases, {}, &Basis::order)->order() < enough) all.push_back(monitor.get());
    return all;
}

/// All groups in parallel. Of several failures the first group's is reported, so that the message
/// does not depend on the threads.
std::vector<RefinedMoments> projectGroups(const Brdf& brdf, std::span<const Basis* const> bases,
                                          const std::vector<Group>& groups,
                                          const ProjectionOptions& options, double tolerance) {
    std::vector<RefinedMoments> results(groups.size());
    std::vector<std::exception_ptr> failures(groups.size());
    std::atomic<std::size_t> firstFailure = groups.size(), done = 0;
    const std::vector<const Basis*> all = withMonitor(bases);
    const ProjectionTables tables(all);
    eachInParallel(groups.size(), [&](std::size_t g) {
        if (g > firstFailure) return;
        try {
            results[g] = refineMoments(brdf, tables, groups[g].wo,
                                       {.quantity = options.quantity,
                                        .even = groups[g].even,
                                        .tolerance = tolerance,
                                        .maxEvaluations = options.maxEvaluations});
        } catch (...) {
            failures[g] = std::current_exception();
            std::size_t known = firstFailure;
            while (g < known && !firstFailure.compare_exchange_weak(known, g)) {
            }
        }
        done += groups[g].members.size();
        if (options.progress) options.progress(done, 0);
    });
    if (firstFailure < groups.size()) std::rethrow_exception(failures[firstFailure]);
    return results;
}

Coefficients describe(const Brdf& brdf, const Basis& basis, const OutgoingSet& outgoing,
                      Quantity quantity, double tolerance) {
    Coefficients c;
    c.basis = basis.name();
    c.order = basis.order();
    c.condonShortley = basis.condonShortley();
    c.quantity = quantity;
    c.channels = brdf.channels();
    c.outgoing = outgoing;
    c.isotropic = brdf.laws().isotropic;
    c.bilateral = brdf.laws().mirrorSymmetric;
    c.reciprocal = brdf.laws().reciprocal;
    c.source = brdf.name();
    c.generator = std::string("hshfit ") + version;
    c.tolerance = tolerance;
    c.values.resize(outgoing.size() * c.channels.count() * c.slots());
    return c;
}

/// In an orthonormal basis every band adds its own squares; others are evaluated for every order.
void addCaptured(const Basis& basis, const double* moments, double solidAngle,
                 std::vector<double>& captured) {
    const bool orthonormal = bases::find(basis.name()).orthonormal;
    double sum = 0;
    for (int n = 1; n <= basis.order(); ++n) {
        for (int k = (n - 1) * (n - 1); k < n * n; ++k) sum += moments[k] * moments[k];
        captured[n - 1] += solidAngle * (orthonormal ? sum : basis.capturedEnergy(moments, n));
    }
}

void addGroup(const Basis& basis, std::size_t basisIndex, const Group& group,
              const RefinedMoments& result, Projection& projection) {
    Coefficients& out = projection.coefficients;
    const int e = static_cast<int>(basis.inner());
    out.energy.value += group.solidAngle * result.energy[e];
    out.energy.error += group.solidAngle * result.energyError[e];
    out.error = std::max(
        out.error, result.error * result.enlargement[basisIndex] + result.rounding[basisIndex]);
    projection.evaluations += result.evaluations;
    if (!result.horizon.energyExists(basis.inner()) && out.energy.finite) {
        out.energy.finite = false;
        out.energy.reason = divergenceReason(result.horizon, group.wo, out.quantity);
    }
    std::vector<double> solved(basis.slots());
    for (std::size_t c = 0; c < out.channels.count(); ++c) {
        const double* moments = result.moments[basisIndex].data() + c * basis.slots();
        addCaptured(basis, moments, group.solidAngle, projection.captured);
        basis.coefficientsFromMoments(moments, basis.order(), solved.data());
        for (const Member& member : group.members) {
            applySymmetry(member, basis.order(), solved.data(), out.at(member.index, c));
        }
    }
}

}  // namespace

std::vector<Projection> project(const Brdf& brdf, std::span<const Basis* const> bases,
                                const OutgoingSet& outgoing, const ProjectionOptions& options) {
    if (outgoing.map == OutgoingSet::Map::elevations && !brdf.laws().isotropic) {
        throw UsageError(fmt::format(
            "{} is anisotropic: outgoing elevations alone do not describe it; give a map (32x32)",
            brdf.name()));
    }
    if (!(options.tolerance >= 0 && options.tolerance <= 1))
        throw UsageError(
            fmt::format("the tolerance is {}, expected 0, for the default of the BRDF, "
                        "or a number up to 1",
                        options.tolerance));
    const double tolerance = options.tolerance > 0 ? options.tolerance : brdf.defaultTolerance();
    ProjectionOptions counted = options;
    if (options.progress) {
        counted.progress = [&](std::size_t done, std::size_t) {
            options.progress(done, outgoing.size());
        };
    }
    const std::vector<Group> groups = groupBySymmetry(outgoing, brdf.laws());
    const std::vector<RefinedMoments> results =
        projectGroups(brdf, bases, groups, counted, tolerance);
    brdf.checkIntact();

    std::vector<Projection> projections(bases.size());
    for (std::size_t b = 0; b < bases.size(); ++b) {
        Projection& projection = projections[b];
        projection.coefficients = describe(brdf, *bases[b], outgoing, options.quantity, tolerance);
        projection.captured.assign(bases[b]->order(), 0.0);
        for (std::size_t g = 0; g < groups.size(); ++g) {
            addGroup(*bases[b], b, groups[g], results[g], projection);
        }
        Energy& energy = projection.coefficients.energy;
        if (!energy.finite) energy.value = energy.error = std::numeric_limits<double>::quiet_NaN();
    }
    return projections;
}

}  // namespace hshfit::inline projection
