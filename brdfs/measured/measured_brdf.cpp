#include <brdfs/measured/measured_brdf.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

void Census::add(double value) {
    if (std::isnan(value)) {
        ++notANumber;
    } else if (std::isinf(value)) {
        ++infinite;
    } else {
        if (value < 0) ++negative;
        least = std::min(least, value);
        greatest = std::max(greatest, value);
    }
}

}  // namespace hshfit::brdfs
