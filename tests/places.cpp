#include "places.h"

#include <cstdlib>

namespace hshfit::test {

std::string sharedFolder() {
    return HSHFIT_SHARED;
}

std::string sourceFolder() {
    return HSHFIT_SOURCE;
}

std::string program() {
    return HSHFIT_PROGRAM;
}

bool hasGnuplot() {
    return std::system("command -v gnuplot >/dev/null 2>&1") == 0;
}

}  // namespace hshfit::test
