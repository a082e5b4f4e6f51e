#include <brdfs/measured/scattered/alta_coordinates.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace hshfit::brdfs {
namespace {

double wrapped(double phi) {
    return phi < 0 ? phi + 2 * pi : phi;
}

Direction normalised(const Direction& d) {
    const double size = std::sqrt(dot(d, d));
    return size > 0 ? Direction{d.x / size, d.y / size, d.z / size} : Direction{0, 0, 1};
}

Direction halfOf(const Direction& wi, const Direction& wo) {
    return normalised({wi.x + wo.x, wi.y + wo.y, wi.z + wo.z});
}

/// V + mirrored(L), normalised.
Direction backOf(const Direction& wi, const Direction& wo) {
    const Direction r = mirrored(wi);
    return normalised({wo.x + r.x, wo.y + r.y, wo.z + r.z});
}

/// theta_h, phi_h, theta_d, phi_d; V is the difference vector (alta_parameters.cpp).
std::array<double, 4> rusinkiewicz(const Direction& wi, const Direction& wo) {
    const Direction h = halfOf(wi, wo);
    const double thetaH = polarAngle(h), phiH = std::hypot(h.x, h.y) > 0 ? azimuth(h) : 0;
    const Direction turned = rotateAboutZ(wo, -phiH);
    const double s = std::sin(thetaH), c = std::cos(thetaH);
    const Direction d{c * turned.x - s * turned.z, turned.y, s * turned.x + c * turned.z};
    const double across = std::hypot(d.x, d.y);
    return {thetaH, wrapped(phiH), std::atan2(across, d.z),
            across > 1e-12 ? wrapped(std::atan2(d.y, d.x)) : 0};
}

/// The azimuth from wi to wo.
double turn(const Direction& wi, const Direction& wo) {
    const double cross = wi.x * wo.y - wi.y * wo.x, along = wi.x * wo.x + wi.y * wo.y;
    return cross == 0 && along == 0 ? 0 : std::atan2(cross, along);
}

using In = const Direction&;

const std::array table{
    AltaCoordinates{"COS_TH", 1, true, true, true,
                    [](In wi, In wo, double* x) { x[0] = halfOf(wi, wo).z; }},
    AltaCoordinates{"COS_TK", 1, true, true, true,
                    [](In wi, In wo, double* x) { x[0] = backOf(wi, wo).z; }},
    AltaCoordinates{"COS_TLV", 1, true, true, true,
                    [](In wi, In wo, double* x) { x[0] = dot(wi, wo); }},
    AltaCoordinates{"COS_TLR", 1, true, true, true,
                    [](In wi, In wo, double* x) { x[0] = dot(mirrored(wi), wo); }},
    AltaCoordinates{"COS_TH_TD", 2, true, true, true,
                    [](In wi, In wo, double* x) {
                        const Direction h = halfOf(wi, wo);
                        x[0] = h.z, x[1] = dot(h, wo);
                    }},
    AltaCoordinates{"RUSIN_TH_TD", 2, true, true, true,
                    [](In wi, In wo, double* x) {
                        const auto r = rusinkiewicz(wi, wo);
                        x[0] = r[0], x[1] = r[2];
                    }},
    AltaCoordinates{"RUSIN_TH_PH_TD", 3, true, false, false,
                    [](In wi, In wo, double* x) {
                        const auto r = rusinkiewicz(wi, wo);
                        std::copy_n(r.begin(), 3, x);
                    }},
    AltaCoordinates{"RUSIN_TH_TD_PD", 3, false, true, false,
                    [](In wi, In wo, double* x) {
                        const auto r = rusinkiewicz(wi, wo);
                        x[0] = r[0], x[1] = r[2], x[2] = r[3];
                    }},
    AltaCoordinates{"RUSIN_TH_PH_TD_PD", 4, false, false, false,
                    [](In wi, In wo, double* x) {
                        const auto r = rusinkiewicz(wi, wo);
                        std::ranges::copy(r, x);
                    }},
    AltaCoordinates{"RUSIN_VH", 3, true, false, false,
                    [](In wi, In wo, double* x) {
                        const Direction h = halfOf(wi, wo);
                        x[0] = h.x, x[1] = h.y, x[2] = h.z;
                    }},
    AltaCoordinates{"SCHLICK_VK", 3, false, false, false,
                    [](In wi, In wo, double* x) {
                        const Direction k = backOf(wi, wo);
                        x[0] = k.x, x[1] = k.y, x[2] = k.z;
                    }},
    AltaCoordinates{"SPHERICAL_TL_PL_TV_PV", 4, false, false, false,
                    [](In wi, In wo, double* x) {
                        x[0] = polarAngle(wi), x[1] = wrapped(azimuth(wi));
                        x[2] = polarAngle(wo), x[3] = wrapped(azimuth(wo));
                    }},
    AltaCoordinates{"ISOTROPIC_TV_TL_DPHI", 3, false, true, false,
                    [](In wi, In wo, double* x) {
                        x[0] = polarAngle(wo), x[1] = polarAngle(wi), x[2] = wrapped(turn(wi, wo));
                    }},
    AltaCoordinates{"ISOTROPIC_TL_TV_PROJ_DPHI", 3, false, true, false,
                    [](In wi, In wo, double* x) {
                        const double theta = polarAngle(wo), phi = turn(wi, wo);
                        x[0] = polarAngle(wi);
                        x[1] = theta * std::cos(phi), x[2] = theta * std::sin(phi);
                    }},
    AltaCoordinates{"STEREOGRAPHIC", 4, false, false, false,
                    [](In wi, In wo, double* x) {
                        x[0] = wo.x / (1 + wo.z), x[1] = wo.y / (1 + wo.z);
                        x[2] = wi.x / (1 + wi.z), x[3] = wi.y / (1 + wi.z);
                    }},
    AltaCoordinates{"CARTESIAN", 6, false, false, false,
                    [](In wi, In wo, double* x) {
                        const double all[] = {wo.x, wo.y, wo.z, wi.x, wi.y, wi.z};
                        std::ranges::copy(all, x);
                    }},
};

}  // namespace

const AltaCoordinates* altaCoordinates(std::string_view name) {
    const auto found = std::ranges::find(table, name, &AltaCoordinates::name);
    return found == table.end() ? nullptr : &*found;
}

std::span<const AltaCoordinates> allAltaCoordinates() {
    return table;
}

std::string_view altaCoordinateNames() {
    static const std::string names = [] {
        std::string list;
        for (const AltaCoordinates& row : table)
            list += (list.empty() ? "" : ", ") + std::string(row.name);
        return list;
    }();
    return names;
}

}  // namespace hshfit::brdfs
