#include <brdfs/measured/no_values.h>
#include <hshfit/error.h>

#include <fmt/core.h>

namespace hshfit::brdfs {

void refuseWithoutValues(const Census& census, const std::string& name) {
    if (census.invalid == 0 || census.invalid + census.belowHorizon < census.values) return;
    throw InputError(
        fmt::format("{}: no value was measured: all {} above the horizon are marked "
                    "as missing",
                    name, census.invalid));
}

}  // namespace hshfit::brdfs
