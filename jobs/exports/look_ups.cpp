#include "look_ups.h"

#include <hshfit/version.h>

namespace hshfit::jobs {

LookUps lookUpsOf(const Brdf& brdf, std::string_view engine, const std::string& prefix,
                  const std::string& source) {
    const lighting::Prefilter& row = lighting::prefilterNamed(engine);
    LookUps result{lighting::fitPrefiltered(brdf, row, brdf.laws().isotropic ? 2 : 3), {}};
    const lighting::ElevationTable& table = result.fitted.table;
    result.shader = {.kind = lighting::LightingShader::Kind::prefiltered,
                     .engine = &row,
                     .lobes = result.fitted.lobes,
                     .inPlane = result.fitted.inPlane,
                     .rows = table.rows,
                     .azimuths = table.azimuths,
                     .texels = table.texels,
                     .prefix = prefix,
                     .source = source,
                     .generator = std::string("hshfit ") + version};
    return result;
}

}  // namespace hshfit::jobs
