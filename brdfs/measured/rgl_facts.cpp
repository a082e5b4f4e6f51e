// Facts about an RGL file for `info`.

#include <brdfs/measured/rgl.h>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

Axis axisOf(std::string name, std::string unit, std::vector<double> nodes) {
    Axis axis{std::move(name), std::move(unit), nodes.size(), nodes.front(), nodes.back(), 0};
    for (std::size_t i = 1; i < nodes.size(); ++i) {
        axis.largestGap = std::max(axis.largestGap, nodes[i] - nodes[i - 1]);
    }
    return axis;
}

std::vector<double> inDegrees(std::vector<double> angles) {
    for (double& angle : angles) angle = degrees(angle);
    return angles;
}

}  // namespace

RglTables::Node RglTables::node(std::size_t slice, std::size_t row, std::size_t column) const {
    const double x = static_cast<double>(column) / static_cast<double>(spectra.columns - 1);
    const double y = static_cast<double>(row) / static_cast<double>(spectra.rows - 1);
    const auto [u, v] = normals->sample(x, y, slice);
    const double thetaIncident = incident.theta[slice % incident.theta.size()];
    const double phiIncident = incident.phi[slice / incident.theta.size()];
    Node node{.wi = {}, .wo = {}, .u = u, .v = v};
    node.wi = directionFromAngles(thetaIncident, phiIncident);
    const Direction h = directionFromAngles(
        u * u * pi / 2, (v - 0.5) * 2 * pi + (reduction == 0 ? phiIncident : 0));
    const double twice = 2 * dot(node.wi, h);
    node.wo = {twice * h.x - node.wi.x, twice * h.y - node.wi.y, twice * h.z - node.wi.z};
    node.factor = factorAt(u, v, thetaIncident, phiIncident);
    return node;
}

double RglTables::factorAt(double u, double v, double thetaIncident, double phiIncident) const {
    if (!jacobian) return 1;
    const double vIncident = phiIncident / (2 * pi) + 0.5;
    return ndf.at(u, v) /
           (4 * sigma.at(std::sqrt(2 / pi * thetaIncident), vIncident - std::floor(vIncident)));
}

double RglTables::factor(std::size_t slice, const Direction& wi, const Direction& wo) const {
    const double phiIncident = incident.phi[slice / incident.theta.size()];
    const Direction h{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
    const double v = (azimuth(h) - (reduction == 0 ? phiIncident : 0)) / (2 * pi) + 0.5;
    return factorAt(std::sqrt(2 / pi * polarAngle(h)), v - std::floor(v),
                    incident.theta[slice % incident.theta.size()], phiIncident);
}

Census RglBrdf::census() const {
    const Spectra& spectra = tables_.spectra;
    const std::size_t slices = tables_.incident.phi.size() * tables_.incident.theta.size();
    Census census;
    census.values = spectra.values.size();
    const float* value = spectra.values.data();
    for (std::size_t s = 0; s < slices; ++s) {
        for (std::size_t r = 0; r < spectra.rows; ++r) {
            for (std::size_t c = 0; c < spectra.columns; ++c, value += spectra.channels) {
                const RglTables::Node node = tables_.node(s, r, c);
                if (!(node.wo.z > 0)) {
                    census.belowHorizon += spectra.channels;
                    continue;
                }
                const double scale = node.factor / std::max(node.wo.z, 1e-9);
                for (std::size_t k = 0; k < spectra.channels; ++k) census.add(value[k] * scale);
            }
        }
    }
    return census;
}

std::vector<Axis> RglBrdf::axes() const {
    std::vector<Axis> axes = {axisOf("theta_i", "degrees", inDegrees(tables_.incident.theta)),
                              axisOf("phi_i", "degrees", inDegrees(tables_.incident.phi))};
    if (tables_.channels.kind == Channels::Kind::spectral) {
        axes.push_back(axisOf("wavelength", "nm", tables_.channels.wavelengths));
    }
    return axes;
}

std::vector<Fact> RglBrdf::facts() const {
    const Spectra& spectra = tables_.spectra;
    const auto negative = std::ranges::count_if(spectra.values, [](float v) { return v < 0; });
    std::vector<Fact> facts = {
        {"format", "rgl"},
        {"description", tables_.description},
        {"incident_elevations", static_cast<std::int64_t>(tables_.incident.theta.size())},
        {"incident_azimuths", static_cast<std::int64_t>(tables_.incident.phi.size())},
        {"azimuth_symmetry", tables_.reduction == 0   ? "isotropic"
                             : tables_.reduction == 1 ? "none"
                             : tables_.reduction == 2 ? "turned by 180 degrees"
                                                      : "mirrored at both axes"},
        {"normals_grid",
         fmt::format("{} x {}", tables_.normals->rows(), tables_.normals->columns())},
        {"colour_grid", fmt::format("{} x {}", spectra.rows, spectra.columns)},
        {"divided_by_jacobian", tables_.jacobian},
        {"out_of_gamut_values", static_cast<std::int64_t>(negative)},
    };
    if (tables_.channels.kind == Channels::Kind::spectral) {
        facts.emplace_back("first_wavelength_nm", tables_.channels.wavelengths.front());
        facts.emplace_back("last_wavelength_nm", tables_.channels.wavelengths.back());
    }
    return facts;
}

}  // namespace hshfit::brdfs
