#include <brdfs/measured/scattered/alta_parameters.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace hshfit::brdfs {
namespace {

// Kinds of numbers: t polar angle, p azimuth, c cosine, x length or coordinate,
// j angle times the cosine or sine of an azimuth.
constexpr char kind_c[] = {'c'}, kind_cc[] = {'c', 'c'}, kind_tt[] = {'t', 't'};
constexpr char kind_tp[] = {'t', 'p'}, kind_ttp[] = {'t', 't', 'p'}, kind_tpt[] = {'t', 'p', 't'};
constexpr char kind_tjj[] = {'t', 'j', 'j'}, kind_tptp[] = {'t', 'p', 't', 'p'};
constexpr char kind_xx[] = {'x', 'x'}, kind_xxp[] = {'x', 'x', 'p'}, kind_xxx[] = {'x', 'x', 'x'};
constexpr char kind_xxxx[] = {'x', 'x', 'x', 'x'}, kind_x6[] = {'x', 'x', 'x', 'x', 'x', 'x'};

/// Directions from the frame of the half vector (Rusinkiewicz 1998): V is the difference
/// vector, tilted by theta_h in the xz plane and turned by phi_h; L is V mirrored at H.
bool fromHalf(double thetaH, double phiH, double thetaD, double phiD, Direction& wi,
              Direction& wo) {
    const Direction h = directionFromAngles(thetaH, phiH);
    const Direction d = directionFromAngles(thetaD, phiD);
    const Direction tilted{std::cos(thetaH) * d.x + std::sin(thetaH) * d.z, d.y,
                           -std::sin(thetaH) * d.x + std::cos(thetaH) * d.z};
    wo = rotateAboutZ(tilted, phiH);
    const double c = 2 * dot(h, wo);
    wi = {c * h.x - wo.x, c * h.y - wo.y, c * h.z - wo.z};
    return true;
}

double angleOf(double cosine) {
    return std::acos(std::clamp(cosine, -1.0, 1.0));
}

/// One of the pairs whose back vector is k.
bool fromBack(const Direction& k, Direction& wi, Direction& wo) {
    wo = k;
    wi = mirrored(k);
    return true;
}

bool unit(const double* x, Direction& d) {
    const double size = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if (!(std::fabs(size - 1) < 1e-2)) return false;
    d = {x[0] / size, x[1] / size, x[2] / size};
    return true;
}

/// The direction above the point (x, y) of the unit disc.
bool lifted(double x, double y, Direction& d) {
    const double z2 = 1 - x * x - y * y;
    if (z2 < -1e-9) return false;
    d = {x, y, std::sqrt(std::max(z2, 0.0))};
    return true;
}

/// [angle cos(phi), angle sin(phi)].
Direction projected(double x, double y) {
    return directionFromAngles(std::hypot(x, y), std::atan2(y, x));
}

bool fromRetro(const double* x, Direction& wi, Direction& wo) {
    // V is at the angle theta_VL from L; phi is 0 towards the normal.
    wi = directionFromAngles(x[0], 0);
    const Direction up{-std::cos(x[0]), 0, std::sin(x[0])};
    const Direction local = projected(x[1], x[2]);
    wo = {local.z * wi.x + local.x * up.x, local.y, local.z * wi.z + local.x * up.z};
    return true;
}

bool fromSchlick(const double* x, Direction& wi, Direction& wo) {
    wi = directionFromAngles(x[0], 0);
    const Direction r = mirrored(wi), k = projected(x[1], x[2]);
    const double c = 2 * dot(r, k);
    wo = {c * k.x - r.x, c * k.y - r.y, c * k.z - r.z};
    return true;
}

bool fromStark(const double* x, Direction& wi, Direction& wo) {
    // H = (H_p, 0, H_z) and B at right angles to it, |H|^2 + |B|^2 = 1, B_p at the azimuth x[2].
    const double z2 = 1 - x[0] * x[0] - x[1] * x[1];
    if (z2 < -1e-9) return false;
    const double hz = std::sqrt(std::max(z2, 0.0)), c = std::cos(x[2]), s = std::sin(x[2]);
    const double size = std::sqrt(hz * hz + x[0] * x[0] * c * c);
    if (!(size > 1e-12)) return false;
    const double flat = x[1] * hz / size;
    const Direction b{flat * c, flat * s, -x[1] * x[0] * c / size};
    wi = {x[0] + b.x, b.y, hz + b.z};
    wo = {x[0] - b.x, -b.y, hz - b.z};
    return true;
}

constexpr Chart pairOnly = Chart::anisotropic, isotropicPairs = Chart::isotropic;

using Coordinates = const double*;
using Out = Direction&;

const std::array parametrisations{
    AltaParameters{
        "COS_TH", 1, Chart::halfAngle,
        [](Coordinates x, Out i, Out o) { return fromHalf(angleOf(x[0]), 0, 0, 0, i, o); }, kind_c},
    AltaParameters{"COS_TK", 1, Chart::backAngle,
                   [](Coordinates x, Out i, Out o) {
                       return fromBack(directionFromAngles(angleOf(x[0]), 0), i, o);
                   },
                   kind_c},
    AltaParameters{"COS_TLV", 1, Chart::betweenDirections,
                   [](Coordinates x, Out i, Out o) {
                       i = directionFromAngles(angleOf(x[0]) / 2, 0);
                       o = mirrored(i);
                       return true;
                   },
                   kind_c},
    AltaParameters{"COS_TLR", 1, Chart::fromMirror,
                   [](Coordinates x, Out i, Out o) {
                       i = o = directionFromAngles(angleOf(x[0]) / 2, 0);
                       return true;
                   },
                   kind_c},
    AltaParameters{"COS_TH_TD", 2, Chart::halfDifference,
                   [](Coordinates x, Out i, Out o) {
                       return fromHalf(angleOf(x[0]), 0, angleOf(x[1]), pi / 2, i, o);
                   },
                   kind_cc},
    AltaParameters{
        "RUSIN_TH_TD", 2, Chart::halfDifference,
        [](Coordinates x, Out i, Out o) { return fromHalf(x[0], 0, x[1], pi / 2, i, o); }, kind_tt},
    AltaParameters{
        "RUSIN_TH_PH_TD", 3, Chart::halfVectorDistance,
        [](Coordinates x, Out i, Out o) { return fromHalf(x[0], x[1], x[2], pi / 2, i, o); },
        kind_tpt},
    AltaParameters{"RUSIN_TH_TD_PD", 3, isotropicPairs,
                   [](Coordinates x, Out i, Out o) { return fromHalf(x[0], 0, x[1], x[2], i, o); },
                   kind_ttp},
    AltaParameters{
        "RUSIN_TH_PH_TD_PD", 4, pairOnly,
        [](Coordinates x, Out i, Out o) { return fromHalf(x[0], x[1], x[2], x[3], i, o); },
        kind_tptp},
    AltaParameters{"RUSIN_VH", 3, Chart::halfVector,
                   [](Coordinates x, Out i, Out o) {
                       const bool valid = unit(x, i);
                       o = i;
                       return valid;
                   },
                   kind_xxx},
    AltaParameters{
        "SCHLICK_TK_PK", 2, Chart::backVector,
        [](Coordinates x, Out i, Out o) { return fromBack(directionFromAngles(x[0], x[1]), i, o); },
        kind_tp},
    AltaParameters{"SCHLICK_VK", 3, Chart::backVector,
                   [](Coordinates x, Out i, Out o) {
                       Direction k;
                       return unit(x, k) && fromBack(k, i, o);
                   },
                   kind_xxx},
    AltaParameters{"SCHLICK_TL_TK_PROJ_DPHI", 3, isotropicPairs, fromSchlick, kind_tjj},
    AltaParameters{"RETRO_TL_TVL_PROJ_DPHI", 3, isotropicPairs, fromRetro, kind_tjj},
    AltaParameters{"STEREOGRAPHIC", 4, pairOnly,
                   [](Coordinates x, Out i, Out o) {
                       const auto raised = [](double a, double b) {
                           return directionFromAngles(2 * std::atan(std::hypot(a, b)),
                                                      std::atan2(b, a));
                       };
                       o = raised(x[0], x[1]);
                       i = raised(x[2], x[3]);
                       return true;
                   },
                   kind_xxxx},
    AltaParameters{"SPHERICAL_TL_PL_TV_PV", 4, pairOnly,
                   [](Coordinates x, Out i, Out o) {
                       i = directionFromAngles(x[0], x[1]);
                       o = directionFromAngles(x[2], x[3]);
                       return true;
                   },
                   kind_tptp},
    AltaParameters{"ISOTROPIC_TV_TL_DPHI", 3, isotropicPairs,
                   [](Coordinates x, Out i, Out o) {
                       o = directionFromAngles(x[0], x[2]);
                       i = directionFromAngles(x[1], 0);
                       return true;
                   },
                   kind_ttp},
    AltaParameters{"ISOTROPIC_TL_TV_PROJ_DPHI", 3, isotropicPairs,
                   [](Coordinates x, Out i, Out o) {
                       i = directionFromAngles(x[0], 0);
                       o = projected(x[1], x[2]);
                       return true;
                   },
                   kind_tjj},
    AltaParameters{"STARK_2D", 2, Chart::stark,
                   [](Coordinates x, Out i, Out o) {
                       const double turned[] = {x[0], x[1], pi / 2};
                       return fromStark(turned, i, o);
                   },
                   kind_xx},
    AltaParameters{"STARK_3D", 3, isotropicPairs, fromStark, kind_xxp},
    AltaParameters{
        "NEUMANN_2D", 2, Chart::neumann,
        [](Coordinates x, Out i, Out o) { return lifted(x[0], x[1], i) && lifted(x[0], -x[1], o); },
        kind_xx},
    AltaParameters{"NEUMANN_3D", 3, isotropicPairs,
                   [](Coordinates x, Out i, Out o) {
                       const double bx = x[1] * std::cos(x[2]), by = x[1] * std::sin(x[2]);
                       return lifted(x[0] - bx, -by, i) && lifted(x[0] + bx, by, o);
                   },
                   kind_xxp},
    AltaParameters{"CARTESIAN", 6, pairOnly,
                   [](Coordinates x, Out i, Out o) { return unit(x, o) && unit(x + 3, i); },
                   kind_x6},
};

}  // namespace

const AltaParameters* altaParameters(std::string_view name) {
    const auto found = std::ranges::find(parametrisations, name, &AltaParameters::name);
    return found == parametrisations.end() ? nullptr : &*found;
}

std::string_view altaParameterNames() {
    static const std::string names = [] {
        std::string list;
        for (const AltaParameters& row : parametrisations) {
            list += (list.empty() ? "" : ", ") + std::string(row.name);
        }
        return list;
    }();
    return names;
}

void altaDirections(const AltaParameters& parameters, const double* x, const Row& row,
                    Direction& wi, Direction& wo) {
    for (std::size_t k = 0; k < parameters.count; ++k) {
        const std::string field = fmt::format("number {} of {}", k + 1, parameters.name);
        switch (parameters.kinds[k]) {
            case 't':
                checkedPolarAngle(x[k], row, field);
                break;
            case 'p':
                checkedAzimuth(x[k], row, field);
                break;
            default:
                if (std::fabs(x[k]) <= (parameters.kinds[k] == 'j' ? pi : 1 + 1e-6)) break;
                throw row.error(fmt::format("{} is {}, expected from {} to {}", field, x[k],
                                            parameters.kinds[k] == 'j' ? "-pi" : "-1",
                                            parameters.kinds[k] == 'j' ? "pi" : "1"));
        }
    }
    if (!parameters.directions(x, wi, wo)) {
        throw row.error(
            fmt::format("no pair of unit vectors above the horizon has the {} coordinates {}{}",
                        parameters.name, fmt::join(x, x + parameters.count, ", "),
                        parameters.name.starts_with("STARK")
                            ? "; expected x^2 + y^2 up to 1 for x, y = |H_p|, |B|"
                            : ""));
    }
}

}  // namespace hshfit::brdfs
