#pragma once

#include <jobs/common/option_row.h>

#include <hshfit/irradiance/conventions.h>
#include <hshfit/irradiance/irradiance.h>
#include <hshfit/irradiance/zonal_form.h>

#include <string>
#include <vector>

namespace hshfit::jobs {

struct IrradianceOptions {
    std::string convention = "all";  ///< selectConventions
    /// One of them, as whose engine imports panoramas the light is turned; empty: none.
    std::string engine = {};
    int order = 3;                ///< bands of the irradiance
    std::string window = "none";  ///< none, hann, lanczos or least-negative
    std::size_t normals = 2000;   ///< of the lattice on which errors are taken
    std::string byNormal;         ///< CSV of the irradiances at them; empty: none
};
OptionRows<IrradianceOptions> irradianceOptions();

struct LitSurface {
    std::string light;                 ///< the specification
    NineRgb radiance{}, irradiance{};  ///< windowed; bands from `order` on are 0
    std::vector<double> factors;       ///< of the window, by band
    std::string window;                ///< that was applied
    double meanIrradiance = 0;         ///< over normals and channels, by direct integration
    IrradianceErrors error;            ///< of the order that was asked for
    IrradianceErrors nineError;        ///< of `irradiance`, which shaders hold
    ZonalForm zonal;                   ///< of three bands, whatever `order` is
    IrradianceErrors zonalError;
    IrradianceErrors geomericsError;        ///< of two bands with the reconstruction of Geomerics
    std::vector<std::string> remarks = {};  ///< on the files of the light
    double turn = 0;                        ///< degrees about +z by which the light was turned
    std::vector<const Convention*> conventions = {};  ///< that were asked for
};

/// The irradiance of the sum of all specifications by coefficients, and its error against direct
/// integration.
LitSurface irradianceOfLight(const std::vector<std::string>& specs,
                             const IrradianceOptions& options);

}  // namespace hshfit::jobs
