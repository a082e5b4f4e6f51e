#include <hshfit/lighting/prefiltered_lobes.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/lighting/harmonics.h>
#include <hshfit/lighting/internal/lobe_search.h>
#include <hshfit/lighting/lobe_nodes.h>
#include <hshfit/projection/projection.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace hshfit::lighting {
namespace {

constexpr double startAngles[] = {0.5, 0.85, 1.15};  // radians, of rows whose search is free

/// SH coefficients of a function turned about +z by -azimuth: f'(phi) = f(phi + azimuth).
std::vector<double> turnedBack(std::span<const double> from, int order, double azimuth) {
    std::vector<double> result(from.begin(), from.end());
    for (int l = 0; l < order; ++l) {
        for (int m = 1; m <= l; ++m) {
            const auto even = static_cast<std::size_t>(bases::slotOf(l, m)),
                       odd = static_cast<std::size_t>(bases::slotOf(l, -m));
            const double c = std::cos(m * azimuth), s = std::sin(m * azimuth);
            result[even] = c * from[even] + s * from[odd];
            result[odd] = c * from[odd] - s * from[even];
        }
    }
    return result;
}

/// f cos(theta_i) of every row in the frame with wo.y = 0.
std::vector<LobeTarget> targetsOf(const Brdf& brdf, const Basis& basis,
                                  const ElevationTable& table) {
    OutgoingSet outgoing;
    for (std::size_t place = 0; place < table.height(); ++place) {
        const double cosine = table.rows.cosine(place % table.rows.count);
        outgoing.directions.push_back(
            directionFromAngles(std::acos(cosine), table.azimuths.angle(place / table.rows.count)));
        outgoing.solidAngles.push_back(1);
    }
    outgoing.width = static_cast<int>(outgoing.size());
    const Basis* const bases[] = {&basis};
    const Coefficients all = std::move(
        project(brdf, bases, outgoing, {.quantity = Quantity::brdfCosine}).front().coefficients);
    std::vector<LobeTarget> targets;
    for (std::size_t place = 0; place < table.height(); ++place) {
        const double azimuth = table.azimuths.angle(place / table.rows.count);
        std::array<std::vector<double>, 3> f;
        for (std::size_t c = 0; c < 3; ++c) {
            const double* from = all.at(place, all.channels.count() == 3 ? c : 0);
            f[c] = turnedBack({from, all.slots()}, basis.order(), azimuth);
        }
        targets.emplace_back(basis, std::move(f));
    }
    return targets;
}

/// A solution for every row, from one whose search was free to both sides.
struct Chain {
    std::vector<LobeSolution> rows;
    double left = 0;  ///< sums of LobeSearch::leftBy: of rows, and of their neighbours' mean
};

/// The lobes halfway between two rows, as a table interpolates them.
LobeSolution between(const LobeSolution& a, const LobeSolution& b) {
    LobeSolution middle = a;
    const auto mix = [](Rgb& to, const Rgb& other) {
        for (std::size_t c = 0; c < 3; ++c) to[c] = (to[c] + other[c]) / 2;
    };
    mix(middle.diffuse, b.diffuse);
    for (std::size_t k = 0; k < a.places.size(); ++k) {
        mix(middle.scales[k], b.scales[k]);
        LobePlace& place = middle.places[k];
        const LobePlace& other = b.places[k];
        place.roughness = (place.roughness + other.roughness) / 2;
        place.axis = normalised(place.axis + other.axis);
    }
    return middle;
}

void measure(const LobeSearch& search, std::span<const LobeTarget> targets, Chain& chain) {
    chain.left = 0;
    for (std::size_t k = 0; k < chain.rows.size(); ++k) {
        chain.left += search.leftBy(targets[k], chain.rows[k]);
        if (k == 0 || k + 1 == chain.rows.size()) continue;
        chain.left += search.leftBy(targets[k], between(chain.rows[k - 1], chain.rows[k + 1]));
    }
}

/// The better of a chain and of one whose rows are again searched for near their neighbours' mean,
/// so that lobes do not leap between two rows.
Chain smoothed(const LobeSearch& search, std::span<const LobeTarget> targets,
               const ElevationRows& rows, Chain chain) {
    constexpr int passes = 2;
    constexpr double reach = 0.25;
    Chain other = chain;
    for (int pass = 0; pass < passes; ++pass) {
        for (std::size_t k = 1; k + 1 < rows.count; ++k) {
            const double theta = std::acos(rows.cosine(k));
            other.rows[k] = search.continued(targets[k], theta,
                                             between(other.rows[k - 1], other.rows[k + 1]).places,
                                             theta, reach);
        }
    }
    measure(search, targets, other);
    return other.left < chain.left ? other : chain;
}

Chain chainFrom(const LobeSearch& search, std::span<const LobeTarget> targets,
                const ElevationRows& rows, std::size_t middle, const LobeSolution& first) {
    Chain chain{.rows = std::vector<LobeSolution>(rows.count)};
    chain.rows[middle] = first;
    const auto follow = [&](std::size_t k, std::size_t from) {
        chain.rows[k] = search.continued(targets[k], std::acos(rows.cosine(k)),
                                         chain.rows[from].places, std::acos(rows.cosine(from)));
    };
    for (std::size_t k = middle; k-- > 0;) follow(k, k + 1);
    for (std::size_t k = middle + 1; k < rows.count; ++k) follow(k, k - 1);
    measure(search, targets, chain);
    return chain;
}

std::size_t rowAt(const ElevationRows& rows, double theta) {
    return rows.place(std::cos(theta)).row;
}

/// The best of chains from several rows.
Chain freeChain(const LobeSearch& search, std::span<const LobeTarget> targets,
                const ElevationRows& rows) {
    std::array<Chain, std::size(startAngles)> chains;
    tbb::parallel_for(std::size_t{0}, chains.size(), [&](std::size_t k) {
        const std::size_t middle = rowAt(rows, startAngles[k]);
        chains[k] =
            smoothed(search, targets, rows,
                     chainFrom(search, targets, rows, middle,
                               search.free(targets[middle], std::acos(rows.cosine(middle)))));
    });
    return *std::ranges::min_element(chains, {}, &Chain::left);
}

void writeRow(const LobeSolution& row, bool inPlane, std::span<double> out) {
    std::ranges::copy(row.diffuse, out.begin());
    const std::size_t lobes = row.places.size();
    for (std::size_t k = 0; k < lobes; ++k) {
        const LobePlace& place = row.places[k];
        const auto texel = out.subspan(4 * (k + 1), 4);
        std::ranges::copy(row.scales[k], texel.begin());
        texel[3] = place.roughness;
        if (inPlane) {
            out[4 * (lobes + 1) + k] = std::atan2(-place.axis.x, place.axis.z);
            continue;
        }
        const auto axis = out.subspan(4 * (lobes + 1 + k), 4);
        axis[0] = place.axis.x, axis[1] = place.axis.y, axis[2] = place.axis.z;
    }
}

/// The share of each row in a mean over theta_o, by the trapezoidal rule.
std::vector<double> angleShares(const ElevationRows& rows) {
    std::vector<double> shares(rows.count, 0.0);
    const double whole = std::acos(rows.cosine(rows.count - 1));
    for (std::size_t k = 0; k + 1 < rows.count; ++k) {
        const double half =
            (std::acos(rows.cosine(k + 1)) - std::acos(rows.cosine(k))) / (2 * whole);
        shares[k] += half, shares[k + 1] += half;
    }
    return shares;
}

}  // namespace

PrefilteredTable fitPrefiltered(const Brdf& brdf, const Prefilter& engine, std::size_t lobes,
                                ElevationRows rows, std::size_t azimuthSteps) {
    if (lobes < 1 || lobes > PrefilteredTable::mostLobes)
        throw UsageError(
            fmt::format("{} lobes in a prefiltered environment: from 1 to {} are "
                        "possible",
                        lobes, PrefilteredTable::mostLobes));
    const std::size_t channels = brdf.channels().count();
    if (channels != 1 && channels != 3)
        throw UsageError(
            fmt::format("{}: lighting takes grey and RGB, not {} channels", brdf.name(), channels));
    const bool inPlane = lobesInPlane(brdf.laws());
    PrefilteredTable result{
        .engine = &engine,
        .lobes = lobes,
        .inPlane = inPlane,
        .table = ElevationTable(rows, 1 + lobes + (inPlane ? (lobes + 3) / 4 : lobes),
                                AzimuthNodes(brdf.laws(), azimuthSteps))};
    const auto basis = bases::make("sh", PrefilteredTable::bands);
    const std::vector<LobeTarget> targets = targetsOf(brdf, *basis, result.table);
    const LobeSearch search(PrefilteredTable::bands, engine, lobes, inPlane);
    // The search for the middle row of an azimuth starts from the middle row of the azimuth before,
    // so that lobes keep their places. The other rows of the azimuth follow from it.
    const std::size_t around = result.table.azimuths.count, middle = rowAt(rows, startAngles[1]);
    const double theta = std::acos(rows.cosine(middle));
    const auto targetsAt = [&](std::size_t k) {
        return std::span<const LobeTarget>(targets.data() + k * rows.count, rows.count);
    };
    std::vector<Chain> chains(around);
    chains[0] = freeChain(search, targetsAt(0), rows);
    std::vector<LobeSolution> middles{chains[0].rows[middle]};
    for (std::size_t k = 1; k < around; ++k)
        middles.push_back(
            search.continued(targetsAt(k)[middle], theta, middles.back().places, theta));
    tbb::parallel_for(std::size_t{1}, around, [&](std::size_t k) {
        chains[k] = chainFrom(search, targetsAt(k), rows, middle, middles[k]);
    });
    for (std::size_t k = 0; k < around; ++k) {
        for (std::size_t row = 0; row < rows.count; ++row) {
            const LobeSolution& found = chains[k].rows[row];
            writeRow(found, inPlane, result.table.row(row, k));
            result.residuals.push_back(found.left);
            const BandSquares squares = search.squares(targetsAt(k)[row], found);
            result.squares.insert(result.squares.end(), squares.whole.begin(), squares.whole.end());
            result.left.insert(result.left.end(), squares.left.begin(), squares.left.end());
        }
    }
    return result;
}

double turnedError(const PrefilteredTable& table, std::span<const Light> lights) {
    constexpr auto bands = static_cast<std::size_t>(PrefilteredTable::bands);
    const LightCoefficients light =
        projectLight(lights, *bases::make("sh", PrefilteredTable::bands));
    std::vector<double> weights(3 * bands, 0.0);
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t l = 0; l < bands; ++l)
            for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i)
                weights[c * bands + l] +=
                    light.at(c)[i] * light.at(c)[i] / (2 * static_cast<double>(l) + 1);
    const std::vector<double> shares = angleShares(table.table.rows);
    double sum = 0;
    for (std::size_t row = 0; row < table.residuals.size(); ++row) {
        double whole = 0, left = 0;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            whole += weights[i] * table.squares[row * weights.size() + i];
            left += weights[i] * table.left[row * weights.size() + i];
        }
        sum += whole > 0 ? shares[row % shares.size()] * std::sqrt(left / whole) : 0;
    }
    return sum / static_cast<double>(table.table.azimuths.count);
}

Rgb radiance(const PrefilteredTable& table, const EnvironmentCube& cube, const Direction& normal,
             const Direction& viewer, const Direction& tangent) {
    ViewAxes axes(normal, viewer, tangent);
    if (!(axes.cosine > 0)) return {};
    std::array<double, 4 * (2 * PrefilteredTable::mostLobes + 1)> row{};
    const bool mirrored =
        table.table.at(axes.cosine, axes.azimuth, {row.data(), 4 * table.table.texels});
    if (mirrored) axes.mirror();
    const Rgb even = cube.at(normal, table.engine->levelOf(1));
    Rgb result{row[0] * even[0], row[1] * even[1], row[2] * even[2]};
    const double* const places = &row[4 * (table.lobes + 1)];
    for (std::size_t k = 0; k < table.lobes; ++k) {
        const double* texel = &row[4 * (k + 1)];
        const Direction local =
            table.inPlane ? Direction{-std::sin(places[k]), 0, std::cos(places[k])}
                          : Direction{places[4 * k], places[4 * k + 1], places[4 * k + 2]};
        const Rgb light = cube.at(axes.toWorld(local), table.engine->levelOf(texel[3]));
        for (std::size_t c = 0; c < 3; ++c) result[c] += texel[c] * light[c];
    }
    for (double& value : result) value = std::max(0.0, value);
    return result;
}

}  // namespace hshfit::lighting
