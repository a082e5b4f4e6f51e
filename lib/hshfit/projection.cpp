#include <hshfit/projection.h>

#include <hshfit/error.h>
#include <hshfit/horizon.h>
#include <hshfit/rings.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <Eigen/Core>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <mutex>

namespace hshfit {
namespace {

using Inner = Basis::Inner;
constexpr int innerKinds = 2;

/// An outgoing direction that follows from its group's representative by symmetry.
struct Member {
    std::size_t index;
    double turn = 0;                    ///< rotation about z (isotropic)
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
            representative = {std::hypot(wo.x, wo.y), 0, wo.z};
            member.turn = azimuth(wo);
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

/// Coefficients of a member from those of its group's representative.
void applySymmetry(const Member& member, int order, const double* from, double* to) {
    for (int m = 0; m < order; ++m) {
        const double c = std::cos(m * member.turn), s = std::sin(m * member.turn);
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

/// What one refinement level gives for one outgoing direction.
struct Level {
    std::vector<std::vector<double>> moments;  ///< per basis: [channel][slot]
    double energy[innerKinds] = {};            ///< summed over channels
    std::size_t evaluations = 0;
};

void addMoments(const Basis& basis, const RingSpectrum& spectrum, const HemisphereGrid& grid,
                std::vector<double>& moments) {
    using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const std::size_t rings = spectrum.rings, channels = spectrum.channels;
    const int order = basis.order();
    moments.assign(channels * basis.slots(), 0.0);
    Eigen::ArrayXd weights = Eigen::Map<const Eigen::ArrayXd>(grid.weights.data(), rings);
    if (basis.inner() == Inner::projectedSolidAngle) {
        for (std::size_t r = 0; r < rings; ++r) weights[r] *= grid.elevations[r].mu;
    }
    RowMatrix theta;
    Eigen::MatrixXd parts(rings, 2 * channels), products;
    for (int m = 0; m < order; ++m) {
        theta.resize(order - m, rings);
        basis.analysisTheta(m, grid.elevations, theta.data());
        for (std::size_t c = 0; c < channels; ++c) {
            using Column = Eigen::Map<const Eigen::ArrayXd>;
            parts.col(c) = Column(spectrum.part(m, c), rings) * weights;
            parts.col(channels + c) = Column(spectrum.part(-m, c), rings) * weights;
        }
        products.noalias() = theta * parts;
        const double sign = azimuthSign(m, basis.condonShortley());
        for (std::size_t c = 0; c < channels; ++c) {
            double* out = moments.data() + c * basis.slots();
            for (int l = m; l < order; ++l) {
                out[slotOf(l, m)] = sign * products(l - m, c);
                if (m > 0) out[slotOf(l, -m)] = sign * products(l - m, channels + c);
            }
        }
    }
}

Level computeLevel(const Brdf& brdf, std::span<const Basis* const> bases, const Group& group,
                   const HemisphereGrid& grid, Quantity quantity, int order) {
    Level level;
    const RingSpectrum spectrum = sampleRings(brdf, group.wo, grid, quantity, order, group.even);
    level.evaluations = spectrum.evaluations;
    for (std::size_t r = 0; r < spectrum.rings; ++r) {
        const double part = grid.weights[r] * spectrum.squares[r];
        level.energy[static_cast<int>(Inner::solidAngle)] += part;
        level.energy[static_cast<int>(Inner::projectedSolidAngle)] += part * grid.elevations[r].mu;
    }
    level.moments.resize(bases.size());
    for (std::size_t b = 0; b < bases.size(); ++b) {
        addMoments(*bases[b], spectrum, grid, level.moments[b]);
    }
    return level;
}

double relative(double difference, double reference) {
    if (difference == 0) return 0;
    return reference > 0 ? difference / reference : std::numeric_limits<double>::infinity();
}

/// The converged result for one group.
struct GroupResult {
    Level level;
    double energyError[innerKinds] = {};
    double error = 0;
    std::size_t evaluations = 0;
    HorizonBehaviour horizon;
};

/// Largest relative change between two levels, in coefficients and in the energies that exist.
double changeBetween(const Level& coarse, const Level& fine, std::span<const Basis* const> bases,
                     const HorizonBehaviour& horizon) {
    double change = 0;
    for (std::size_t b = 0; b < bases.size(); ++b) {
        double difference = 0, norm = 0;
        for (std::size_t k = 0; k < fine.moments[b].size(); ++k) {
            const double d = fine.moments[b][k] - coarse.moments[b][k];
            difference += d * d;
            norm += fine.moments[b][k] * fine.moments[b][k];
        }
        change = std::max(change, relative(std::sqrt(difference), std::sqrt(norm)));
        if (const Inner inner = bases[b]->inner(); horizon.energyExists(inner)) {
            const int e = static_cast<int>(inner);
            change = std::max(
                change, relative(std::abs(fine.energy[e] - coarse.energy[e]), fine.energy[e]));
        }
    }
    return change;
}

GroupResult projectGroup(const Brdf& brdf, std::span<const Basis* const> bases, const Group& group,
                         const ProjectionOptions& options, double tolerance, int order) {
    constexpr int maxLevels = 16;
    GroupResult result;
    result.horizon = horizonBehaviour(brdf, group.wo, options.quantity);
    if (!result.horizon.coefficientsExist()) {
        throw NumericError(
            fmt::format("{}: {}; its coefficients do not exist either", brdf.name(),
                        divergenceReason(result.horizon, group.wo, options.quantity)));
    }
    const std::vector<Lobe> lobes = brdf.lobes(group.wo);
    double change = std::numeric_limits<double>::infinity();
    for (int k = 0; k < maxLevels; ++k) {
        const HemisphereGrid grid = gridFor(lobes, group.wo, {.order = order, .level = k});
        const std::size_t cost = grid.points() / (group.even ? 2 : 1);
        if (result.evaluations + cost > options.maxEvaluations) break;
        Level level = computeLevel(brdf, bases, group, grid, options.quantity, order);
        result.evaluations += level.evaluations;
        if (k > 0) {
            change = changeBetween(result.level, level, bases, result.horizon);
            for (int e = 0; e < innerKinds; ++e) {
                result.energyError[e] = std::abs(level.energy[e] - result.level.energy[e]);
            }
        }
        result.level = std::move(level);
        result.error = change;
        if (change <= tolerance) return result;
    }
    throw NumericError(fmt::format(
        "{}: not converged at theta_o = {:.6g}, phi_o = {:.6g} degrees: relative change {:.2g} "
        "after {} evaluations, {:.2g} asked; raise --tolerance or --max-evaluations",
        brdf.name(), degrees(polarAngle(group.wo)), degrees(azimuth(group.wo)), change,
        result.evaluations, tolerance));
}

/// All groups in parallel. Of several failures the first group's is reported, so that the message
/// does not depend on the threads.
std::vector<GroupResult> projectGroups(const Brdf& brdf, std::span<const Basis* const> bases,
                                       const std::vector<Group>& groups,
                                       const ProjectionOptions& options, double tolerance,
                                       int order) {
    std::vector<GroupResult> results(groups.size());
    std::vector<std::exception_ptr> failures(groups.size());
    std::atomic<std::size_t> firstFailure = groups.size(), done = 0;
    tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t g) {
        if (g > firstFailure) return;
        try {
            results[g] = projectGroup(brdf, bases, groups[g], options, tolerance, order);
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

void addGroup(const Basis& basis, std::size_t basisIndex, const Group& group,
              const GroupResult& result, Projection& projection) {
    Coefficients& out = projection.coefficients;
    const int e = static_cast<int>(basis.inner());
    out.energy.value += group.solidAngle * result.level.energy[e];
    out.energy.error += group.solidAngle * result.energyError[e];
    out.error = std::max(out.error, result.error);
    projection.evaluations += result.evaluations;
    if (!result.horizon.energyExists(basis.inner()) && out.energy.finite) {
        out.energy.finite = false;
        out.energy.reason = divergenceReason(result.horizon, group.wo, out.quantity);
    }
    std::vector<double> solved(basis.slots());
    for (std::size_t c = 0; c < out.channels.count(); ++c) {
        const double* moments = result.level.moments[basisIndex].data() + c * basis.slots();
        for (int n = 1; n <= basis.order(); ++n) {
            projection.captured[n - 1] += group.solidAngle * basis.capturedEnergy(moments, n);
        }
        basis.coefficientsFromMoments(moments, basis.order(), solved.data());
        for (const Member& member : group.members) {
            applySymmetry(member, basis.order(), solved.data(), out.at(member.index, c));
        }
    }
}

}  // namespace

std::string quantityName(Quantity quantity) {
    return quantity == Quantity::brdf ? "brdf" : "brdf_cosine";
}

std::vector<Projection> project(const Brdf& brdf, std::span<const Basis* const> bases,
                                const OutgoingSet& outgoing, const ProjectionOptions& options) {
    if (outgoing.map == OutgoingSet::Map::elevations && !brdf.laws().isotropic) {
        throw UsageError(fmt::format(
            "{} is anisotropic: outgoing elevations alone do not describe it; give a map (32x32)",
            brdf.name()));
    }
    const double tolerance = options.tolerance > 0 ? options.tolerance : brdf.defaultTolerance();
    int order = 1;
    for (const Basis* basis : bases) order = std::max(order, basis->order());

    ProjectionOptions counted = options;
    if (options.progress) {
        counted.progress = [&](std::size_t done, std::size_t) {
            options.progress(done, outgoing.size());
        };
    }
    const std::vector<Group> groups = groupBySymmetry(outgoing, brdf.laws());
    const std::vector<GroupResult> results =
        projectGroups(brdf, bases, groups, counted, tolerance, order);
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

}  // namespace hshfit
